"""The sockets: one task a client, requests answered side by side, frames encoded once for all."""

import asyncio
import itertools
import logging
import socket
from collections.abc import Mapping
from contextlib import AsyncExitStack
from dataclasses import replace
from functools import partial
from pathlib import Path
from types import TracebackType
from typing import Self

from bentod.config_tables import Access, Tcp
from bentod.errors import Refused
from bentod.frames import EmgBlock, Event, Frame
from bentod.framing import BadFraming, Limits
from bentod.gate import Gate
from bentod.messages import Decoder, encode_notification
from bentod.serve.acceptor import Acceptor
from bentod.serve.accounts import Shared
from bentod.serve.ear import Ear
from bentod.serve.line import Door, Line, SentAway, complaint, send_away
from bentod.serve.peers import Peer, Role
from bentod.serve.requests import Requests
from bentod.serve.session import Bounds, Session
from bentod.serve.socket_file import adopted, claimed
from bentod.serve.spec import Method
from bentod.serve.tcp_door import TcpDoor
from bentod.serve.tcp_listener import listening
from bentod.serve.unix_door import UnixDoor

log = logging.getLogger(__name__)

BACKLOG = 16
"""Connections that the kernel keeps while the loop is busy."""

KNOCKING = 32
"""Connections beyond the number of clients that may be on their way in or out."""


