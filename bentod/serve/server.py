"""The Unix socket: one task a client, requests answered side by side, frames encoded once for all."""

import asyncio
import itertools
import logging
from collections.abc import Mapping
from contextlib import AsyncExitStack
from pathlib import Path
from types import TracebackType
from typing import Self

from bentod.errors import BentodError, Refused
from bentod.frames import Event, Frame
from bentod.messages import BadFraming, Decoder, Limits, encode_notification, error_object
from bentod.serve.requests import Requests
from bentod.serve.session import Bounds, Session
from bentod.serve.socket_file import claimed
from bentod.serve.spec import Method

log = logging.getLogger(__name__)

CHUNK = 16 * 1024
"""Bytes read from a client at once."""

BURST = 32
"""Messages of one client that are handled before the loop turns to others."""


class Server:
    """Serves `methods` at `path` for as long as it is entered."""

    def __init__(
        self,
        methods: Mapping[str, Method],
        path: Path,
        bounds: Bounds | None = None,
        limits: Limits | None = None,
    ) -> None:
        self.path = path
        self._methods = methods
        self._bounds = bounds or Bounds()
        self._limits = limits or Limits()
        self._stack = AsyncExitStack()
        self._sessions: dict[asyncio.Task[None], Session] = {}
        self._ids = itertools.count(1)
        self._group = asyncio.TaskGroup()
        self._open = False

    @property
    def sessions(self) -> tuple[Session, ...]:
        """Clients that are connected now, oldest first."""
        return tuple(self._sessions.values())

    async def __aenter__(self) -> Self:
        """Start to listen.

        Raises:
            ConfigError: there can be no socket at this path.
            Refused: a daemon already serves this path.
        """
        async with AsyncExitStack() as stack:
            listener = stack.enter_context(claimed(self.path))
            await self._group.__aenter__()
            # Not entered as a context: the group would wrap what the body of `async with Server` raises.
            stack.push_async_callback(self._group.__aexit__, None, None, None)
            self._open = True
            server = await asyncio.start_unix_server(self._welcome, sock=listener, backlog=16, limit=CHUNK)
            stack.callback(self._dismiss_all)
            stack.callback(server.close)
            self._stack = stack.pop_all()
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Stop to listen, let every client go, remove the socket."""
        await self._stack.aclose()

    def publish_state(self, frame: Frame) -> None:
        """Send `frame` to all subscribers for whom one is due. Never waits."""
        due = [session for session in self._sessions.values() if session.wants_state(frame.time)]
        if due:
            encoded = encode_notification("state", [frame])
            for session in due:
                session.offer_state(encoded)

    def publish_event(self, event: Event) -> None:
        """Send `event` to all subscribers. Never waits."""
        listening = [session for session in self._sessions.values() if session.wants_events]
        if listening:
            encoded = encode_notification("event", [event])
            for session in listening:
                session.offer_event(encoded)

    def _dismiss_all(self) -> None:
        self._open = False
        for task in self._sessions:
            task.cancel()

    def _welcome(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        if not self._open:  # accepted by the loop just before the listener was closed
            writer.transport.abort()
            return
        session = Session(next(self._ids), writer, self._bounds)
        if len(self._sessions) >= self._bounds.clients:
            log.warning("Sent %s away: %d clients are connected.", session.client, len(self._sessions))
            session.send(_complaint(Refused(f"{len(self._sessions)} clients are connected; no more fit.")))
            writer.close()
            return
        task = self._group.create_task(self._attend(session, reader), name=f"client {session.id}")
        self._sessions[task] = session
        task.add_done_callback(self._forget)

    def _forget(self, task: asyncio.Task[None]) -> None:
        # A task that is cancelled before its first step closes nothing itself.
        self._sessions.pop(task).drop()

    async def _attend(self, session: Session, reader: asyncio.StreamReader) -> None:
        try:
            async with asyncio.TaskGroup() as group:
                pump = group.create_task(session.pump())
                try:
                    await self._converse(session, reader, group)
                finally:
                    pump.cancel()
        except Exception:
            log.exception("The connection of %s broke down.", session.client)
        finally:
            await session.close()

    async def _converse(
        self, session: Session, reader: asyncio.StreamReader, group: asyncio.TaskGroup
    ) -> None:
        """Read until the client leaves, then let its last requests finish: one of them may be `stop`."""
        requests = Requests(self._methods, session, group, self._bounds.in_flight)
        decoder = Decoder(self._limits)
        try:
            while data := await reader.read(CHUNK):
                decoder.feed(data)
                await _take_all(decoder, requests, session)
        except BadFraming as error:
            session.send(_complaint(error))
        except ConnectionError:
            log.debug("Lost %s.", session.client)
        await requests.finish(self._bounds.farewell)


async def _take_all(decoder: Decoder, requests: Requests, session: Session) -> None:
    for number, message in enumerate(decoder, 1):
        requests.take(message)
        if number % BURST == 0:
            await _breathe(session)
    await _breathe(session)


async def _breathe(session: Session) -> None:
    await asyncio.sleep(0)  # neither a full buffer nor an idle client would make the next lines wait
    await session.flush()


def _complaint(error: BentodError) -> bytes:
    """An error that answers no request: a notification, because there is no id to answer to."""
    return encode_notification("error", [error_object(error)])
