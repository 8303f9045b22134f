"""Where one MessagePack value ends, and whether it is within bounds, told before anything of it is built.

A decoder that builds while it reads can be made to reserve a whole array for each three bytes that promise
one, a thousand of them inside one another. Here promises are only counted.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple, NoReturn

from bentod.errors import BentodError


class BadFraming(BentodError):
    """The other side does not speak MessagePack-RPC; the connection must be closed.

    Examples: bytes that are no MessagePack, an array of five, a text as message id, a message too long.
    """

    code = "bad_framing"


@dataclass(frozen=True, slots=True)
class Limits:
    """What one message may hold at most."""

    size: int = 16 * 1024  # bytes
    items: int = 256  # values in all, keys of maps among them; of a trusted sender: in one array or map
    depth: int = 16  # arrays and maps within each other
    trusted: bool = False  # the sender is the daemon itself: depth and keys are as they should be


A_REQUEST = Limits(size=1024, items=32)
"""What costs as much to take in as a small message to answer."""


class _Head(NamedTuple):
    """What the first byte of a value tells (https://github.com/msgpack/msgpack/blob/master/spec.md)."""

    size: int  # bytes, up to the first value inside; without those that a count adds. 0: refused
    inside: int = 0  # values inside
    width: int = 0  # bytes of the count that follows the first byte
    each: int = 0  # values inside for each that is counted; 0: bytes are counted


def _heads() -> Iterable[_Head]:
    """In the order and the words of the specification's table of formats."""
    yield from [_Head(1)] * 128  # positive fixint
    yield from (_Head(1, inside=2 * n) for n in range(16))  # fixmap
    yield from (_Head(1, inside=n) for n in range(16))  # fixarray
    yield from (_Head(1 + n) for n in range(32))  # fixstr
    yield from (_Head(1), _Head(0), _Head(1), _Head(1))  # nil, (never used), false, true
    yield from (_Head(1 + n, width=n) for n in (1, 2, 4))  # bin
    yield from [_Head(0)] * 3  # ext
    yield from (_Head(1 + n) for n in (4, 8))  # float
    yield from (_Head(1 + n) for n in (1, 2, 4, 8))  # uint
    yield from (_Head(1 + n) for n in (1, 2, 4, 8))  # int
    yield from [_Head(0)] * 5  # fixext
    yield from (_Head(1 + n, width=n) for n in (1, 2, 4))  # str
    yield from (_Head(1 + n, width=n, each=1) for n in (2, 4))  # array
    yield from (_Head(1 + n, width=n, each=2) for n in (2, 4))  # map
    yield from [_Head(1)] * 32  # negative fixint


HEADS = tuple(_heads())
NEVER_USED = 0xC1


class Scanner:
    """Finds the ends of the values in a stream of bytes. Never looks at a byte twice.

    Raises:
        BadFraming: while scanning; the scanner is of no use afterwards.
    """

    def __init__(self, limits: Limits) -> None:
        self._limits = limits
        self._received = bytearray()
        self._start = 0  # of the value under way
        self._at = 0  # of what has not been looked at; it may lie behind the rest of a text that is to come
        self._items = 0  # values that the one under way has promised
        self.weight = 0.0
        self._open: list[int] = []  # of each array or map under way, how many values it still lacks

    weight: float
    """What the value taken last costs, in small requests."""

    def feed(self, data: bytes) -> None:
        """Add received bytes, and let go of those that have been taken."""
        del self._received[: self._start]
        self._at -= self._start
        self._start = 0
        self._received += data

    @property
    def pending(self) -> int:
        """How many bytes there are of what has not been taken."""
        return len(self._received) - self._start

    @property
    def rest(self) -> bytes:
        """What was received after the last value that was taken."""
        return bytes(self._received[self._start :])

    def take(self) -> bytes | None:
        """The bytes of the next value; None when it is not complete yet."""
        self._scan()
        if self._open or not self._start < self._at <= len(self._received):
            return None
        value = bytes(self._received[self._start : self._at])
        self.weight = max(1.0, len(value) / A_REQUEST.size, self._items / A_REQUEST.items)
        self._start, self._items = self._at, 0
        return value

    def _scan(self) -> None:
        """Go on to the end of the value under way, or of what there is of it."""
        received, lacking, end = self._received, self._open, len(self._received)
        while (lacking or self._at == self._start) and self._at < end:
            size, inside, width, each = HEADS[received[self._at]]
            if width:
                begin = self._at + 1
                if begin + width > end:
                    break
                count = int.from_bytes(received[begin : begin + width])
                size, inside = size + (0 if each else count), each * count
            if lacking:
                lacking[-1] -= 1
            if inside:
                lacking.append(inside)
            while lacking and not lacking[-1]:
                lacking.pop()
            self._at += size
            self._items += inside
            self._check(size)

    def _check(self, size: int) -> None:
        if size == 0:
            self._refuse_head()
        if self._at - self._start > self._limits.size:
            raise BadFraming(f"A message is longer than {self._limits.size} bytes.")
        if self._items > self._limits.items:
            raise BadFraming(f"A message holds more than {self._limits.items} values.")
        if len(self._open) > self._limits.depth:
            raise BadFraming(f"Arrays and maps are nested more than {self._limits.depth} deep.")

    def _refuse_head(self) -> NoReturn:
        byte = self._received[self._at]
        what = "is never used" if byte == NEVER_USED else "begins an extension, and none has a meaning here"
        raise BadFraming(f"These bytes are not a message: 0x{byte:02x} {what}.")
