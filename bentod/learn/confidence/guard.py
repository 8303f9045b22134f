"""Which learners have diverged: predictions that no return can have.

With B the largest |R_i| / (1 − γ_i) that was ever seen, every return of such rewards is within B:

    |G_t| ≤ Σ_i (Π_{j<i} γ_j) |R_i| ≤ B Σ_i (Π_{j<i} γ_j) (1 − γ_i) = B (1 − Π_j γ_j) ≤ B,

the sum in the middle being one of differences Π_{j<i} γ_j − Π_{j≤i} γ_j. It holds whether γ is constant or
depends on the state, for scaled cumulants (B is the largest cumulant then) and for others, and when R and γ
are those of several ticks at once. So a learner that is right is within B as long as the cumulant does what
it did before. The bound is `slack` times B, because cumulants do something new, and because a learner over
shared features goes too far on its way to being right. This costs a learner that grows exponentially a
moment only.

Where γ was 1 as a reward came in, B is infinite, and where none ever came it is 0 and nothing is known:
then only a prediction that is not finite is told. B belongs to the weights: whoever restores those must
recall it.
"""

import numpy as np
from numpy.typing import NDArray

from bentod.learn.confidence.columns import Columns

SLACK = 100.0


def exploding(
    predictions: NDArray[np.float64], bound: NDArray[np.float64], slack: float = SLACK
) -> NDArray[np.bool_]:
    """Whether each is not finite, or further from 0 than `slack` times its `bound`, unless that is 0."""
    reasonable = np.where(bound > 0, slack * bound, np.inf)
    told: NDArray[np.bool_] = ~((np.abs(predictions) <= reasonable) & np.isfinite(predictions))
    return told


class Guard(Columns):
    """Knows B of each GVF. `initial`: their first predictions, shape (m,), which are within the bound too."""

    def __init__(self, initial: NDArray[np.float64], slack: float = SLACK) -> None:
        if not slack >= 1:
            raise ValueError(f"The slack of a guard must be at least 1, not {slack}.")
        super().__init__(len(initial), {"bound": ((), 0.0)})
        self._own["bound"][:] = np.abs(initial)
        self._slack = slack

    def step(
        self,
        predictions: NDArray[np.float64],
        cumulants: NDArray[np.float64],
        gamma: NDArray[np.float64] | float,
    ) -> NDArray[np.bool_]:
        """Whether each learner has diverged, shape (m,), after R_{t+1} = `cumulants` and γ_{t+1} = `gamma`.

        A cumulant that is not finite says nothing.
        """
        size = np.where(np.isfinite(cumulants), np.abs(cumulants), 0)
        rest = np.broadcast_to(1 - np.asarray(gamma, dtype=np.float64), size.shape)
        with np.errstate(over="ignore"):
            reach = np.where(rest > 0, size / np.where(rest > 0, rest, 1), np.where(size > 0, np.inf, 0))
            np.maximum(self._own["bound"], reach, out=self._own["bound"])
            return exploding(predictions, self._own["bound"], self._slack)

    def grow(self, count: int, initial: NDArray[np.float64] | float = 0.0) -> None:
        """Take on `count` more GVFs with these first predictions, behind the others."""
        super().grow(count)
        self._own["bound"][self.count - count :] = np.abs(initial)

    def forget(self, columns: NDArray[np.intp]) -> None:
        """Nothing: what a cumulant can be is no less true because its learner begins anew."""
