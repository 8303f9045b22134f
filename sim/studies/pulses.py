"""Three trains of square pulses of the same size, one after another, as thesis 4.5.2 has them."""

import numpy as np
from numpy.typing import NDArray

PERIOD, WIDTH = 40, 10  # steps; the thesis does not say
OFFSETS = (0, 10, 20)  # steps, of X1, X2 and X3


def pulses(steps: int) -> NDArray[np.float64]:
    """X1, X2 and X3, each 0 or 1; shape (steps, 3)."""
    since = (np.arange(steps)[:, None] - np.array(OFFSETS)) % PERIOD
    on: NDArray[np.float64] = (since < WIDTH).astype(np.float64)
    return on
