"""Dynamixel protocol 2.0 without input or output: instructions to bytes, bytes to status packets.

https://emanual.robotis.com/docs/en/dxl/protocol2/ and https://emanual.robotis.com/docs/en/dxl/crc/

Where `dynamixel-sdk` 4.1.0 differs it is wrong, as the property tests against it found: `txPacket` throws
away what `addStuffing` returns whenever a byte was to be added, so that a packet with FF FF FD in it leaves
without stuffing; and `removeStuffing` compares bytes that it has already overwritten, so that a second
stuffed place right behind the first may come out wrong. Fast sync read is left out: no MX is known to
support it (ROBOTIS-GIT/dynamixel_hardware_interface#50).
"""

from collections.abc import Mapping, Sequence
from enum import IntEnum

from drivers.dynamixel.packets import BROADCAST, Status, check_id

HEADER = b"\xff\xff\xfd\x00"
"""With the reserved byte, which is what tells a header from stuffed data."""

OVERHEAD = 11
"""Bytes of a status packet without its parameters: header, id, length, instruction, error, CRC."""

PING_SIZE = 3
"""Bytes of data in the reply to a ping: model number and version of firmware."""

MOST_PARAMETERS = 1000
"""Not in the manual; an instruction with more would keep any bus busy for longer than a tick."""

_PATTERN = b"\xff\xff\xfd"
_STUFFED = b"\xff\xff\xfd\xfd"

_STATUS = 0x55


class Instruction(IntEnum):
    """The instruction byte."""

    PING = 0x01
    READ = 0x02
    WRITE = 0x03
    REG_WRITE = 0x04
    ACTION = 0x05
    REBOOT = 0x08
    SYNC_READ = 0x82
    SYNC_WRITE = 0x83
    BULK_READ = 0x92


def _shifted_out(byte: int) -> int:
    crc = byte << 8
    for _ in range(8):
        crc = crc << 1 ^ (0x8005 if crc & 0x8000 else 0)
    return crc & 0xFFFF


_CRC_OF_BYTE = tuple(_shifted_out(byte) for byte in range(256))


def crc16(data: bytes | bytearray) -> int:
    """The manual's CRC: polynomial 0x8005, initially 0, most significant bit first, nothing reflected."""
    crc = 0
    for byte in data:
        crc = (crc & 0xFF) << 8 ^ _CRC_OF_BYTE[crc >> 8 ^ byte]
    return crc


def packet(id_: int, instruction: Instruction, parameters: bytes = b"") -> bytes:
    """An instruction packet; length and CRC count the stuffing.

    Raises:
        ValueError: the id is not 0..254, or there are too many parameters.
    """
    check_id(id_)
    if len(parameters) > MOST_PARAMETERS:
        raise ValueError(f"{len(parameters)} parameter bytes, a packet carries {MOST_PARAMETERS}.")
    body = (bytes((instruction,)) + parameters).replace(_PATTERN, _STUFFED)
    head = HEADER + bytes((id_,)) + _word(len(body) + 2) + body
    return head + _word(crc16(head))


def ping(id_: int) -> bytes:
    """Ask a servo whether it is there."""
    return packet(id_, Instruction.PING)


def read(id_: int, address: int, size: int) -> bytes:
    """Ask one servo for `size` bytes."""
    return packet(id_, Instruction.READ, _word(address) + _word(size))


def write(id_: int, address: int, data: bytes) -> bytes:
    """Write `data`, at once."""
    return packet(id_, Instruction.WRITE, _word(address) + data)


def reg_write(id_: int, address: int, data: bytes) -> bytes:
    """Write `data` on the next `action`."""
    return packet(id_, Instruction.REG_WRITE, _word(address) + data)


def action(id_: int = BROADCAST) -> bytes:
    """Carry out what `reg_write` left."""
    return packet(id_, Instruction.ACTION)


def reboot(id_: int) -> bytes:
    """Have a servo start anew, the only way out of a hardware error."""
    return packet(id_, Instruction.REBOOT)


def sync_read(ids: Sequence[int], address: int, size: int) -> bytes:
    """Ask several servos for the same window; they reply in the order of `ids`."""
    return packet(BROADCAST, Instruction.SYNC_READ, _word(address) + _word(size) + bytes(ids))


def bulk_read(windows: Mapping[int, tuple[int, int]]) -> bytes:
    """Ask several servos, by id, each for its own (address, size); they reply in this order."""
    parts = (bytes((id_,)) + _word(address) + _word(size) for id_, (address, size) in windows.items())
    return packet(BROADCAST, Instruction.BULK_READ, b"".join(parts))


def sync_write(address: int, data: Mapping[int, bytes]) -> bytes:
    """Write to several servos at once, by id, the same number of bytes to each. Nobody replies.

    Raises:
        ValueError: the parts are not of one size, or do not fit in a packet.
    """
    sizes = {len(part) for part in data.values()}
    if len(sizes) != 1:
        raise ValueError(f"A sync write gives each servo the same number of bytes, not {sorted(sizes)}.")
    parts = b"".join(bytes((id_,)) + part for id_, part in data.items())
    return packet(BROADCAST, Instruction.SYNC_WRITE, _word(address) + _word(sizes.pop()) + parts)


def is_reply(status: Status, request: bytes) -> bool:
    """Whether `status` is not the echo of `request`: an echo is no status packet, and never gets here."""
    return True


class Parser:
    """Finds status packets in what arrives, and goes on behind garbage."""

    def __init__(self, most_parameters: int = MOST_PARAMETERS) -> None:
        """`most_parameters`: a longer packet is garbage, so that a damaged length cannot swallow others."""
        # Stuffing adds a byte to three at most; instruction, error and CRC are 4 more.
        self._longest = most_parameters * 4 // 3 + 5
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
            return start if start > 0 else len(buffer) - _begun(buffer)
        if len(buffer) < 8:
            return 0
        length = buffer[5] | buffer[6] << 8
        # Only a status comes from a servo; anything else is our own packet, which an adapter returned.
        if buffer[4] >= BROADCAST - 1 or not 4 <= length <= self._longest or buffer[7] != _STATUS:
            return 1
        end = length + 7
        if len(buffer) < end:
            return 0
        if buffer[end - 2] | buffer[end - 1] << 8 != crc16(buffer[: end - 2]):
            return 1
        body = bytes(buffer[8 : end - 2]).replace(_STUFFED, _PATTERN)
        found.append(Status(buffer[4], body[0], body[1:]))
        return end


def _begun(buffer: bytearray) -> int:
    """How many bytes at the end may be the beginning of a header."""
    return next((size for size in (3, 2, 1) if buffer.endswith(HEADER[:size])), 0)


def _word(value: int) -> bytes:
    return value.to_bytes(2, "little")
