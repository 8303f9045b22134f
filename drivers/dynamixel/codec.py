"""The two protocols as the bus sees them: one set of functions each."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, Protocol, TypeAlias

from drivers.dynamixel import protocol1, protocol2
from drivers.dynamixel.packets import Status

Version: TypeAlias = Literal[1, 2]


class Parser(Protocol):
    """Turns what arrives into status packets."""

    def feed(self, data: bytes) -> list[Status]:
        """The packets that are complete with `data`."""
        ...

    def clear(self) -> None:
        """Forget what is incomplete."""
        ...


@dataclass(frozen=True, slots=True)
class Codec:
    """One protocol."""

    overhead: int  # bytes of a status packet without its data
    ping_size: int  # bytes of data in the reply to a ping
    ping: Callable[[int], bytes]
    read: Callable[[int, int, int], bytes]
    group_read: Callable[[Sequence[int], int, int], bytes]
    write: Callable[[int, int, bytes], bytes]
    sync_write: Callable[[int, Mapping[int, bytes]], bytes]
    is_reply: Callable[[Status, bytes], bool]
    parser: Callable[[int], Parser]


CODECS: dict[Version, Codec] = {
    1: Codec(
        overhead=protocol1.OVERHEAD,
        ping_size=protocol1.PING_SIZE,
        ping=protocol1.ping,
        read=protocol1.read,
        group_read=protocol1.bulk_read,
        write=protocol1.write,
        sync_write=protocol1.sync_write,
        is_reply=protocol1.is_reply,
        parser=protocol1.Parser,
    ),
    2: Codec(
        overhead=protocol2.OVERHEAD,
        ping_size=protocol2.PING_SIZE,
        ping=protocol2.ping,
        read=protocol2.read,
        group_read=protocol2.sync_read,
        write=protocol2.write,
        sync_write=protocol2.sync_write,
        is_reply=protocol2.is_reply,
        parser=protocol2.Parser,
    ),
}
"""By version of the protocol."""
