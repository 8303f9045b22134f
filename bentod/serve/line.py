"""A connection as two streams, before and after anybody knows who is at its other end."""

import asyncio
import socket
import ssl
from contextlib import suppress
from dataclasses import dataclass
from typing import NoReturn, Protocol

from bentod.bucket import Bucket
from bentod.errors import BentodError
from bentod.messages import encode_notification, error_object
from bentod.serve.peers import Peer

CHUNK = 16 * 1024
"""Bytes read from a client at once."""

HANDSHAKE = 5.0
"""s that a client has for TLS, and then for saying who it is."""

FAREWELL = 1.0
"""s that the last bytes to a client get."""


class SentAway(Exception):
    """A client was not let in, knows why as far as there was time for it, and its line is closed.

    Examples: a user in no group of `access`, a wrong token, too many connections of one user.
    """

    def __init__(self, who: str, text: str) -> None:
        super().__init__(text)
        self.who = who
        """Whom it is counted for."""


@dataclass(frozen=True, slots=True)
class Line:
    """Both directions, and what was received before the conversation began."""

    reader: asyncio.StreamReader
    writer: asyncio.StreamWriter
    ahead: bytes = b""


class Door(Protocol):
    """One way in. A server may have several, and treats alike who comes in through them."""

    @property
    def pace(self) -> Bucket | None:
        """How often somebody may knock; None: as often as they like."""
        ...

    async def admit(self, connection: socket.socket) -> tuple[Line, Peer]:
        """The line to a client, and who it is.

        Raises:
            SentAway: it may not come in.
            OSError: it has left, or never spoke our language.
        """
        ...


async def opened(connection: socket.socket, tls: ssl.SSLContext | None = None) -> Line:
    """The streams of an accepted `connection`; they own it from now on.

    Raises:
        OSError: the client left, does not speak TLS, or is too slow at it.
    """
    loop = asyncio.get_running_loop()
    reader = asyncio.StreamReader(limit=CHUNK, loop=loop)
    transport, protocol = await loop.connect_accepted_socket(
        lambda: asyncio.StreamReaderProtocol(reader, loop=loop),
        connection,
        ssl=tls,
        ssl_handshake_timeout=HANDSHAKE if tls else None,
        ssl_shutdown_timeout=FAREWELL if tls else None,
    )
    return Line(reader, asyncio.StreamWriter(transport, protocol, reader, loop))


async def send_away(line: Line, user: str, name: str, error: BentodError, message: bytes = b"") -> NoReturn:
    """Tell the client why, with `message` or a notification, and close the line within a bounded time.

    Raises:
        SentAway: always; for the log.
    """
    line.writer.write(message or complaint(error))
    await closed(line.writer, FAREWELL)
    raise SentAway(user, f"{name}: {error}")


async def closed(writer: asyncio.StreamWriter, patience: float) -> None:
    """Close a stream once its bytes are sent, or after `patience` (s) without regard for them."""
    writer.close()
    try:
        with suppress(TimeoutError, OSError):
            async with asyncio.timeout(patience):
                await writer.wait_closed()
    finally:
        writer.transport.abort()


def complaint(error: BentodError) -> bytes:
    """An error that answers no request: a notification, because there is no id to answer to."""
    return encode_notification("error", [error_object(error)])


def hold_little(writer: asyncio.StreamWriter, unsent: int) -> None:
    """Let few bytes (`unsent`) wait for a client that reads slowly."""
    writer.transport.set_write_buffer_limits(high=unsent)
    found: socket.socket = writer.get_extra_info("socket")
    with suppress(OSError):  # it has left already
        # The kernel's own 200 KiB would keep a slow client seconds behind the arm.
        found.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, unsent)
