"""A Gaussian over γ that weighs several predictions (thesis 6.3, Fig. 6.1)."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray


def weights(gammas: Sequence[float], mean: float, sd: float) -> NDArray[np.float64]:
    """The share of each prediction, shape (γs,), 1 in all; `sd` above 0.

    The density without its factor, which cancels: w_i ∝ exp(−(γ_i − mean)² / 2 sd²). It is reckoned from the
    γ that is nearest to the mean, so that a narrow Gaussian between two of them is not 0 / 0.
    """
    squares = np.square((np.array(gammas, dtype=np.float64) - mean) / sd)
    density = np.exp(-0.5 * (squares - squares.min()))
    share: NDArray[np.float64] = density / density.sum()
    return share
