"""Failed attempts to get in: each makes the answer to the next slower, for its address and a bit for all.

Only wrong answers are slow. Whoever knows the token is let in at once, whatever others try meanwhile.
"""

from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass

MOST_ADDRESSES = 1024
"""That are remembered; the one that failed longest ago is forgotten first."""

FORGIVEN = 600.0
"""s after which failures are forgotten."""


@dataclass(frozen=True, slots=True)
class Penalty:
    """How the time until an answer grows."""

    free: int  # failures that cost nothing
    first: float  # s, then twice that, …
    most: float  # s

    def after(self, failures: int) -> float:
        """How long (s) to wait after so many failures."""
        beyond = failures - self.free
        return min(self.most, self.first * 2.0 ** min(beyond - 1, 30)) if beyond > 0 else 0.0


ONE = Penalty(free=2, first=0.5, most=5.0)
ALL = Penalty(free=20, first=0.1, most=2.0)


@dataclass(slots=True)
class _Record:
    failures: int = 0
    last: float = 0.0  # monotonic s


class Attempts:
    """Counts failures, of each address and of all together."""

    def __init__(self, now: Callable[[], float]) -> None:
        """`now`: monotonic s."""
        self._now = now
        self._all = _Record()
        self._addresses: OrderedDict[str, _Record] = OrderedDict()

    def failed(self, address: str) -> float:
        """Note a failure; how long (s) to wait before it is answered."""
        record = self._addresses.pop(address, _Record())
        self._addresses[address] = record
        if len(self._addresses) > MOST_ADDRESSES:
            self._addresses.popitem(last=False)
        return max(ONE.after(self._one_more(record)), ALL.after(self._one_more(self._all)))

    def succeeded(self, address: str) -> None:
        """Forget the failures of `address`: it knows the token."""
        self._addresses.pop(address, None)

    def _one_more(self, record: _Record) -> int:
        now = self._now()
        record.failures = 1 if now - record.last > FORGIVEN else record.failures + 1
        record.last = now
        return record.failures
