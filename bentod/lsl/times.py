"""Monotonic time as LSL's clock tells it."""

from collections.abc import Callable
from dataclasses import dataclass

READINGS = 5
"""Of both clocks, of which the quickest counts: in the others something came in between."""


@dataclass(frozen=True, slots=True)
class Clocks:
    """Two clocks of this machine, both in s.

    LSL's clock is C++'s steady_clock (LSL's FAQ), on Linux the kernel's monotonic clock, which is ours, too.
    That is measured, not believed: elsewhere the two may count from different beginnings.
    """

    lsl: Callable[[], float]
    monotonic: Callable[[], float]

    def offset(self) -> float:
        """What LSL's clock shows more than the monotonic one (s), now."""
        return min(self._reading() for _ in range(READINGS))[1]

    def _reading(self) -> tuple[float, float]:
        """How long a reading took, and the offset that it found (s)."""
        before = self.monotonic()
        shown = self.lsl()
        after = self.monotonic()
        return after - before, shown - (before + after) / 2
