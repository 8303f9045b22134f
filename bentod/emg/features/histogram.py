"""Shares of samples in bins of equal width, whose ends come from training data."""

from itertools import pairwise

import numpy as np

from bentod.emg.features.rows import Floats, Rows
from bentod.emg.features.tables import Histogram
from bentod.emg.recognition import Windows
from bentod.errors import ConfigError

SPREAD = 3.0
"""Standard deviations from the mean to both ends; of Gaussian noise 0.3 % are farther out."""

LEAST_V = 1e-9
"""V, least way from the mean to an end: for a channel that never moved in training."""

AT_ONCE = 512
"""Windows that are looked at in one go, so that memory does not grow with the recording."""


class Bins:
    """Counts samples into `out`, shape (windows, channels, segments, bins)."""

    def __init__(self, rows: Rows, asked: Histogram, out: Floats) -> None:
        """Raises ConfigError: the ends are not known."""
        if not asked.low_v:
            raise ConfigError(
                "the feature 'hist' has no bins yet; they come from training data (fit)", "hist"
            )
        low, high = np.array(asked.low_v), np.array(asked.high_v)
        self._rows, self._bins, self._out = rows, asked.bins, out
        self._low = low[:, np.newaxis, np.newaxis]
        self._scale = asked.bins / (high - low)[:, np.newaxis, np.newaxis]
        self._places = np.empty(rows.x.shape)
        self._base = np.arange(out[..., 0].size).reshape(*rows.shape, 1) * asked.bins

    def count(self) -> None:
        """Of the samples that are loaded."""
        places = self._places
        np.subtract(self._rows.x, self._low, places)
        np.multiply(places, self._scale, places)
        np.maximum(places, 0, out=places)
        np.minimum(places, self._bins - 1, out=places)
        numbers = places.astype(np.intp)
        numbers += self._base
        counts = np.bincount(numbers.reshape(-1), minlength=self._out.size)
        np.divide(counts.reshape(self._out.shape), self._rows.length, self._out)


def fitted(asked: Histogram, windows: Windows) -> Histogram:
    """The same with bins over the mean ± 3 standard deviations of each channel of `windows`.

    Raises:
        ConfigError: there is no window.
    """
    if not len(windows):
        raise ConfigError("the feature 'hist' cannot find its bins: there is no window to learn from", "hist")
    number = windows.shape[0] * windows.shape[2]
    mean = _sum(windows, np.zeros(windows.shape[1]), 1) / number
    apart = np.maximum(SPREAD * np.sqrt(_sum(windows, mean, 2) / number), LEAST_V)
    ends = {"low_v": tuple((mean - apart).tolist()), "high_v": tuple((mean + apart).tolist())}
    return asked.model_copy(update=ends)


def _sum(windows: Windows, middle: Floats, power: int) -> Floats:
    """Σ (x − middle)^power of each channel."""
    ends = [*range(0, len(windows), AT_ONCE), len(windows)]
    total = np.zeros(len(middle))
    for start, stop in pairwise(ends):
        total += ((windows[start:stop] - middle[:, np.newaxis]) ** power).sum(axis=(0, 2))
    return total
