"""How strongly muscles contract, and what speed that asks for within a class."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bentod.emg.recognition import Windows

LOWER, UPPER = 0.1, 0.7
"""Shares of a class's range in training at which speed begins, and is full (as LibEMG has them)."""


def loudness(windows: Windows) -> NDArray[np.float64]:
    """Sum of the channels' mean absolute values (V), shape (windows,)."""
    # A copy in this order has every sum of a window in a row of its own, alone or among others.
    magnitudes = np.abs(np.ascontiguousarray(windows))
    means: NDArray[np.float64] = np.add.reduce(np.add.reduce(magnitudes, axis=2), axis=1) / windows.shape[2]
    return means


@dataclass(frozen=True, slots=True)
class Range:
    """The loudness (V) of a class in training."""

    least: float
    greatest: float

    def speed(self, loud: float) -> float:
        """0 up to `LOWER` of the range, 1 from `UPPER` of it on."""
        width = self.greatest - self.least
        low, high = self.least + LOWER * width, self.least + UPPER * width
        if not low < high:
            return float(loud >= high)
        return min(max((loud - low) / (high - low), 0.0), 1.0)


def ranges(loud: NDArray[np.float64], labels: Sequence[str]) -> Mapping[str, Range]:
    """By class, from the loudness and the label of each training window."""
    named = np.asarray(labels, np.str_)
    return {
        str(label): Range(float(loud[named == label].min()), float(loud[named == label].max()))
        for label in np.unique(named)
    }
