"""A bus of simulated servos: bytes in, delayed bytes out; neither a clock nor a port."""

from collections.abc import Sequence

from sim.dynamixel.device import Device
from sim.dynamixel.protocol1 import Protocol1
from sim.dynamixel.protocol2 import Protocol2
from sim.dynamixel.wires import Wires


class Bus:
    """Servos on one pair of wires, of one protocol or both: each ignores packets of the other.

    Several with the same id talk over each other, as they would.
    """

    def __init__(self, devices: Sequence[Device], baud: int = 1_000_000, timing: bool = True) -> None:
        """`baud`: bit/s; `timing`: whether bytes and servos take the time that they take."""
        self.devices = tuple(devices)
        self._wires = Wires(devices, baud, timing)
        self._speakers = (Protocol1(self._wires), Protocol2(self._wires))

    @property
    def baud(self) -> int:
        """bit/s at which the host talks; servos set to another rate hear nothing."""
        return self._wires.baud

    @baud.setter
    def baud(self, baud: int) -> None:
        self._wires.baud = baud

    def wire_time(self, count: int) -> float:
        """S that `count` bytes are on the wire, 10 bits each."""
        return self._wires.wire_time(count)

    def feed(self, data: bytes) -> list[tuple[float, bytes]]:
        """Replies to `data`, each with the s from the start of `data` to the reply's last byte."""
        wires = self._wires
        wires.replies = []
        wires.ready = 0.0
        heard = [
            (request.end, speaker, request)
            for speaker in self._speakers
            for request in speaker.parser.feed(data)
        ]
        for end, speaker, request in sorted(heard, key=lambda item: item[0]):
            wires.ready = max(wires.ready, wires.wire_time(end))
            speaker.answer(request)
        return wires.replies

    def forget(self) -> None:
        """Drop a packet that was begun and not finished for longer than a servo waits."""
        for speaker in self._speakers:
            speaker.parser.forget()
