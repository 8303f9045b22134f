"""When samples were taken, for devices that do not say: from their count, and from when they arrived."""

import math

QUARTZ = 2e-4
"""s a second that two quartz clocks may part for good."""

WINDOW = 1.0
"""s; in each the least delay counts, since what comes on top of it is the way's and not the clock's."""

CREEP = 0.03
"""s from one window to the next, above which it is no clock that is slow."""

LATE = 0.05
"""s by which the delay may jump for good. Beyond, samples were lost on the way without a trace, or a queue
was left standing: the two look the same, and either is over once the device has been opened again."""

SLOW = 0.25
"""s of delay that may creep in."""


class Timeline:
    """Indices and times of blocks from a device that takes samples at an even rate.

    A sample is never newer than the moment in which it arrived, so a device that is fast is followed at
    once. One that is slow is followed as fast as its clock may be slow, and no faster: what grows beyond
    may be a queue, which must show, so it is left in the stamps.
    """

    def __init__(self, rate_hz: float, slow: float = QUARTZ) -> None:
        """`slow`: share by which the device's clock may be slow for good."""
        self.next_index = 0
        """Index of the next sample."""
        self.trouble = ""
        """Why the device should be opened again, as the rest of a sentence after its name; empty if not."""
        self._rate_hz = rate_hz
        self._slow = slow
        self._start = math.inf  # monotonic s of sample 0, as far as is known
        self._least = math.inf  # s, least delay in this window
        self._before = math.inf  # s, in the window before
        self._jumped = 0.0  # s
        self._ends = math.inf  # monotonic s, of this window
        self._origin = (0, math.inf)  # an index and its arrival, from which the rate is measured

    def place(self, count: int, arrival: float, lost: int = 0) -> tuple[int, float]:
        """Index and time (monotonic s) of the first of `count` samples that arrived at `arrival`.

        `lost`: samples known to be missing just before them.
        """
        first = self.next_index + lost
        self.next_index = first + count
        latest = arrival - (self.next_index - 1) / self._rate_hz
        if not math.isfinite(self._start):
            self._ends = arrival + WINDOW
            self._origin = (self.next_index, arrival)
        self._start = min(self._start, latest)
        self._least = min(self._least, latest - self._start)
        if arrival >= self._ends:
            self._turn(arrival)
        return first, self._start + first / self._rate_hz

    def _turn(self, now: float) -> None:
        """Close a window."""
        self._judge(now)
        followed = min(self._least, self._slow * WINDOW)
        self._start += followed
        self._before, self._least = self._least - followed, math.inf
        self._ends = now + WINDOW

    def _judge(self, now: float) -> None:
        change = self._least - self._before
        if abs(change) > CREEP and math.isfinite(change):
            self._jumped = max(0.0, self._jumped + change)
        if self._jumped > LATE:
            self.trouble = f"has lost samples, or is {self._jumped:.2f} s late and does not catch up"
        elif self._least > SLOW:
            index, arrival = self._origin
            measured = (self.next_index - index) / (now - arrival)
            self.trouble = (
                f"comes later and later, by {self._least:.2f} s now; it gave {measured:.1f} samples a "
                f"second, not {self._rate_hz:g}: if that is its clock, let the config's rate_hz say so"
            )
