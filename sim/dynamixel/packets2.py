"""Protocol 2.0 as a servo sees it: a stream of bytes becomes requests, and a status becomes bytes.

Source: https://emanual.robotis.com/docs/en/dxl/protocol2/. Shares nothing with the driver's codec.
"""

from collections.abc import Sequence
from enum import IntEnum

from sim.dynamixel.wires import BROADCAST, Request

HEADER = b"\xff\xff\xfd\x00"
STATUS = 0x55
LONGEST = 1023
"""Greatest length field that a servo follows; anything above is taken for noise. Assumed."""


class Instruction(IntEnum):
    """Instruction byte of a request."""

    PING = 0x01
    READ = 0x02
    WRITE = 0x03
    REG_WRITE = 0x04
    ACTION = 0x05
    FACTORY_RESET = 0x06
    REBOOT = 0x08
    SYNC_READ = 0x82
    SYNC_WRITE = 0x83
    FAST_SYNC_READ = 0x8A
    BULK_READ = 0x92
    BULK_WRITE = 0x93
    FAST_BULK_READ = 0x9A


def _remainder(byte: int) -> int:
    """What is left of `byte` when the polynomial 0x8005 is taken out, most significant bit first."""
    register = byte << 8
    for _ in range(8):
        register = (register << 1 ^ 0x8005 if register & 0x8000 else register << 1) & 0xFFFF
    return register


REMAINDERS = tuple(_remainder(byte) for byte in range(256))


def crc(data: bytes) -> int:
    """CRC-16 from 0 over `data`."""
    register = 0
    for byte in data:
        register = (register << 8 & 0xFF00) ^ REMAINDERS[register >> 8 ^ byte]
    return register


def sealed(packet: bytes) -> bytes:
    """`packet` with its CRC."""
    return packet + crc(packet).to_bytes(2, "little")


def status(servo: int, error: int, parameters: bytes = b"") -> bytes:
    """A packet from a servo to the host."""
    body = (bytes((STATUS, error)) + parameters).replace(b"\xff\xff\xfd", b"\xff\xff\xfd\xfd")
    return sealed(HEADER + bytes((servo,)) + (len(body) + 2).to_bytes(2, "little") + body)


def fast_status(parts: Sequence[tuple[int, int, bytes]], length: int) -> bytes:
    """The one packet in which several servos answer in turn: each error, id and data, each with a CRC so far.

    `length`: of the whole packet, as the first to answer announces it; there may be fewer parts.
    """
    packet = HEADER + bytes((BROADCAST,)) + length.to_bytes(2, "little") + bytes((STATUS,))
    for servo, error, data in parts:
        packet = sealed(packet + bytes((error, servo)) + data)
    return packet


class Parser:
    """Finds requests in whatever arrives; never raises, and holds no more than one packet."""

    def __init__(self) -> None:
        self._pending = b""

    def feed(self, data: bytes) -> list[Request]:
        """Requests that `data` completes, in order; statuses that come by are none."""
        found = []
        before = len(self._pending)
        stream = self._pending + data
        start = 0
        while (start := stream.find(HEADER, start)) >= 0 and start + 7 <= len(stream):
            servo, length = stream[start + 4], int.from_bytes(stream[start + 5 : start + 7], "little")
            end = start + 7 + length
            if servo in (0xFD, 0xFF) or not 3 <= length <= LONGEST:
                start += 1
            elif end > len(stream):
                break
            else:
                sound = sealed(stream[start : end - 2]) == stream[start:end]
                body = stream[start + 7 : end - 2].replace(b"\xff\xff\xfd\xfd", b"\xff\xff\xfd")
                found.append(Request(servo, body[0], body[1:], sound, end - before))
                start = end
        self._pending = stream[start:] if start >= 0 else _tail(stream)
        return [request for request in found if request.instruction != STATUS]

    def forget(self) -> None:
        """Drop a packet that was begun: the line has been quiet for longer than a servo waits."""
        self._pending = b""


def _tail(stream: bytes) -> bytes:
    """What may still become a header."""
    for size in (3, 2, 1):
        if stream.endswith(HEADER[:size]):
            return HEADER[:size]
    return b""
