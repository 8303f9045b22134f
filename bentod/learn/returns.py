"""What a perfect learner would have predicted: the scaled return of a recorded signal (thesis 5.3)."""

import numpy as np
from numpy.typing import NDArray


def discount(timescale: float) -> float:
    """γ = 1 − 1/τ, thesis (2.16), for a prediction that looks τ = `timescale` steps ahead.

    Raises:
        ValueError: the timescale is below 1 step, or infinite.
    """
    if not 1 <= timescale < float("inf"):
        raise ValueError(f"A timescale must be at least 1 step and finite, not {timescale}.")
    return 1 - 1 / timescale


def ideal_predictions(signal: NDArray[np.float64], timescale: float) -> NDArray[np.float64]:
    """Σ_{i≥1} γ^{i−1} (1 − γ) θ_{t+i} at each step t. `signal`: θ, shape (steps,) or (steps, joints).

    The result has the shape of `signal`. It is computed backwards, G_t = (1 − γ) θ_{t+1} + γ G_{t+1}.
    A recording ends, the sum does not: the signal is taken to stay at its last value for ever, so G at the
    last step is that value. At n steps from the end this guess weighs γ^n: 5 % at three timescales, 1 % at
    4.6. Leave out the end of the recording where that matters.
    """
    gamma = discount(timescale)
    ideal = np.array(signal, dtype=np.float64)
    for t in range(len(ideal) - 2, -1, -1):
        ideal[t] = (1 - gamma) * signal[t + 1] + gamma * ideal[t + 1]
    return ideal
