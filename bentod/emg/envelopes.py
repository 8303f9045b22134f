"""How loud a signal is, but by its mean absolute value: root mean square, or rectified and smoothed."""

from typing import Protocol

import numpy as np

from bentod.config_conditioning import Filter
from bentod.emg.conditioning import Conditioning, Volts
from bentod.frames import Samples

ORDER = 2
"""Of the low-pass: no slower than it must be, and smooth after a contraction begins."""


class Mean(Protocol):
    """The mean over a window of what does not change sign, at every sample."""

    def step(self, samples: Samples | Volts) -> Volts:
        """All that came since the last step (shape (n, channels)), averaged; NaN where it is not known."""
        ...

    def reset(self) -> None:
        """Forget every sample, as at the start."""
        ...


class RootMeanSquare:
    """Root mean square (V) over a window."""

    def __init__(self, mean: Mean) -> None:
        self._mean = mean

    def step(self, samples: Samples | Volts) -> Volts:
        """All that came since the last step (V, shape (n, channels)), in the same shape."""
        return np.sqrt(self._mean.step(np.square(samples.astype(np.float64))))

    def reset(self) -> None:
        """Forget every sample, as at the start."""
        self._mean.reset()


class LowPass:
    """The rectified signal (V) below a frequency: the smoothest envelope, and the slowest."""

    def __init__(self, hz: float, rate_hz: float, channels: int) -> None:
        """Raises ConfigError: SciPy is missing."""
        self._filters = (Filter(kind="low_pass", hz=hz, order=ORDER),)
        self._rate_hz = rate_hz
        self._channels = channels
        self.reset()

    def step(self, samples: Samples | Volts) -> Volts:
        """All that came since the last step (V, shape (n, channels)), in the same shape."""
        return np.maximum(self._smooth.step(np.abs(samples)), 0.0)

    def reset(self) -> None:
        """Forget every sample, as at the start."""
        self._smooth = Conditioning(self._filters, self._rate_hz, self._channels)
