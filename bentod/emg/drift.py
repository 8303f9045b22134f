"""How far the time stamps of a source walk away from the daemon's clock, because its own runs differently."""

import math

GREATEST = 0.02
"""s a second that two clocks may part. Quartz parts by 1e-4, the oscillator of a microcontroller by 1e-2."""

WINDOW = 1.0
"""s; in each the least delay counts, since what comes on top of it is the way's and not the clock's."""


TOTAL = 0.3
"""s of delay that are taken for the clock's at most, beyond what quartz explains: so old may samples pass for
new when it was the way all along that grew. At 1 %, which is no quartz's, that is half a minute."""

QUARTZ = 2e-4
"""s a second that two quartz clocks may part for good."""


class Drift:
    """The delay of blocks, followed as far as it can be the clock's doing.

    A delay that jumps is a late source, and stays late. One that creeps by less than `GREATEST` cannot be
    told from a clock that is slow, and is taken for it, up to `TOTAL`. A source whose clock is so slow is
    late then, too, until the config says the rate that it really has. A delay that shrinks can only be a
    clock that is fast, which is followed for ever.
    """

    def __init__(self) -> None:
        self.offset = 0.0
        """s to be added to a stamp."""
        self._explained = 0.0  # s, followed at the pace of quartz
        self._least = math.inf
        self._before = math.nan
        self._ends = -math.inf

    def take(self, stamp: float, arrival: float) -> None:
        """A block whose newest sample is stamped `stamp` arrived at `arrival` (monotonic s)."""
        if arrival >= self._ends:
            self._turn()
            self._ends = arrival + WINDOW
        self._least = min(self._least, arrival - stamp)

    def _turn(self) -> None:
        """Close a window."""
        change = self._least - self._before
        if abs(change) <= GREATEST * WINDOW * 1.5:  # a window may have begun just before, or end just after
            self.offset = min(self.offset + change, self._explained + TOTAL)
            self._explained = min(self._explained + QUARTZ * WINDOW, self.offset)
        if self._least < math.inf:
            self._before, self._least = self._least, math.inf
