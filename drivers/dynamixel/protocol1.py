"""Dynamixel protocol 1.0 without input or output: instructions to bytes, bytes to status packets.

https://emanual.robotis.com/docs/en/dxl/protocol1/
"""

from collections.abc import Mapping, Sequence
from enum import IntEnum

from drivers.dynamixel.packets import BROADCAST, Status, check_id

HEADER = b"\xff\xff"
OVERHEAD = 6
"""Bytes of a packet without its parameters: header, id, length, instruction or error, checksum."""

PING_SIZE = 0
"""Bytes of data in the reply to a ping."""

MOST_PARAMETERS = 0xFF - 2


class Instruction(IntEnum):
    """The instruction byte."""

    PING = 0x01
    READ = 0x02
    WRITE = 0x03
    REG_WRITE = 0x04
    ACTION = 0x05
    SYNC_WRITE = 0x83
    BULK_READ = 0x92


def checksum(body: bytes | bytearray) -> int:
    """The inverted low byte of the sum of everything between the header and the checksum."""
    return ~sum(body) & 0xFF


def packet(id_: int, instruction: Instruction, parameters: bytes = b"") -> bytes:
    """An instruction packet.

    Raises:
        ValueError: the id is not 0..254, or the packet would be longer than its length byte can say.
    """
    check_id(id_)
    if len(parameters) > MOST_PARAMETERS:
        raise ValueError(f"{len(parameters)} parameter bytes, a packet carries {MOST_PARAMETERS}.")
    body = bytes((id_, len(parameters) + 2, instruction)) + parameters
    return HEADER + body + bytes((checksum(body),))


def ping(id_: int) -> bytes:
    """Ask a servo whether it is there."""
    return packet(id_, Instruction.PING)


def read(id_: int, address: int, size: int) -> bytes:
    """Ask one servo for `size` bytes."""
    return packet(id_, Instruction.READ, bytes((address, size)))


def write(id_: int, address: int, data: bytes) -> bytes:
    """Write `data`, at once."""
    return packet(id_, Instruction.WRITE, bytes((address,)) + data)


def reg_write(id_: int, address: int, data: bytes) -> bytes:
    """Write `data` on the next `action`."""
    return packet(id_, Instruction.REG_WRITE, bytes((address,)) + data)


def action(id_: int = BROADCAST) -> bytes:
    """Carry out what `reg_write` left."""
    return packet(id_, Instruction.ACTION)


def sync_write(address: int, data: Mapping[int, bytes]) -> bytes:
    """Write to several servos at once, by id, the same number of bytes to each. Nobody replies.

    Raises:
        ValueError: the parts are not of one size, or do not fit in a packet.
    """
    sizes = {len(part) for part in data.values()}
    if len(sizes) != 1:
        raise ValueError(f"A sync write gives each servo the same number of bytes, not {sorted(sizes)}.")
    parts = b"".join(bytes((id_,)) + part for id_, part in data.items())
    return packet(BROADCAST, Instruction.SYNC_WRITE, bytes((address, sizes.pop())) + parts)


def bulk_read(ids: Sequence[int], address: int, size: int) -> bytes:
    """Ask several servos for the same window; each replies when the one before it in `ids` has.

    Raises:
        ValueError: the request does not fit in a packet.
    """
    parts = b"".join(bytes((size, id_, address)) for id_ in ids)
    return packet(BROADCAST, Instruction.BULK_READ, b"\x00" + parts)


def is_reply(status: Status, request: bytes) -> bool:
    """Whether `status` is not `request` itself, which half-duplex adapters may return.

    The echo of a ping cannot be told from its reply; the first reading after it can.
    """
    return not status.parameters or request[4:-1] != bytes((status.error,)) + status.parameters


class Parser:
    """Finds status packets in what arrives, and goes on behind garbage."""

    def __init__(self, most_parameters: int = MOST_PARAMETERS) -> None:
        """`most_parameters`: a longer packet is garbage, so that a damaged length cannot swallow others."""
        self._longest = most_parameters + 2
        self._buffer = bytearray()

    def feed(self, data: bytes) -> list[Status]:
        """The packets that are complete with `data`; what is incomplete waits for more."""
        self._buffer += data
        found: list[Status] = []
        while (end := self._next(found)) > 0:
            del self._buffer[:end]
        return found

    def clear(self) -> None:
        """Forget what is incomplete."""
        self._buffer.clear()

    def _next(self, found: list[Status]) -> int:
        """How many bytes are done with, 0 when more are needed; a packet among them is added to `found`."""
        buffer = self._buffer
        start = buffer.find(HEADER)
        if start != 0:
            # The last byte may be the first half of a header.
            return start if start > 0 else max(len(buffer) - buffer.endswith(b"\xff"), 0)
        if len(buffer) < 4:
            return 0
        length = buffer[3]
        if buffer[2] >= BROADCAST or not 2 <= length <= self._longest:
            return 1
        end = length + 4
        if len(buffer) < end:
            return 0
        if buffer[end - 1] != checksum(buffer[2 : end - 1]):
            return 1
        found.append(Status(buffer[2], buffer[4], bytes(buffer[5 : end - 1])))
        return end
