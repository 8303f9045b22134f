"""How far a GVF has converged: what its last weight vectors would predict here (White & White 2010).

M. White & A. White, "Interval Estimation for Reinforcement-Learning Algorithms in Continuous-State
Domains", NIPS 2010, as thesis 6.1 tells it: keep the last n weight vectors, predict the current state with
each, and evaluate these predictions statistically. They are neither independent nor normal, so no theory of
means is put upon them here: the interval is that between two percentiles of the predictions themselves. It
says within what bounds the answer for *this* state has been of late, not that they hold the truth. (The
paper resamples blocks of them at random; the arm's predictions must be the same in every replay, and its
tick has no time for some hundred samples.)

Weights of successive ticks hardly differ, so only each `every`-th is kept: `count` · `every` ticks is how
far the interval looks back. It needs `count` times the memory of the weights, and is for GVFs that ask for
it.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bentod.contracts import Features
from bentod.learn.confidence.columns import Columns


class Interval(Columns):
    """Of m = `gvfs` GVFs over `size` features, from `count` past weight vectors; `share` lies within."""

    def __init__(self, size: int, gvfs: int, count: int, every: int = 30, share: float = 0.95) -> None:
        if not (count >= 2 and every >= 1 and 0 < share <= 1):
            raise ValueError(
                "An interval needs at least 2 weight vectors, kept every tick or more rarely, and a share "
                f"above 0 up to 1, not {count}, {every} and {share}."
            )
        # A feature's weights of all times lie side by side, as a prediction reads them.
        super().__init__(
            gvfs, {"weights": ((size, count), np.nan)}, {"ticks": np.zeros(1), "kept": np.zeros(1)}
        )
        self._slots = count
        self._every = every
        self._tails = ((1 - share) / 2, (1 + share) / 2)

    def step(
        self,
        features: Features,
        weights: Callable[[], NDArray[np.float64]],
        values: NDArray[np.float64] | None = None,
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Bounds of the predictions here, shape (m,) each; NaN until two weight vectors of a GVF were kept.

        `weights`: asked for the current ones, shape (size, m), when they are to be kept. `values`: those of
        the `features`, shape (k,), if they are not all 1.
        """
        ticks, kept = self._shared["ticks"], self._shared["kept"]
        if ticks[0] % self._every == 0:
            self._own["weights"][:, int(kept[0]) % self._slots] = weights()
            kept += 1
        ticks += 1
        rows = self._own["weights"].take(features, axis=0)
        if values is not None:
            rows *= values[:, None, None]
        answers = np.sort(rows.sum(axis=0), axis=0)  # NaN come last
        return self._percentile(answers, self._tails[0]), self._percentile(answers, self._tails[1])

    def _percentile(self, answers: NDArray[np.float64], share: float) -> NDArray[np.float64]:
        """Linear between the two nearest of those that are known, which differ in number from GVF to GVF."""
        known = np.isfinite(answers).sum(axis=0)
        place = np.maximum(known - 1, 0) * share
        below = place.astype(np.intp)
        above = np.minimum(below + 1, np.maximum(known - 1, 0))
        column = np.arange(answers.shape[1])
        low, high = answers[below, column], answers[above, column]
        percentile: NDArray[np.float64] = np.where(known > 1, low + (place - below) * (high - low), np.nan)
        return percentile
