"""What waits to be sent to one client: a few notices, oldest dropped first, and the newest state only."""

import asyncio
import math
from collections import deque

SLACK = 1e-3
"""s by which a frame may come before it is due; less than half of the shortest tick."""


class StateSlot:
    """The newest frame at a chosen rate. A frame that was not taken in time is replaced and counted."""

    def __init__(self) -> None:
        self.wanted = False
        self.replaced = 0
        self._period = 0.0
        self._due = 0.0
        self._frame: bytes | None = None

    def start(self, rate_hz: float) -> None:
        """Want frames, at most `rate_hz` a second; the next one is due at once."""
        self.wanted, self._period, self._due = True, 1 / rate_hz, -math.inf

    def stop(self) -> None:
        """Want no more frames."""
        self.wanted, self._frame = False, None

    def is_due(self, time: float) -> bool:
        """Whether a frame of `time` (s) is wanted; if so, the next one is due a period later."""
        if not self.wanted or time < self._due - SLACK:
            return False
        self._due += self._period
        if self._due <= time:  # the first frame, or the ticks are further apart than the period
            self._due = time + self._period
        return True

    def put(self, frame: bytes) -> None:
        """Replace what was not taken."""
        self.replaced += self._frame is not None
        self._frame = frame

    def take(self) -> bytes | None:
        """The newest frame, once."""
        frame, self._frame = self._frame, None
        return frame


class Outbox:
    """Notices before state; neither ever waits for the client."""

    def __init__(self, most_notices: int) -> None:
        self.state = StateSlot()
        self.filled = asyncio.Event()
        self.dropped = 0
        self._notices: deque[bytes] = deque(maxlen=most_notices)

    def put_notice(self, notice: bytes) -> None:
        """Queue an encoded notification; when the queue is full, the oldest is dropped and counted."""
        self.dropped += len(self._notices) == self._notices.maxlen
        self._notices.append(notice)
        self.filled.set()

    def put_state(self, frame: bytes) -> None:
        """Offer an encoded frame."""
        self.state.put(frame)
        self.filled.set()

    def take(self) -> bytes | None:
        """What to send next; None when there is nothing."""
        if self._notices:
            return self._notices.popleft()
        frame = self.state.take()
        if frame is None:
            self.filled.clear()
        return frame
