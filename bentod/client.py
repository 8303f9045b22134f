"""The asyncio client of the daemon."""

import asyncio
import itertools
import ssl
from collections import deque
from collections.abc import AsyncGenerator, AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Self

from bentod.address import Address, parse
from bentod.endpoint import (
    BACKLOG,
    GENEROUS,
    Disconnected,
    RpcError,
    complaint,
    connecting,
    default_socket_path,
    either,
    result_of,
)
from bentod.errors import BentodError
from bentod.frames import Value
from bentod.framing import BadFraming
from bentod.messages import (
    GREATEST_ID,
    Decoder,
    Message,
    Notification,
    Response,
    encode_notification,
    encode_request,
)

PATIENCE = 5.0
"""s that a connection over TCP may take to come about."""

FAREWELL = 1.0
"""s that unsent bytes get when a client closes."""


class Client:
    """`async with Client.connect(path) as arm: await arm.call("pause", joints="elbow_flexion", on=True)`."""

    def __init__(self, wire: "_Wire") -> None:
        self._wire = wire

    @classmethod
    @asynccontextmanager
    async def connect(
        cls, address: Path | str | None = None, token: str | None = None, cafile: Path | str | None = None
    ) -> AsyncIterator[Self]:
        """A connection to the daemon at `address`, or at the default one.

        An address is a path, "tls://host:port", or "tcp://host:port" on this machine. The last two need a
        `token`, which is read from the file that BENTOD_TOKEN_FILE names when it is not given; `cafile`
        holds the authority of the server's certificate, if the system does not know it.

        Raises:
            Disconnected: nobody listens there, or it cannot prove who it is.
            BadRequest, ConfigError: the address, the token's file or `cafile` is no good.
            RpcError: the token is wrong.
        """
        where = parse(address or default_socket_path())
        wire = await _connected(where, where.tls_context(cafile))
        try:
            if not where.path:
                nonce = await wire.call("challenge", [])
                await wire.call("authenticate", where.answer(nonce, token))
            yield cls(wire)
        finally:
            await wire.leave()

    async def call(self, method: str, /, *params: Value, **named: Value) -> Value:
        """Ask and wait for the answer; parameters by position or by name, not both.

        Raises:
            RpcError: the daemon refused.
            Disconnected: the connection is or gets lost.
        """
        return await self._wire.call(method, either(params, named))

    @asynccontextmanager
    async def listen(
        self, topic: str, rate_hz: float = 30.0
    ) -> AsyncIterator[AsyncIterator[dict[str, Value]]]:
        """Subscribed to "state", "events" or "emg" while entered; the last rate asked for holds."""
        feed = _Feed("event" if topic == "events" else topic, most=1 if topic == "state" else BACKLOG)
        self._wire.feeds.append(feed)
        try:
            await self.call("subscribe", topic=topic, rate_hz=rate_hz)
            yield feed
        finally:
            self._wire.feeds.remove(feed)
            if not any(other.name == feed.name for other in self._wire.feeds):
                self._wire.tell("unsubscribe", [topic])

    async def subscribe_state(self, rate_hz: float = 30.0) -> AsyncGenerator[dict[str, Value], None]:
        """Frames, always the newest; those that came while the caller was busy are skipped.

        Raises:
            Disconnected: the connection is or gets lost.
        """
        async with self.listen("state", rate_hz) as frames:
            async for frame in frames:
                yield frame

    async def subscribe_events(self) -> AsyncGenerator[dict[str, Value], None]:
        """Events from the first `anext` on; to hear what a call causes, enter `listen("events")` before it.

        Raises:
            Disconnected: the connection is or gets lost.
        """
        async with self.listen("events") as events:
            async for event in events:
                yield event


async def _connected(where: Address, tls: ssl.SSLContext | None) -> "_Wire":
    loop = asyncio.get_running_loop()
    with connecting(where):
        if where.path:
            _, wire = await loop.create_unix_connection(_Wire, where.path)
            return wire
        async with asyncio.timeout(PATIENCE):
            _, wire = await loop.create_connection(_Wire, where.host, where.port, ssl=tls)
            return wire


class _Feed:
    """Notifications of one name, for one reader."""

    def __init__(self, name: str, most: int) -> None:
        self.name = name
        self._waiting: deque[dict[str, Value]] = deque(maxlen=most)
        self._changed = asyncio.Event()
        self._end: BentodError | None = None

    def put(self, params: Value) -> None:
        """Take a notification's only parameter."""
        match params:
            case [dict() as entry]:
                self._waiting.append(entry)
                self._changed.set()

    def finish(self, error: BentodError) -> None:
        """Raise `error` once all is read."""
        self._end = error
        self._changed.set()

    def __aiter__(self) -> Self:
        return self

    async def __anext__(self) -> dict[str, Value]:
        while not self._waiting:
            if self._end:
                raise self._end
            self._changed.clear()
            await self._changed.wait()
        return self._waiting.popleft()


class _Wire(asyncio.Protocol):
    """Matches responses to calls. Needs no task: the loop calls it when bytes arrive."""

    def __init__(self) -> None:
        self.feeds: list[_Feed] = []
        self.closed: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._decoder = Decoder(GENEROUS)
        self._ids = itertools.count()
        self._calls: dict[int, asyncio.Future[Value]] = {}
        self._transport: asyncio.Transport | None = None
        self._end: BentodError = Disconnected("The connection to the daemon is closed.")

    async def call(self, method: str, params: Value) -> Value:
        transport = self._open_transport()
        id_ = next(self._ids) & GREATEST_ID
        answer = self._calls[id_] = asyncio.get_running_loop().create_future()
        transport.write(encode_request(id_, method, params))
        try:
            result: Value = await answer
        finally:
            self._calls.pop(id_, None)
        return result

    def tell(self, method: str, params: list[Value]) -> None:
        if self._transport:
            self._transport.write(encode_notification(method, params))

    def close(self) -> None:
        if self._transport:
            self._transport.close()

    async def leave(self) -> None:
        self.close()
        await asyncio.wait([self.closed], timeout=FAREWELL)
        if self._transport:
            self._transport.abort()
            await self.closed

    def _open_transport(self) -> asyncio.Transport:
        if self._transport is None or self._transport.is_closing():
            raise self._end
        return self._transport

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        if not isinstance(transport, asyncio.Transport):
            raise TypeError("A stream is needed.")
        self._transport = transport

    def data_received(self, data: bytes) -> None:
        self._decoder.feed(data)
        try:
            for message in self._decoder:
                self._take(message)
        except BadFraming as error:
            self._end = error
            self.close()

    def connection_lost(self, exc: Exception | None) -> None:
        self._transport = None
        for answer in self._calls.values():
            if not answer.done():
                answer.set_exception(self._end)
        for feed in self.feeds:
            feed.finish(self._end)
        self.closed.set_result(None)

    def _take(self, message: Message) -> None:
        if isinstance(message, Response):
            self._settle(message)
        elif isinstance(message, Notification) and message.method == "error":
            self._end = complaint(message)
        elif isinstance(message, Notification):
            for feed in self.feeds:
                if feed.name == message.method:
                    feed.put(message.params)

    def _settle(self, response: Response) -> None:
        answer = self._calls.pop(response.id, None)
        if answer is None or answer.done():  # the caller gave up
            return
        try:
            answer.set_result(result_of(response))
        except RpcError as error:
            answer.set_exception(error)
