"""Whether what clients ask may be older than it looks, because nobody listened for a while."""

import math

from bentod.errors import Refused

HELD_UP = 0.5
"""s between two ticks, beyond which nobody knows how old a request is that waited in a socket meanwhile: the
client that sent it may have let go since, or be gone."""

DEAF = 0.1
"""s after such a gap in which requests are refused, enough to read what had piled up."""


class Recency:
    """Refuses what may start or permit motion when the daemon was held up. Restraint is always heard."""

    def __init__(self) -> None:
        self._now = math.nan
        self._gap = 0.0
        self._deaf_until = -math.inf

    def begin(self, now: float) -> None:
        """A tick begins (monotonic s)."""
        if now - self._now > HELD_UP:
            self._gap = now - self._now
            self._deaf_until = now + DEAF
        self._now = now

    def slept(self, gap: float) -> None:
        """The machine was suspended for `gap` (s), which the monotonic clock does not count."""
        self._gap = gap
        self._deaf_until = self._now + DEAF

    def doubt(self) -> str:
        """Why a request may be an old one, as a sentence; empty if it is not."""
        if not self._now < self._deaf_until:
            return ""
        return f"the daemon was held up for {self._gap:.2f} s, and this request may be as old: ask again"

    def require(self) -> None:
        """Raise Refused if a request may be an old one."""
        if doubt := self.doubt():
            raise Refused(doubt)
