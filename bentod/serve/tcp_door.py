"""Who comes in over TCP: whoever has a token, said first of all, in time, and not after many wrong ones."""

import asyncio
import hashlib
import hmac
import logging
import secrets
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import cast

from bentod.bucket import Bucket
from bentod.config_tables import Tcp
from bentod.errors import BadRequest, ConfigError, Refused
from bentod.frames import Value
from bentod.framing import BadFraming, Limits
from bentod.hosts import network
from bentod.messages import Decoder, Message, Request, encode_error, encode_result
from bentod.serve.attempts import Attempts
from bentod.serve.line import HANDSHAKE, Line, opened, send_away
from bentod.serve.peers import Peer, Role
from bentod.serve.tcp_listener import handshakes_per_s, kept_alive, server_tls
from bentod.token_file import LONGEST, proof, read_token

log = logging.getLogger(__name__)

STRANGERS = Limits(size=2 * LONGEST, items=16, depth=4)
"""What a client may say before anybody knows who it is."""

WAITING = 16
"""Connections that have not said yet who they are, in all ..."""

WAITING_EACH = 4
"""... and from one address. Beyond, whoever has waited for longest makes way."""

HOW = "Over TCP first prove within 5 s that you know the token: challenge(), then authenticate(proof)."

CLEAR = "Without TLS no token is to be sent, not even the right one: " + HOW[0].lower() + HOW[1:]

NONCE = 32
"""Bytes; as long as the proof."""

_TOKENS = (("operator_token", Role.OPERATOR), ("observer_token", Role.OBSERVER))


@dataclass(frozen=True, slots=True)
class Knock:
    """Where a connection comes from."""

    address: str  # whom it is counted for
    name: str  # with its port


class Talk:
    """The first words of a client: perhaps a request for a challenge, then who it is."""

    def __init__(self, line: Line) -> None:
        self.line = line
        self._decoder = Decoder(STRANGERS)

    @property
    def rest(self) -> bytes:
        """What came after them."""
        return self._decoder.rest

    async def greeting(self) -> tuple[Request | None, str]:
        """The first request but for a challenge, and the nonce of that; None: it was no request.

        Raises:
            BadFraming: it was no message.
            ConnectionError: the client has left.
        """
        message, nonce = await self._next(), ""
        if isinstance(message, Request) and message.method == "challenge":
            nonce = secrets.token_hex(NONCE)
            self.line.writer.write(encode_result(message.id, {"nonce": nonce}))
            message = await self._next()
        return message if isinstance(message, Request) else None, nonce

    async def _next(self) -> Message:
        while (message := next(self._decoder, None)) is None:
            data = await self.line.reader.read(STRANGERS.size)
            if not data:
                raise ConnectionResetError("it left without a word")
            self._decoder.feed(data)
        return message


