"""One client: who it is, what it holds until it leaves, and what is sent to it without waiting for it."""

import asyncio
import logging
import socket
import struct
from collections.abc import Callable, Sequence
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from typing import Literal, TypeAlias

from bentod.messages import encode_notification
from bentod.serve.outbox import Outbox

log = logging.getLogger(__name__)

Topic: TypeAlias = Literal["state", "events"]


@dataclass(frozen=True, slots=True)
class Bounds:
    """How much of the daemon one client may take."""

    clients: int = 64
    in_flight: int = 32  # requests of one client that are being handled
    notices: int = 256  # events that wait for one client
    unsent: int = 32 * 1024  # bytes that wait for a client to read, before it counts as stuck
    stuck: float = 5.0  # s that a client may be stuck
    farewell: float = 1.0  # s for the last requests and bytes of a client that leaves


@dataclass(frozen=True, slots=True)
class Peer:
    """The process at the other end, as the kernel knows it."""

    pid: int
    uid: int
    gid: int


class Session:
    """What handlers know of their client. Only the server makes one."""

    def __init__(self, id_: int, writer: asyncio.StreamWriter, bounds: Bounds) -> None:
        self.id = id_
        self.peer = _peer(writer)
        self.client = f"pid {self.peer.pid}"
        """Name of the client in logs, events and frames; a client may give a better one."""
        self.closed = False
        self.wants_events = False
        self._bounds = bounds
        self._outbox = Outbox(bounds.notices)
        self._left_behind = ExitStack()
        self._keys: set[str] = set()
        self._writer = writer
        writer.transport.set_write_buffer_limits(high=bounds.unsent)
        # The kernel's own 200 KiB would keep a slow client seconds behind the arm.
        _socket(writer).setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, bounds.unsent)

    def on_close(self, callback: Callable[[], object]) -> None:
        """Call `callback` when the client has left, last one first; at once if it already has."""
        if self.closed:
            callback()
        else:
            self._left_behind.callback(callback)

    def once(self, key: str, callback: Callable[[], object]) -> None:
        """`on_close`, but only the first time that `key` is given: for what every call would add again."""
        if key not in self._keys:
            self._keys.add(key)
            self.on_close(callback)

    def notify(self, method: str, params: Sequence[object]) -> None:
        """Queue a notification; the oldest is dropped when the client does not read."""
        self._outbox.put_notice(encode_notification(method, params))

    def subscribe(self, topic: Topic, rate_hz: float) -> None:
        """Send "state" at most `rate_hz` times a second (above 0), or every "event"."""
        if topic == "state":
            self._outbox.state.start(rate_hz)
        else:
            self.wants_events = True

    def unsubscribe(self, topic: Topic) -> None:
        """Send no more of `topic`."""
        if topic == "state":
            self._outbox.state.stop()
        else:
            self.wants_events = False

    @property
    def dropped_events(self) -> int:
        """Notifications that the client was too slow for."""
        return self._outbox.dropped

    @property
    def replaced_frames(self) -> int:
        """Frames that the client was too slow for."""
        return self._outbox.state.replaced

    def wants_state(self, time: float) -> bool:
        """Whether a frame of `time` (monotonic s) is due; asked once a tick."""
        return self._outbox.state.is_due(time)

    def offer_state(self, frame: bytes) -> None:
        """Queue an encoded frame in the place of one that is still unsent."""
        self._outbox.put_state(frame)

    def offer_event(self, event: bytes) -> None:
        """Queue an encoded event."""
        self._outbox.put_notice(event)

    def send(self, response: bytes) -> None:
        """Hand an encoded response to the socket, past the queue."""
        if not self._writer.is_closing():
            self._writer.write(response)

    async def flush(self) -> None:
        """Return once few bytes are unsent; a client that is stuck is dropped.

        Raises:
            ConnectionError: the client has left.
        """
        try:
            async with asyncio.timeout(self._bounds.stuck):
                await self._writer.drain()
        except TimeoutError:
            log.warning("Dropped %s: it has not read for %g s.", self.client, self._bounds.stuck)
            self.drop()

    async def pump(self) -> None:
        """Send what is queued, until the client leaves."""
        with suppress(ConnectionError):
            while not self._writer.is_closing():
                await self._outbox.filled.wait()
                await self._send_queued()

    async def _send_queued(self) -> None:
        while (chunk := self._outbox.take()) is not None:
            self.send(chunk)
            await self.flush()

    def drop(self) -> None:
        """Close the connection without regard for unsent bytes."""
        self._writer.transport.abort()

    async def close(self) -> None:
        """Run what `on_close` gathered, then say good-bye for a bounded time."""
        self.closed = True
        try:
            self._left_behind.close()
        except Exception:
            log.exception("Could not clean up after %s.", self.client)
        self._writer.close()
        try:
            async with asyncio.timeout(self._bounds.farewell):
                await self._writer.wait_closed()
        except (TimeoutError, OSError):
            self.drop()


def _peer(writer: asyncio.StreamWriter) -> Peer:
    layout = struct.Struct("3i")
    raw = _socket(writer).getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, layout.size)
    return Peer(*layout.unpack(raw))


def _socket(writer: asyncio.StreamWriter) -> socket.socket:
    found: socket.socket = writer.get_extra_info("socket")
    return found
