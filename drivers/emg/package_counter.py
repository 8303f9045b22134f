"""Packages that a board counted and we never saw, by counters of which nobody says how they count."""

import math
from collections.abc import Sequence


class PackageCounter:
    """Finds gaps in a counter that goes round, by what it has done so far.

    Boards differ: in where they begin again (256, 200, never), in the step (2 where two packages make one
    sample), and in how many samples share a number. So the least step that was seen is the usual one, the
    highest and the lowest number at a turn are its ends, and as many samples are lost with a package as came
    with the one before. What is lost before that is known, in the first round, may be missed.
    """

    def __init__(self) -> None:
        self._number = math.nan
        self._run = 0  # samples so far that share the number
        self._step = math.inf
        self._top = -math.inf
        self._bottom = math.inf

    def gaps(self, numbers: Sequence[float]) -> list[tuple[int, int]]:
        """Where samples are missing: (place in `numbers`, samples lost just before it), in order."""
        lost = ((place, self._lost(number)) for place, number in enumerate(numbers))
        return [(place, count) for place, count in lost if count]

    def _lost(self, number: float) -> int:
        """Samples lost just before the one that is counted `number`."""
        if number == self._number or not math.isfinite(number):
            self._run += 1
            return 0
        rise, turned = self._rise(number)
        if not turned and rise > 0:
            self._step = min(self._step, rise)
        steps = rise / self._step if rise > 0 else 1.0
        lost = max(0, round(steps) - 1) * self._run
        self._number, self._run = number, 1
        return lost

    def _rise(self, number: float) -> tuple[float, bool]:
        """By how much the counter rose, and whether it turned; 0 where that cannot be known."""
        rise = number - self._number
        if math.isnan(rise):
            return 0.0, False
        if rise > 0:
            return rise, False
        known = self._top >= self._number and math.isfinite(self._step)
        after_turn = self._step + (self._top - self._number) + max(0.0, number - self._bottom)
        self._top = max(self._top, self._number)
        self._bottom = min(self._bottom, number)
        return (after_turn if known else 0.0), True
