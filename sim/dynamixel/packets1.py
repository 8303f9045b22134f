"""Protocol 1.0 as a servo sees it: a stream of bytes becomes requests, and a status becomes bytes.

Source: https://emanual.robotis.com/docs/en/dxl/protocol1/. Shares nothing with the driver's codec.
"""

from enum import IntEnum

from sim.dynamixel.wires import Request

LONGEST = 250
"""Greatest length field that a servo follows; anything above is taken for noise."""


class Instruction(IntEnum):
    """Instruction byte of a request."""

    PING = 0x01
    READ = 0x02
    WRITE = 0x03
    REG_WRITE = 0x04
    ACTION = 0x05
    FACTORY_RESET = 0x06
    SYNC_WRITE = 0x83
    BULK_READ = 0x92


def checksum(body: bytes) -> int:
    """Complement of the sum of everything between header and checksum."""
    return 255 - sum(body) % 256


def status(servo: int, error: int, parameters: bytes = b"") -> bytes:
    """A packet from a servo to the host."""
    body = bytes((servo, len(parameters) + 2, error)) + parameters
    return b"\xff\xff" + body + bytes((checksum(body),))


class Parser:
    """Finds requests in whatever arrives; never raises, and holds no more than one packet.

    A packet of protocol 2.0 begins like one for id 253 with the impossible length 0, and is skipped.
    """

    def __init__(self) -> None:
        self._pending = b""

    def feed(self, data: bytes) -> list[Request]:
        """Requests that `data` completes, in order."""
        found = []
        before = len(self._pending)
        stream = self._pending + data
        start = 0
        while (start := stream.find(b"\xff\xff", start)) >= 0 and start + 4 <= len(stream):
            servo, length = stream[start + 2], stream[start + 3]
            end = start + 4 + length
            if servo == 0xFF or not 2 <= length <= LONGEST:
                start += 1
            elif end > len(stream):
                break
            else:
                body = stream[start + 2 : end - 1]
                sound = checksum(body) == stream[end - 1]
                found.append(Request(servo, body[2], body[3:], sound, end - before))
                start = end
        self._pending = stream[start:] if start >= 0 else _tail(stream)
        return found

    def forget(self) -> None:
        """Drop a packet that was begun: the line has been quiet for longer than a servo waits."""
        self._pending = b""


def _tail(stream: bytes) -> bytes:
    """What may still become a header."""
    return b"\xff" if stream.endswith(b"\xff") else b""