class TcpDoor:
    """Reads certificate and tokens when it is made. Keeps of the tokens only what proofs are made with."""

    def __init__(self, tcp: Tcp) -> None:
        """Within a running loop.

        Raises:
            ConfigError: certificate, key or a token cannot be used.
        """
        now = asyncio.get_running_loop().time
        self._tls = server_tls(tcp)
        self._keys = _keys(tcp)
        self._attempts = Attempts(now)
        self._waiting: list[tuple[str, asyncio.Task[None]]] = []  # longest first
        rate = handshakes_per_s(tcp)
        self.pace = Bucket(rate, min(rate, WAITING / 2), now)

    async def admit(self, connection: socket.socket) -> tuple[Line, Peer]:
        """The line to a client that has a token. Raises as any door does."""
        host, port = connection.getpeername()[:2]
        knock = Knock(network(host), f"{host}:{port}")
        deadline = asyncio.get_running_loop().time() + HANDSHAKE
        with self._place(knock.address):
            kept_alive(connection)
            line = await opened(connection, self._tls)
            talk = Talk(line)
            try:
                async with asyncio.timeout_at(deadline):
                    request, nonce = await talk.greeting()
                return await self._answer(talk, request, nonce, knock)
            except (TimeoutError, BadFraming) as error:
                reason = error if isinstance(error, BadFraming) else Refused(HOW)
                await send_away(line, knock.address, knock.name, reason)
            except BaseException:
                line.writer.transport.abort()
                raise

    async def _answer(
        self, talk: Talk, request: Request | None, nonce: str, knock: Knock
    ) -> tuple[Line, Peer]:
        line = talk.line
        if request is None:
            await send_away(line, knock.address, knock.name, Refused(HOW))
        try:
            role = await self._judge(request, nonce, knock.address)
        except (BadRequest, Refused) as error:
            await send_away(line, knock.address, knock.name, error, encode_error(request.id, error))
        line.writer.write(encode_result(request.id, {"role": role}))
        log.debug("%s has the %s's token.", knock.name, role)
        remedy = f"Your token is the {role}'s. The operator's is in the daemon's tcp.operator_token."
        peer = Peer(knock.name, knock.address, role, remedy)
        return Line(line.reader, line.writer, talk.rest), peer

    async def _judge(self, request: Request, nonce: str, address: str) -> Role:
        """The role of whoever sent `request`. Raises Refused or BadRequest, without a word of the token."""
        if request.method != "authenticate":
            raise Refused(HOW)
        given = self._proof(request.params, nonce)
        right = [role for role, key in self._keys if hmac.compare_digest(given, _proof_with(key, nonce))]
        if not right:
            # Its place at the door is taken meanwhile, even if it does not wait for the answer.
            await asyncio.sleep(self._attempts.failed(address))
            raise Refused("The token is wrong.", "token")
        self._attempts.succeeded(address)
        return right[0]

    def _proof(self, params: Value, nonce: str) -> bytes:
        """The proof in `params`, or that of the token in them."""
        match params:
            case {"proof": str(given), **rest} | [{"proof": str(given), **rest}] if nonce and not rest:
                return given.encode()
            case [str(token)] | {"token": str(token)} | [{"token": str(token)}]:
                if self._tls is None:
                    raise Refused(CLEAR, "token")
                return proof(token, nonce).encode()
        raise BadRequest(
            "authenticate takes proof, a text, after a challenge; or with TLS token, a text.", "proof"
        )

    @contextmanager
    def _place(self, address: str) -> Iterator[None]:
        """While entered, one more waits at the door. Whoever has waited for longest makes way if it must."""
        task = cast("asyncio.Task[None]", asyncio.current_task())
        own = [entry for entry in self._waiting if entry[0] == address]
        if len(own) >= WAITING_EACH:
            self._send_off(own[0])
        elif len(self._waiting) >= WAITING:
            self._send_off(self._waiting[0])
        entry = (address, task)
        self._waiting.append(entry)
        try:
            yield
        finally:
            if entry in self._waiting:
                self._waiting.remove(entry)

    def _send_off(self, entry: tuple[str, asyncio.Task[None]]) -> None:
        self._waiting.remove(entry)
        entry[1].cancel()


def _keys(tcp: Tcp) -> list[tuple[Role, hmac.HMAC]]:
    """Raises ConfigError: a file is no good, or both hold the same."""
    files = {"operator_token": tcp.operator_token, "observer_token": tcp.observer_token}
    tokens = [(role, read_token(path, f"tcp.{key}")) for key, role in _TOKENS if (path := files[key])]
    if len({token for _, token in tokens}) < len(tokens):
        raise ConfigError("tcp: operator_token and observer_token hold the same token.", "tcp")
    return [(role, hmac.new(token.encode(), digestmod=hashlib.sha256)) for role, token in tokens]


def _proof_with(key: hmac.HMAC, nonce: str) -> bytes:
    made = key.copy()
    made.update(nonce.encode())
    return made.hexdigest().encode()
