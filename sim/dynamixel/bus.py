"""A bus of simulated servos, protocol 1.0: bytes in, delayed bytes out; neither a clock nor a port."""

from collections.abc import Callable, Mapping, Sequence

from sim.dynamixel import tables
from sim.dynamixel.device import Device
from sim.dynamixel.packets import BROADCAST, Error, Instruction, Parser, Request, status
from sim.dynamixel.tables import END_OF_EEPROM

TURNAROUND = 50e-6
"""s from request to reply of an MX servo at Return Delay 0 (resibots/dynamixel_control_hw#7)."""

EEPROM_WRITE = 0.006
"""s a byte: xevelabs' notes on AX servos."""

BAUD_TOLERANCE = 0.03
"""Share by which a rate may be off; 57 600 reaches a servo at 57 142."""

FAST_RATES = {250: 2_250_000, 251: 2_500_000, 252: 3_000_000}


def servo_baud(register: int) -> int:
    """bit/s that the Baud Rate register stands for."""
    return FAST_RATES.get(register, 2_000_000 // (register + 1))


class Bus:
    """Servos on one pair of wires. Several with the same id talk over each other, as they would."""

    def __init__(self, devices: Sequence[Device], baud: int = 1_000_000, timing: bool = True) -> None:
        self.devices = tuple(devices)
        self.baud = baud
        """bit/s at which the host talks; servos set to another rate hear nothing."""
        self.timing = timing
        """Whether bytes and servos take the time that they take."""
        self._parser = Parser()
        self._ready = 0.0
        self._handlers: Mapping[int, Callable[[Request], None]] = {
            Instruction.PING: self._ping,
            Instruction.READ: self._read,
            Instruction.WRITE: self._write,
            Instruction.REG_WRITE: self._reg_write,
            Instruction.ACTION: self._action,
            Instruction.SYNC_WRITE: self._sync_write,
            Instruction.BULK_READ: self._bulk_read,
        }
        self._replies: list[tuple[float, bytes]] = []

    def wire_time(self, count: int) -> float:
        """S that `count` bytes are on the wire, 10 bits each."""
        return count * 10 / self.baud if self.timing else 0.0

    def feed(self, data: bytes) -> list[tuple[float, bytes]]:
        """Replies to `data`, each with the s from the start of `data` to the reply's last byte."""
        self._replies = []
        self._ready = 0.0
        for request in self._parser.feed(data):
            self._ready = max(self._ready, self.wire_time(request.end))
            self._answer(request)
        return self._replies

    def forget(self) -> None:
        """Drop a packet that was begun and not finished for longer than a servo waits."""
        self._parser.forget()

    def _answer(self, request: Request) -> None:
        if not request.sound:
            self._confirm(request, lambda device: Error.CHECKSUM)
        elif request.instruction in self._handlers:
            self._handlers[request.instruction](request)
        else:
            self._confirm(request, lambda device: Error.INSTRUCTION)

    def _ping(self, request: Request) -> None:
        self._reply([(device, Error.NONE, b"") for device in self._only(request.servo)])

    def _read(self, request: Request) -> None:
        if len(request.parameters) != 2:
            self._confirm(request, lambda device: Error.INSTRUCTION)
            return
        self._send(request.servo, *request.parameters)

    def _write(self, request: Request) -> None:
        if not request.parameters:
            self._confirm(request, lambda device: Error.INSTRUCTION)
            return
        address, data = request.parameters[0], request.parameters[1:]
        busy = EEPROM_WRITE * len(data) if self.timing and address < END_OF_EEPROM else 0.0
        self._confirm(request, lambda device: device.write(address, data), busy)

    def _reg_write(self, request: Request) -> None:
        if not request.parameters:
            self._confirm(request, lambda device: Error.INSTRUCTION)
            return
        address, data = request.parameters[0], request.parameters[1:]
        self._confirm(request, lambda device: device.register(address, data))

    def _action(self, request: Request) -> None:
        self._confirm(request, lambda device: device.act())

    def _sync_write(self, request: Request) -> None:
        """Address, size, then id and data of each servo; a broken list is ignored."""
        if request.servo != BROADCAST or len(request.parameters) < 2:
            return
        address, size, rest = request.parameters[0], request.parameters[1], request.parameters[2:]
        if not size or len(rest) % (size + 1):
            return
        for start in range(0, len(rest), size + 1):
            for device in self._hearing(rest[start]):
                device.write(address, rest[start + 1 : start + 1 + size])

    def _bulk_read(self, request: Request) -> None:
        """Size, id, address of each servo, answered in turn: each waits for the one before it."""
        chain = request.parameters[1:]
        if request.servo != BROADCAST or not request.parameters or len(chain) % 3:
            return
        for start in range(0, len(chain), 3):
            size, servo, address = chain[start : start + 3]
            if servo == BROADCAST or not self._send(servo, address, size):
                return

    def _send(self, servo: int, address: int, size: int) -> bool:
        """What a servo reads; False when nobody answered."""
        answers = []
        for device in self._only(servo):
            if device.get(tables.RETURN_LEVEL) >= 1:
                answers.append((device, *device.read(address, size)))
        return self._reply(answers)

    def _confirm(self, request: Request, act: Callable[[Device], Error], busy: float = 0.0) -> None:
        """Let everyone who is meant act; a single addressee says how it went."""
        answers = []
        for device in self._hearing(request.servo):
            error = act(device)
            if request.servo != BROADCAST and device.get(tables.RETURN_LEVEL) == 2:
                answers.append((device, error, b""))
        self._ready += busy
        self._reply(answers)

    def _hearing(self, servo: int) -> list[Device]:
        """Devices that a packet to `servo` reaches."""
        return [
            device
            for device in self.devices
            if servo in (BROADCAST, device.get(tables.ID))
            and device.servo.answers
            and abs(servo_baud(device.get(tables.BAUD)) / self.baud - 1) <= BAUD_TOLERANCE
        ]

    def _only(self, servo: int) -> list[Device]:
        """Devices that may answer: nobody answers a broadcast."""
        return [] if servo == BROADCAST else self._hearing(servo)

    def _reply(self, answers: Sequence[tuple[Device, Error, bytes]]) -> bool:
        """Put a status on the wire; False when there is none. Two at once pull each other's bits low."""
        if not answers:
            return False
        packets = [
            status(device.get(tables.ID), error | device.errors(), data) for device, error, data in answers
        ]
        merged = bytes(_wired_and(column) for column in zip(*packets, strict=False))
        if self.timing:
            self._ready += TURNAROUND + 2e-6 * answers[0][0].get(tables.RETURN_DELAY)
        self._ready += self.wire_time(len(merged))
        self._replies.append((self._ready, merged))
        return True


def _wired_and(column: tuple[int, ...]) -> int:
    level = 0xFF
    for byte in column:
        level &= byte
    return level
