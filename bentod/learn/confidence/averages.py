"""Averages that forget exponentially and are right from the first value on, for many GVFs at once."""

import numpy as np
from numpy.typing import NDArray

_NOTHING = 1e-300  # keeps 0 / 0 from being computed where nothing has ever been seen


def weight(seen: NDArray[np.float64], kept: NDArray[np.float64]) -> NDArray[np.float64]:
    """The weight of what is new in an average, and updates `seen` in place.

    `kept`: what is left of the weight of all that came before, (1 − β)^n after n new values; 1 for none.
    `seen`: the sum of all weights so far, 0 at first, which tends to 1. An average with weights β (1 − β)^i
    starts at 0, and is too small by the factor `seen`; with the weight (1 − kept) / seen it is an average
    of the values alone, from the first on (Sutton & Barto 2018, exercise 2.7).
    """
    seen += (1 - seen) * (1 - kept)
    share: NDArray[np.float64] = (1 - kept) / np.maximum(seen, _NOTHING)
    return share


def mix(
    mean: NDArray[np.float64],
    variance: NDArray[np.float64],
    new_mean: NDArray[np.float64],
    new_variance: NDArray[np.float64] | float,
    share: NDArray[np.float64],
) -> None:
    """Update mean and variance in place to those of a mixture: the old with 1 − share, the new with share.

    var = (1 − s) var + s var_new + s (1 − s) (mean_new − mean)², the law of total variance: nothing is
    subtracted, so it is never negative, and exact however far the mean is from 0.
    """
    difference = new_mean - mean
    mean += share * difference
    variance *= 1 - share
    variance += share * (new_variance + (1 - share) * difference * difference)
