"""One client: who it is, what it holds until it leaves, and what is sent to it without waiting for it."""

import asyncio
import logging
from collections.abc import Callable, Sequence
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from typing import Literal, TypeAlias

from bentod.bucket import Hush
from bentod.frames import Value
from bentod.messages import encode_notification
from bentod.serve.line import closed, hold_little
from bentod.serve.outbox import Outbox
from bentod.serve.peers import Peer

log = logging.getLogger(__name__)

OVERFULL = 4
"""Times the bytes that may wait for a client."""

Topic: TypeAlias = Literal["state", "events", "emg"]


@dataclass(frozen=True, slots=True)
class Bounds:
    """How much of the daemon one client may take."""

    clients: int = 64
    reserved: int = 8  # of these, for operators only: nobody who may merely look can keep them out
    per_user: int = 32  # connections of one user or address
    in_flight: int = 32  # requests of one client that are being handled
    requests_per_s: float = 2000.0  # of one user; beyond, each waits for its turn
    unfinished: float = 5.0  # s from the first to the last byte of a message
    notices: int = 256  # events that wait for one client
    unsent: int = 32 * 1024  # bytes that wait for a client to read, before it counts as stuck
    stuck: float = 5.0  # s that a client may be stuck
    last_resort: float = 5.0  # s for a client without a place to stop the arm
    farewell: float = 1.0  # s for the last requests and bytes of a client that leaves


class Session:
    """What handlers know of their client. Only the server makes one."""

    def __init__(
        self,
        id_: int,
        peer: Peer,
        writer: asyncio.StreamWriter,
        bounds: Bounds,
        hush: Hush | None = None,
        last_resort: str = "",
    ) -> None:
        self.id = id_
        self.peer = peer
        self.client = peer.name
        """Name of the client in logs, events and frames; a client may give a better one."""
        self.last_resort = last_resort
        """Why there is no room for it, so that it may only stop the arm; empty: a client like any other."""
        self.closed = False
        self.wants_events = False
        self.wants_emg = False
        self._bounds = bounds
        self._hush = hush or Hush(0.0, asyncio.get_running_loop().time)
        self._outbox = Outbox(bounds.notices)
        self._left_behind = ExitStack()
        self._keys: set[str] = set()
        self._writer = writer
        hold_little(writer, bounds.unsent)

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
        """Send "state" at most `rate_hz` times a second (above 0), every event, or every block of EMG."""
        if topic == "state":
            self._outbox.state.start(rate_hz)
        else:
            self.wants_events |= topic == "events"
            self.wants_emg |= topic == "emg"

    def unsubscribe(self, topic: Topic) -> None:
        """Send no more of `topic`."""
        if topic == "state":
            self._outbox.state.stop()
        else:
            self.wants_events &= topic != "events"
            self.wants_emg &= topic != "emg"

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

    def offer(self, notice: bytes) -> None:
        """Queue an encoded event or block of EMG."""
        self._outbox.put_notice(notice)

    def send(self, response: bytes) -> None:
        """Hand an encoded response to the socket, past the queue."""
        if not self._writer.is_closing():
            self._writer.write(response)
            if self.is_full:
                self._outbox.filled.set()  # and so the pump watches it

    @property
    def is_full(self) -> bool:
        """Whether too many bytes wait for the client to read them."""
        return self._unsent > self._bounds.unsent

    @property
    def is_overfull(self) -> bool:
        """Whether so many wait that not even refusals are added."""
        return self._unsent > OVERFULL * self._bounds.unsent

    @property
    def _unsent(self) -> int:
        return self._writer.transport.get_write_buffer_size()

    async def flush(self) -> None:
        """Return once few bytes are unsent; a client that is stuck is dropped.

        Raises:
            ConnectionError: the client has left.
        """
        try:
            async with asyncio.timeout(self._bounds.stuck):
                await self._writer.drain()
        except TimeoutError:
            if (more := self._hush.take("dropped", self.peer.user)) is not None:
                lost = self._lost()
                log.warning("Dropped %s: it has not read for %g s%s%s.", self, self._bounds.stuck, lost, more)
            self.drop()

    async def pump(self) -> None:
        """Send what is queued, until the client leaves."""
        with suppress(ConnectionError):
            while not self._writer.is_closing():
                await self._outbox.filled.wait()
                await self.flush()
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
            if (more := self._hush.take("clean up")) is not None:
                log.exception("Could not clean up after %s%s.", self.client, more)
        await closed(self._writer, self._bounds.farewell)

    def describe(self) -> dict[str, Value]:
        """Plain data for `list_clients`."""
        return {
            "session": self.id,
            "name": self.client,
            "user": self.peer.user,
            "role": self.peer.role,
            "replaced_frames": self.replaced_frames,
            "dropped_events": self.dropped_events,
        }

    def __str__(self) -> str:
        return f"{self.client} ({self.peer.user}, {self.peer.role})"

    def _lost(self) -> str:
        """The end of a sentence: what it has missed so far."""
        return f", and has missed {self.replaced_frames} frames and {self.dropped_events} events"
