"""All browsers that look: a frame is encoded once, and the same bytes go to each that has kept up."""

import struct
from collections import deque
from collections.abc import Callable
from typing import Protocol

AHEAD = 8
"""Frames that may be on their way to a browser; one that has not taken in the others gets no more."""

REMEMBERED = 256
"""Frames whose time of sending is known: 8 s at 30 Hz."""

_BINARY = 0x82  # the only and last fragment of a binary message
_SHORT, _LONG = 126, 127


def websocket_frame(payload: bytes) -> bytes:
    """`payload` as a server sends it, not masked (RFC 6455, 5.2): the same bytes for every browser."""
    size = len(payload)
    if size < _SHORT:
        head = struct.pack(">BB", _BINARY, size)
    elif size < 1 << 16:
        head = struct.pack(">BBH", _BINARY, _SHORT, size)
    else:
        head = struct.pack(">BBQ", _BINARY, _LONG, size)
    return head + payload


class Listener(Protocol):
    """A browser that has said who it is."""

    def send(self, frame: bytes) -> None:
        """Pass on a WebSocket frame. Never waits."""
        ...

    @property
    def ahead(self) -> int:
        """Frames on their way."""
        ...

    def skipped(self) -> None:
        """Another frame was not sent, because the browser is slow."""
        ...

    def sent(self, number: int) -> None:
        """The frame of that number is on its way."""
        ...


class Audience:
    """Who gets frames, and when each frame was sent. `now`: monotonic s."""

    def __init__(self, now: Callable[[], float]) -> None:
        self.listeners: set[Listener] = set()
        self._now = now
        self._times: deque[tuple[int, float]] = deque(maxlen=REMEMBERED)
        self._number = 0

    def next_number(self) -> int:
        """The number of the frame that is shown next, from 1 on; it counts as sent now."""
        self._number += 1
        self._times.append((self._number, self._now()))
        return self._number

    def age(self, number: int) -> float:
        """How long ago (s) a frame was sent; infinite when it was not, or too long ago to know."""
        return next((self._now() - time for sent, time in self._times if sent == number), float("inf"))

    def show(self, number: int, message: bytes) -> None:
        """Send a frame to all that have kept up: slow ones get fewer, never old ones."""
        frame = websocket_frame(message)
        for listener in list(self.listeners):
            if listener.ahead >= AHEAD:
                listener.skipped()
            else:
                listener.send(frame)
                listener.sent(number)

    def tell(self, message: bytes) -> None:
        """Send to all what must not be missed."""
        frame = websocket_frame(message)
        for listener in list(self.listeners):
            listener.send(frame)
