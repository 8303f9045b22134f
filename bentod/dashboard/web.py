"""The page's server: files, and one WebSocket a browser."""

import asyncio
import logging
import socket as sockets
import ssl
from collections.abc import AsyncIterator, Awaitable, Callable, Mapping
from contextlib import asynccontextmanager, suppress

from aiohttp import WSMsgType, web

from bentod.dashboard.assets import Asset
from bentod.dashboard.doorkeeper import HEADERS, Doorkeeper, Tokens
from bentod.dashboard.messages import LONGEST, Token, parse
from bentod.dashboard.site import Site
from bentod.dashboard.visitor import Visitor
from bentod.errors import BadRequest

_log = logging.getLogger(__name__)

BROWSERS = 64
"""At once, as clients of the daemon."""

PATIENCE = 5.0
"""s until a browser must have said who it is."""

HEARTBEAT = 20.0
"""s between pings; a browser that answers none within half of that is gone. Motion has ended long before."""

TOO_MUCH = 1 << 20
"""Bytes that may wait for a browser; one for which more do is gone."""

_UNWANTED, _UNKNOWN, _CROWDED = 4400, 4401, 4429  # codes of our own for closing (RFC 6455, 7.4.2)

Handler = Callable[[web.Request], Awaitable[web.StreamResponse]]


class Server:
    """Lets browsers in."""

    def __init__(self, site: Site, assets: Mapping[str, Asset], tokens: Tokens, door: Doorkeeper) -> None:
        self._site = site
        self._assets = assets
        self._tokens = tokens
        self._door = door
        self._sockets: set[web.WebSocketResponse] = set()
        self._knocking: dict[web.WebSocketResponse, None] = {}  # who has shown no token yet, in order
        self._guests = 0

    @asynccontextmanager
    async def serving(self, listener: sockets.socket, tls: ssl.SSLContext | None) -> AsyncIterator[None]:
        """Serve who comes to `listener` while entered."""
        runner = web.AppRunner(self._application(), access_log=None, shutdown_timeout=1.0)
        await runner.setup()
        try:
            await web.SockSite(runner, listener, ssl_context=tls).start()
            yield
        finally:
            for socket in list(self._sockets):
                with suppress(OSError, RuntimeError):
                    await socket.close(code=1001)
            await runner.cleanup()

    def _application(self) -> web.Application:
        application = web.Application(middlewares=[self._guard], client_max_size=0)
        application.router.add_get("/ws", self._socket)
        application.router.add_get("/{path:.*}", self._file)
        return application

    @web.middleware
    async def _guard(self, request: web.Request, handler: Handler) -> web.StreamResponse:
        """Ask who is meant before anything else, and tell the browser what the page may do."""
        if not self._door.knows(request.host):
            raise web.HTTPMisdirectedRequest(text="This server has another name.", headers=HEADERS)
        try:
            answer = await handler(request)
        except web.HTTPException as refusal:
            refusal.headers.update(HEADERS)
            raise
        if not answer.prepared:
            answer.headers.update(HEADERS)
        return answer

    async def _file(self, request: web.Request) -> web.StreamResponse:
        asset = self._assets.get(request.path)
        if asset is None:
            raise web.HTTPNotFound(text="There is no such page.")
        headers = {"ETag": asset.tag, "Cache-Control": "no-cache", "Vary": "Accept-Encoding"}
        if request.headers.get("If-None-Match") == asset.tag:
            return web.Response(status=304, headers=headers)
        zips = "gzip" in request.headers.get("Accept-Encoding", "")
        headers |= {"Content-Type": asset.kind} | ({"Content-Encoding": "gzip"} if zips else {})
        return web.Response(body=asset.zipped if zips else asset.body, headers=headers)

    async def _socket(self, request: web.Request) -> web.StreamResponse:
        origin = request.headers.get("Origin", "")
        if not self._door.is_own(origin, request.host):
            _log.warning("a page from %.100r was refused", origin or "nowhere")
            raise web.HTTPForbidden(text="Pages of others may not speak to the arm.")
        socket = web.WebSocketResponse(heartbeat=HEARTBEAT, max_msg_size=LONGEST, compress=False)
        await socket.prepare(request)
        self._sockets.add(socket)
        try:
            await self._serve(request, socket)
        finally:
            self._sockets.discard(socket)
        return socket

    async def _serve(self, request: web.Request, socket: web.WebSocketResponse) -> None:
        self._knocking[socket] = None
        if len(self._knocking) > BROWSERS:
            await next(iter(self._knocking)).close(code=_UNKNOWN, message=b"too many others knock")
        try:
            role = await self._role(socket)
        finally:
            self._knocking.pop(socket, None)
        if role and self._guests >= BROWSERS:
            await socket.close(code=_CROWDED, message=b"too many browsers")
        elif not role:
            _log.warning("a browser without a valid token was refused")
            await socket.close(code=_UNKNOWN, message=b"the token is not valid")
        else:
            await self._host(request, socket, role)

    async def _role(self, socket: web.WebSocketResponse) -> str:
        """What the browser's token makes it; empty when it shows none."""
        try:
            message = await socket.receive(timeout=PATIENCE)
            shown = parse(message.data) if message.type is WSMsgType.BINARY else None
        except (TimeoutError, BadRequest):
            return ""
        return self._tokens.role(shown.token) if isinstance(shown, Token) else ""

    async def _host(self, request: web.Request, socket: web.WebSocketResponse, role: str) -> None:
        async with asyncio.TaskGroup() as tasks:
            visitor = self._site.visitor(role, _writer(request), tasks)
            self._site.enter(visitor)
            self._guests += 1
            try:
                await _listen(socket, visitor)
            finally:
                self._guests -= 1
                self._site.leave(visitor)
                await asyncio.shield(visitor.leave())


async def _listen(socket: web.WebSocketResponse, visitor: Visitor) -> None:
    async for message in socket:
        try:
            if message.type is not WSMsgType.BINARY:
                raise BadRequest("The browser sent text.")
            visitor.take(parse(message.data))
        except BadRequest as error:
            _log.warning("a browser was let go: %s", error)
            await socket.close(code=_UNWANTED, message=str(error).encode()[:120])


def _writer(request: web.Request) -> Callable[[bytes], None]:
    """Passes WebSocket frames to the browser, past what waits for one browser at a time."""
    transport = request.transport
    if not isinstance(transport, asyncio.Transport):
        raise web.HTTPBadRequest(text="The connection is gone.")

    def write(frame: bytes) -> None:
        if transport.is_closing():
            return
        if transport.get_write_buffer_size() > TOO_MUCH:
            transport.abort()
        else:
            transport.write(frame)

    return write
