"""A scripted line: what must be sent, byte for byte, and what comes back. Shares no code with the driver."""

import asyncio
from collections.abc import Callable
from dataclasses import dataclass

from bentod.errors import BusError


def framed(*body: int) -> bytes:
    """Header, `body` from id to last parameter, and the checksum, as the manual describes it."""
    return bytes((0xFF, 0xFF, *body, 0xFF - sum(body) % 256))


def status(id_: int, *parameters: int, error: int = 0) -> bytes:
    return framed(id_, len(parameters) + 2, error, *parameters)


def word(value: int) -> tuple[int, int]:
    return value % 256, value // 256


@dataclass(slots=True)
class Exchange:
    sent: bytes
    replies: tuple[bytes, ...]
    after: float  # s


class Wire:
    """A ByteStream. A write that the script does not expect fails the test."""

    def __init__(self) -> None:
        self.script: list[Exchange] = []
        self.closed = False
        self.gone = ""
        self.dead = False  # whatever is sent, nobody replies
        self.deliver: Callable[[bytes], None] = lambda data: None
        self.lose: Callable[[str], None] = lambda reason: None

    def expect(self, sent: bytes | str, *replies: bytes | str, after: float = 0.001, times: int = 1) -> None:
        """When `sent` is written, `replies` come one by one, each `after` s after the last."""
        self.script += [
            Exchange(_bytes(sent), tuple(_bytes(reply) for reply in replies), after) for _ in range(times)
        ]

    def listen(self, on_bytes: Callable[[bytes], None], on_lost: Callable[[str], None]) -> None:
        self.deliver = on_bytes
        self.lose = on_lost

    def write(self, data: bytes) -> None:
        if self.gone:
            raise BusError(self.gone)
        if self.dead:
            return
        assert self.script, f"nothing more was to be sent, but {data.hex(' ')}"
        exchange = self.script.pop(0)
        assert data.hex(" ") == exchange.sent.hex(" ")
        loop = asyncio.get_running_loop()
        for number, reply in enumerate(exchange.replies, 1):
            loop.call_later(exchange.after * number, self.deliver, reply)

    def close(self) -> None:
        self.closed = True

    def finished(self) -> bool:
        """Whether everything in the script was sent."""
        return not self.script


def _bytes(packet: bytes | str) -> bytes:
    return bytes.fromhex(packet) if isinstance(packet, str) else packet
