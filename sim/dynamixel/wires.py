"""What both protocols share: who hears a request on one pair of wires, and when replies are on them."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce
from operator import and_

from sim.dynamixel.device import Device

BROADCAST = 254

BAUD_TOLERANCE = 0.03
"""Share by which a rate may be off; 57 600 reaches a servo at 57 142."""


@dataclass(frozen=True, slots=True)
class Request:
    """A packet from the host."""

    servo: int
    instruction: int
    parameters: bytes
    sound: bool  # whether its checksum was right
    end: int  # bytes from the start of the newest data to the end of this packet


class Wires:
    """Servos on one pair of wires. Several that talk at once pull each other's bits low."""

    def __init__(self, devices: Sequence[Device], baud: int, timing: bool) -> None:
        self.devices = tuple(devices)
        self.baud = baud
        self.timing = timing
        self.ready = 0.0
        """s from the start of the newest data until the wires are free."""
        self.replies: list[tuple[float, bytes]] = []

    def wire_time(self, count: int) -> float:
        """S that `count` bytes are on the wire, 10 bits each."""
        return count * 10 / self.baud if self.timing else 0.0

    def wait(self, seconds: float) -> None:
        """Let a servo take its time."""
        if self.timing:
            self.ready += seconds

    def hearing(self, servo: int, protocol: int) -> list[Device]:
        """Devices that a packet to `servo` reaches."""
        return [
            device
            for device in self.devices
            if device.protocol == protocol
            and (servo == BROADCAST or servo == device.id)
            and device.servo.answers
            and abs(device.baud / self.baud - 1) <= BAUD_TOLERANCE
        ]

    def only(self, servo: int, protocol: int) -> list[Device]:
        """Devices that may answer: nobody answers a broadcast."""
        return [] if servo == BROADCAST else self.hearing(servo, protocol)

    def put(self, delay: float, packets: Sequence[bytes]) -> bool:
        """Put a reply on the wires `delay` (s) after they were free; False when there is none.

        Several at once are one garbled reply.
        """
        if not packets:
            return False
        merged = packets[0] if len(packets) == 1 else _wired_and(packets)
        self.wait(delay)
        self.ready += self.wire_time(len(merged))
        self.replies.append((self.ready, merged))
        return True


def _wired_and(packets: Sequence[bytes]) -> bytes:
    return bytes(reduce(and_, column) for column in zip(*packets, strict=False))
