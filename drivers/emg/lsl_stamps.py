"""Indices and times from the stamps of a stream that says when, but not how many samples it lost."""

import math

import numpy as np
from numpy.typing import NDArray

FOLLOWED = 0.01
"""s a second by which the sender's clock is followed when it is slower than its rate says."""

GAP_S = 0.01
"""s that stamps must be too late to tell of a gap: a chunk's are uneven by some milliseconds."""

SURE_S = 0.1
"""s through which they must stay too late. Samples that were only held up catch up in that time."""


class Stamps:
    """The even line on which samples lie, drawn under their stamps, since a stamp can be late but not early.

    One that is earlier than the line shifts it at once. When all are later for `SURE_S`, samples are missing.
    """

    def __init__(self, rate_hz: float) -> None:
        self._rate_hz = rate_hz
        self._next = 0  # index
        self._start = math.nan  # s of sample 0 on the line
        self._newest = math.nan  # s, newest stamp
        self._late_since = math.nan  # s
        self._least = math.inf  # s, by which all have been late since then

    def place(self, stamps: NDArray[np.float64]) -> tuple[int, float, int]:
        """Index and time (s) of the first of some samples, and how many are missing before it.

        `stamps`: s, shape (samples,), at least one.
        """
        starts = stamps - (self._next + np.arange(len(stamps))) / self._rate_hz
        earliest = float(starts.min())
        if math.isnan(self._start):
            self._start, self._newest = earliest, float(stamps[-1])
        lost = self._lost(earliest, float(stamps[-1]))
        first = self._next + lost
        self._next = first + len(stamps)
        return first, self._start + first / self._rate_hz, lost

    def _lost(self, earliest: float, newest: float) -> int:
        """Move the line, where sample 0 may have been at `earliest` (s); how many samples are missing."""
        late = earliest - self._start
        passed = max(newest - self._newest, 0.0)
        self._newest = newest
        if late <= max(GAP_S, 1.5 / self._rate_hz):
            self._start += min(late, FOLLOWED * passed)
            self._late_since, self._least = math.nan, math.inf
            return 0
        self._least = min(self._least, late)
        if math.isnan(self._late_since):
            self._late_since = newest
        if newest - self._late_since < SURE_S:
            return 0
        lost = round(self._least * self._rate_hz)
        self._late_since, self._least = math.nan, math.inf
        return lost
