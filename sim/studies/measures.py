"""How good a prediction is, measured against the ideal one."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from bentod.contracts import Vector

ENOUGH_TIMESCALES = 5
"""At so many timescales from the end of a recording its unknown future weighs e^−5 in a return: under 1 %."""


def settled(steps: int, share: float, timescale: int) -> slice:
    """The last `share` of a run of `steps`, but for its end, where returns are not known."""
    end = steps - ENOUGH_TIMESCALES * timescale
    return slice(max(0, round(steps * (1 - share))), max(1, end))


def nrmse(prediction: Vector, ideal: Vector) -> float:
    """Root mean square of `prediction` − `ideal`, divided by the standard deviation of `ideal`.

    1 is what the best constant gets, so this is what a learner gets who sees nothing but a bias. NaN when the
    ideal never changes.
    """
    spread = float(np.std(ideal))
    error = float(np.sqrt(np.mean((prediction - ideal) ** 2)))
    return error / spread if spread > 0 else float("nan")


def correlation(x: Vector, y: Vector) -> float:
    """Pearson's correlation; NaN when one of them never changes."""
    if np.ptp(x) == 0 or np.ptp(y) == 0:
        return float("nan")
    return float(np.corrcoef(x, y)[0, 1])


def lead(x: Vector, y: Vector, reach: int) -> int:
    """Steps by which `x` runs ahead of `y`: the k, −`reach` to `reach`, at which x_t is most like y_{t+k}.

    Negative: it lags behind. Of several that are equally alike, the k nearest to 0.
    """
    inside = x[reach : len(x) - reach]
    shifts = sorted(range(-reach, reach + 1), key=abs)
    alike = [correlation(inside, y[reach + k : len(y) - reach + k]) for k in shifts]
    return shifts[int(np.nanargmax(np.round(alike, 9)))]


def best_of_present(seen: NDArray[np.float64], ideal: Vector) -> Vector:
    """The best that can be said of `ideal` by one who sees binary signals now, and nothing else.

    That is the mean of `ideal` over all steps that look alike. `seen`: shape (steps, signals).
    """
    _, looks = np.unique(seen, axis=0, return_inverse=True)
    looks = looks.ravel()
    means: Vector = np.bincount(looks, weights=ideal) / np.bincount(looks)
    return means[looks]


def against_ideal(
    head: str, predictions: Mapping[str, Vector], ideal: Vector, judged: slice
) -> tuple[Sequence[str], ...]:
    """A table with the errors of several predictions, by name; its first row is the head."""
    g = ideal[judged]
    return (
        (head, "NRMSE", "correlation"),
        *(
            (name, f"{nrmse(p[judged], g):.3f}", f"{correlation(p[judged], g):.3f}")
            for name, p in predictions.items()
        ),
    )
