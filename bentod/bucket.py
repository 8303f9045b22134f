"""How often something may happen: a bucket of tokens that fills at a steady rate."""

from collections import OrderedDict
from collections.abc import Callable

MOST_KINDS = 256
"""Kinds of lines that a `Hush` tells apart."""


class Bucket:
    """Tokens come at `rate` (1/s) until there are `most`; who takes one too early waits for it."""

    def __init__(self, rate: float, most: float, now: Callable[[], float]) -> None:
        """`now`: monotonic s."""
        self._rate = rate
        self._most = most
        self._now = now
        self._tokens = most
        self._filled = now()

    def take(self, tokens: float = 1.0) -> float:
        """Take tokens; how long (s) until they are there."""
        self._fill()
        self._tokens -= tokens
        return self.debt()

    def debt(self) -> float:
        """How long (s) until every token that was taken is there."""
        self._fill()
        return max(0.0, -self._tokens / self._rate)

    def _fill(self) -> None:
        now = self._now()
        self._tokens = min(self._most, self._tokens + (now - self._filled) * self._rate)
        self._filled = now


class Seldom:
    """Lets one through in `every` seconds, and counts those that it does not."""

    def __init__(self, every: float, now: Callable[[], float]) -> None:
        self._every = every
        self._now = now
        self._next = float("-inf")
        self._passed_over = 0

    @property
    def is_over(self) -> bool:
        """Whether the next one is let through."""
        return self._now() >= self._next

    def take(self) -> str | None:
        """None: not now. Otherwise the end of a sentence that says how many were passed over before."""
        if not self.is_over:
            self._passed_over += 1
            return None
        self._next = self._now() + self._every
        more, self._passed_over = self._passed_over, 0
        return f" ({more} more like it were not logged)" if more else ""


class Hush:
    """A `Seldom` for each kind of line in a log: nobody fills it with one kind, nor hides another by it."""

    def __init__(self, every: float, now: Callable[[], float]) -> None:
        self._every = every
        self._now = now
        self._kinds: OrderedDict[str, Seldom] = OrderedDict()
        self._others = Seldom(every, now)

    def take(self, *kind: str) -> str | None:
        """As `Seldom.take`, for this kind. While very many kinds come up, the newest share one."""
        key = "\0".join(kind)
        if key not in self._kinds and not self._has_room():
            return self._others.take()
        seldom = self._kinds.pop(key, None) or Seldom(self._every, self._now)
        self._kinds[key] = seldom
        return seldom.take()

    def _has_room(self) -> bool:
        if len(self._kinds) >= MOST_KINDS and next(iter(self._kinds.values())).is_over:
            self._kinds.popitem(last=False)
        return len(self._kinds) < MOST_KINDS
