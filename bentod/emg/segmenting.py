"""Cutting a signal into windows by sample index: off-line all at once, on-line as the blocks come."""

from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from bentod.emg.recognition import Segmenting, Windows
from bentod.errors import ConfigError


def segmenting(window_s: float, step_s: float, rate_hz: float) -> Segmenting:
    """Windows of `window_s` every `step_s` (s), in whole samples at `rate_hz`.

    Raises:
        ConfigError: a window has fewer than 2 samples, or windows are less than a sample apart.
    """
    return checked(Segmenting(round(window_s * rate_hz), round(step_s * rate_hz)))


def checked(asked: Segmenting) -> Segmenting:
    """The same. Raises ConfigError: a window has fewer than 2 samples, or the step is below 1."""
    if asked.length < 2:
        raise ConfigError(f"a window of {asked.length} samples is too short; it needs at least 2", "window_s")
    if asked.step < 1:
        raise ConfigError(f"windows {asked.step} samples apart are too close; it takes at least 1", "step_s")
    return asked


def cut(samples: NDArray[np.floating], asked: Segmenting) -> Windows:
    """All windows that `samples` (V, shape (n, channels)) has whole, sample 0 being the first of window 0.

    Shape (windows, channels, length): a look at `samples` if they are float64, at one copy of them if not.
    """
    length, step = checked(asked).length, asked.step
    volts = np.asarray(samples, np.float64)
    if len(volts) < length:
        return np.empty((0, volts.shape[1], length))
    return sliding_window_view(volts, length, axis=0)[::step]


def complete(samples: NDArray[np.floating], asked: Segmenting) -> NDArray[np.bool_]:
    """Which of the windows of `cut` have nothing but finite samples, shape (windows,)."""
    length, step = checked(asked).length, asked.step
    if len(samples) < length:
        return np.zeros(0, bool)
    bad = np.concatenate(([0], np.cumsum(~np.isfinite(samples).all(axis=1))))
    whole: NDArray[np.bool_] = bad[length:] == bad[:-length]
    return whole[::step]


@dataclass(frozen=True, slots=True)
class Cut:
    """The windows that one block completed."""

    first: int  # number of windows[0]: it begins at sample first * step
    windows: Windows  # a look into the segmenter's own samples: use or copy it before the next block
    complete: NDArray[np.bool_]  # shape (windows,); False: samples are missing or not finite, do not compute
    lost: int = 0  # windows just before `first` that fell into a gap too long to be looked at


class Segmenter:
    """What is fed block by block comes out in windows, the same ones for any blocks.

    Window k has the samples from k·step to k·step + length. The first is the first that begins with or
    after the first block; after a gap there are windows with NaN in them, told as not complete, and nothing
    shifts.
    """

    def __init__(self, asked: Segmenting, channels: int) -> None:
        """Raises ConfigError: as `checked`."""
        self.segmenting = checked(asked)
        self._rows = np.full((4 * max(asked.length, asked.step), channels), np.nan)
        self._first = 0  # index of the sample in row 0
        self._held = 0  # rows in use
        self._number = -1  # of the next window; below 0: nothing has come yet

    @property
    def next_index(self) -> int:
        """Index after the newest sample."""
        return self._first + self._held

    def feed(self, first_index: int, samples: NDArray[np.floating]) -> Cut:
        """Take a block (V, shape (n, channels), the first with index `first_index`).

        Raises:
            ValueError: the block does not follow what has come, or has another number of channels.
        """
        if samples.shape[1:] != self._rows.shape[1:]:
            raise ValueError(
                f"a block of shape {samples.shape} came where rows have {self._rows.shape[1]} channels"
            )
        if self._number < 0:
            self._begin(first_index)
        gap = first_index - self.next_index
        if gap < 0:
            raise ValueError(f"sample {first_index} came after sample {self.next_index - 1}")
        lost = self._skip(first_index) if gap > len(self._rows) else 0
        self._put(first_index, samples)
        return self._take(lost)

    def _begin(self, index: int) -> None:
        self._number = -(-index // self.segmenting.step)
        self._first = index

    def _skip(self, index: int) -> int:
        """Leave out the windows that end before `index` and return how many; hours may have passed."""
        length, step = self.segmenting.length, self.segmenting.step
        number = max(self._number, (index - length) // step + 1)
        lost, self._number = number - self._number, number
        self._first, self._held = min(number * step, index), 0
        return lost

    def _put(self, index: int, samples: NDArray[np.floating]) -> None:
        """Hold the block after what is still needed, NaN between them."""
        start = min(max(self._number * self.segmenting.step - self._first, 0), self._held)
        needed = index + len(samples) - self._first
        if needed > len(self._rows):
            kept = self._rows[start : self._held].copy()
            self._first, self._held = self._first + start, len(kept)
            needed -= start
            if needed > len(self._rows):
                self._rows = np.full((2 * needed, self._rows.shape[1]), np.nan)
            self._rows[: len(kept)] = kept
        self._rows[self._held : needed - len(samples)] = np.nan
        self._rows[needed - len(samples) : needed] = samples
        self._held = needed

    def _take(self, lost: int) -> Cut:
        """The windows that are there now."""
        start = self._number * self.segmenting.step - self._first
        rows = self._rows[min(start, self._held) : self._held]
        rows.flags.writeable = False
        cuts = Cut(self._number, cut(rows, self.segmenting), complete(rows, self.segmenting), lost)
        self._number += len(cuts.windows)
        return cuts