class Server:
    """Serves `methods` at `path`, and over TCP if that is wanted, for as long as it is entered."""

    def __init__(
        self,
        methods: Mapping[str, Method],
        path: Path,
        bounds: Bounds | None = None,
        limits: Limits | None = None,
        passed: socket.socket | None = None,
        unix: UnixDoor | None = None,
        tcp: Tcp | None = None,
        gate: Gate | None = None,
    ) -> None:
        self.path = path
        self.addresses: tuple[tuple[str, int], ...] = ()
        """Where it listens on TCP."""
        self._passed = passed
        self._unix = unix or UnixDoor(Access())
        self._tcp = tcp
        self._methods = methods
        self._bounds = bounds or Bounds()
        self._limits = limits or Limits()
        self._gate = gate or Gate()
        self._stack = AsyncExitStack()
        self._hosts: dict[asyncio.Task[None], None] = {}  # oldest first
        self._sessions: dict[asyncio.Task[None], Session] = {}
        self._ids = itertools.count(1)
        self._group = asyncio.TaskGroup()

    @property
    def sessions(self) -> tuple[Session, ...]:
        """Clients that are connected now, oldest first."""
        return tuple(session for session in self._sessions.values() if not session.last_resort)

    async def __aenter__(self) -> Self:
        """Start to listen.

        Raises:
            ConfigError: there can be no socket at this path.
            Refused: a daemon already serves this path.
        """
        async with AsyncExitStack() as stack:
            listener = stack.enter_context(adopted(self._passed) if self._passed else claimed(self.path))
            listener.listen(BACKLOG)
            ways: list[tuple[socket.socket, Door]] = [(listener, self._unix)]
            if self._tcp:
                door = TcpDoor(self._tcp)
                ways += [(each, door) for each in stack.enter_context(listening(self._tcp))]
            now = asyncio.get_running_loop().time
            self._shared = Shared(self._gate, self._bounds.requests_per_s, now)
            await self._group.__aenter__()
            # Not entered as a context: the group would wrap what the body of `async with Server` raises.
            stack.push_async_callback(self._group.__aexit__, None, None, None)
            stack.callback(self._dismiss_all)
            for way, door_of_it in ways:
                acceptor = Acceptor(way, partial(self._welcome, door_of_it), self._gate, door_of_it.pace)
                stack.callback(acceptor.stop)
                acceptor.start()
            self.addresses = tuple(way.getsockname()[:2] for way, _ in ways[1:])
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
        listeners = [session for session in self._sessions.values() if session.wants_events]
        if listeners:
            encoded = encode_notification("event", [event])
            for session in listeners:
                session.offer(encoded)

    def publish_emg(self, block: EmgBlock) -> None:
        """Send `block` to all subscribers. Never waits."""
        listening = [session for session in self._sessions.values() if session.wants_emg]
        if listening:
            encoded = encode_notification("emg", [replace(block, samples=block.samples.tolist())])
            for session in listening:
                session.offer(encoded)

    def _dismiss_all(self) -> None:
        for task in self._hosts:
            task.cancel()

    def _welcome(self, door: Door, connection: socket.socket) -> None:
        if len(self._hosts) >= self._bounds.clients + KNOCKING:
            self._make_way()
        task = self._group.create_task(self._host(door, connection), name="client")
        self._hosts[task] = None
        task.add_done_callback(partial(self._forget, connection))

    def _make_way(self) -> None:
        """Let go of whoever has been on the way in or out for longest: the next may want to stop the arm."""
        for task in self._hosts:
            if task not in self._sessions or self._sessions[task].last_resort:
                del self._hosts[task]
                task.cancel()
                return

    def _forget(self, connection: socket.socket, task: asyncio.Task[None]) -> None:
        self._hosts.pop(task, None)
        session = self._sessions.pop(task, None)
        if session:
            session.drop()
        else:  # a task that is cancelled before its first step closes nothing itself
            connection.close()

    async def _host(self, door: Door, connection: socket.socket) -> None:
        """From the first byte of a connection to its last."""
        try:
            line, peer = await door.admit(connection)
            await self._serve(line, peer)
        except SentAway as reason:
            if (more := self._shared.hush.take("sent away", reason.who)) is not None:
                log.warning("Sent away %s%s", reason, more)
        except OSError as error:
            log.debug("Lost a connection that was coming in: %s.", error)
        except Exception:
            if (more := self._shared.hush.take("not taken")) is not None:
                log.exception("A connection could not be taken%s.", more)

    async def _serve(self, line: Line, peer: Peer) -> None:
        """Serve a client, as far as there is room for it. Raises SentAway: there is not."""
        refusal = self._why_full(peer)
        if not refusal:
            await self._attend(self._seated(line, peer), line)
            return
        account = self._shared.account(peer.user)
        if account.last_resort:
            await send_away(line, peer.user, f"{peer.name} ({peer.user})", Refused(refusal))
        account.last_resort = True
        try:
            await self._attend(self._seated(line, peer, refusal), line)
        finally:
            account.last_resort = False
        raise SentAway(peer.user, f"{peer.name} ({peer.user}): {refusal}")

    def _seated(self, line: Line, peer: Peer, refusal: str = "") -> Session:
        task = asyncio.current_task()
        session = Session(next(self._ids), peer, line.writer, self._bounds, self._shared.hush, refusal)
        if task:
            self._sessions[task] = session
        log.debug("%s is connected.", session)
        return session

    def _why_full(self, peer: Peer) -> str:
        """Why there is no room for one more of the same; empty if there is."""
        bounds = self._bounds
        of_user = sum(session.peer.user == peer.user for session in self.sessions)
        if of_user >= bounds.per_user and not peer.master:
            return f"{peer.user} has {of_user} connections; no more fit (access.connections_per_user)."
        room = bounds.clients - (0 if peer.role is Role.OPERATOR else bounds.reserved)
        if len(self.sessions) >= room:
            return f"{len(self.sessions)} clients are connected; no more fit."
        return ""

    async def _attend(self, session: Session, line: Line) -> None:
        try:
            async with asyncio.TaskGroup() as group:
                pump = group.create_task(session.pump())
                try:
                    await self._converse(session, line, group)
                finally:
                    pump.cancel()
        except Exception:
            if (more := self._shared.hush.take("broke down")) is not None:
                log.exception("The connection of %s broke down%s.", session.client, more)
        finally:
            await session.close()

    async def _converse(self, session: Session, line: Line, group: asyncio.TaskGroup) -> None:
        """Read until the client leaves, then let its last requests finish: one of them may be `stop`."""
        requests = Requests(self._methods, session, group, self._bounds, self._shared)
        ear = Ear(line, Decoder(self._limits), self._bounds.unfinished, self._gate)
        try:
            async with asyncio.timeout(self._bounds.last_resort if session.last_resort else None):
                await _listen(session, ear, requests)
        except TimeoutError:
            session.send(complaint(Refused(session.last_resort)))
        except BadFraming as error:
            session.send(complaint(error))
        except ConnectionError:
            log.debug("Lost %s.", session.client)
        await requests.finish(self._bounds.farewell)


async def _listen(session: Session, ear: Ear, requests: Requests) -> None:
    """Until the client leaves, or has stopped the arm and may do nothing else. Raises as `Ear` does."""
    while await ear.hear():
        await ear.pass_on(requests)
        if session.last_resort and requests.stopped:
            return
