"""How servos answer the instructions of protocol 1.0."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial

from sim.dynamixel.cells import Refusal
from sim.dynamixel.device import Device
from sim.dynamixel.packets1 import Instruction, Parser, status
from sim.dynamixel.wires import BROADCAST, Request, Wires

EEPROM_WRITE = 0.006
"""s a byte: xevelabs' notes on AX servos."""

ERRORS: Mapping[Refusal, int] = {
    Refusal.NONE: 0,
    Refusal.RESULT: 64,
    Refusal.INSTRUCTION: 64,
    Refusal.CHECKSUM: 16,
    Refusal.RANGE: 8,
    Refusal.LENGTH: 8,
    Refusal.LIMIT: 2,
    Refusal.ACCESS: 8,
}
"""Bit of the error byte."""

COMPLAINTS = {"Input Voltage Error": 1, "Overheating Error": 4, "Overload Error": 32}
"""Bit of the error byte."""

Answer = tuple[Device, Refusal, bytes]


class Protocol1:
    """Finds requests of protocol 1.0 in what the host sends, and answers them."""

    def __init__(self, wires: Wires) -> None:
        self.parser = Parser()
        self._wires = wires
        self._handlers: Mapping[int, Callable[[Request], None]] = {
            Instruction.PING: self._ping,
            Instruction.READ: self._read,
            Instruction.WRITE: self._write,
            Instruction.REG_WRITE: self._reg_write,
            Instruction.ACTION: self._action,
            Instruction.FACTORY_RESET: self._factory_reset,
            Instruction.SYNC_WRITE: self._sync_write,
            Instruction.BULK_READ: self._bulk_read,
        }

    def answer(self, request: Request) -> None:
        """Let everyone who hears it act and reply."""
        if not request.sound:
            self._refuse(request, Refusal.CHECKSUM)
            return
        for device in self._wires.hearing(request.servo, 1):
            device.servo.heard()
        handler = self._handlers.get(request.instruction)
        if handler is None:
            self._refuse(request, Refusal.INSTRUCTION)
        else:
            handler(request)

    def _ping(self, request: Request) -> None:
        self._reply([(device, Refusal.NONE, b"") for device in self._wires.only(request.servo, 1)])

    def _read(self, request: Request) -> None:
        if len(request.parameters) != 2:
            self._refuse(request, Refusal.INSTRUCTION)
            return
        self._send(self._wires.only(request.servo, 1), *request.parameters)

    def _write(self, request: Request) -> None:
        if not request.parameters:
            self._refuse(request, Refusal.INSTRUCTION)
            return
        address, data = request.parameters[0], request.parameters[1:]
        if any(address < device.table.end_of_eeprom for device in self._wires.hearing(request.servo, 1)):
            self._wires.wait(EEPROM_WRITE * len(data))
        self._confirm(request, partial(Device.write, address=address, data=data))

    def _reg_write(self, request: Request) -> None:
        if not request.parameters:
            self._refuse(request, Refusal.INSTRUCTION)
            return
        address, data = request.parameters[0], request.parameters[1:]
        self._confirm(request, partial(Device.register, address=address, data=data))

    def _action(self, request: Request) -> None:
        self._confirm(request, Device.act)

    def _factory_reset(self, request: Request) -> None:
        """Confirmed under the old id; then id, baud rate and everything else are as new."""
        self._confirm(request, lambda device: Refusal.NONE)
        for device in self._wires.hearing(request.servo, 1):
            device.reset(())

    def _sync_write(self, request: Request) -> None:
        """Address, size, then id and data of each servo; a broken list is ignored."""
        if request.servo != BROADCAST or len(request.parameters) < 2:
            return
        address, size, rest = request.parameters[0], request.parameters[1], request.parameters[2:]
        if not size or len(rest) % (size + 1):
            return
        for start in range(0, len(rest), size + 1):
            for device in self._wires.hearing(rest[start], 1):
                device.write(address, rest[start + 1 : start + 1 + size])

    def _bulk_read(self, request: Request) -> None:
        """Size, id, address of each servo, answered in turn: each waits for the one before it."""
        chain = request.parameters[1:]
        if request.servo != BROADCAST or not request.parameters or len(chain) % 3:
            return
        for start in range(0, len(chain), 3):
            size, servo, address = chain[start : start + 3]
            able = [device for device in self._wires.only(servo, 1) if device.table.bulk_read]
            if not self._send(able, address, size):
                return

    def _send(self, devices: Sequence[Device], address: int, size: int) -> bool:
        """What a servo reads; False when nobody answered."""
        return self._reply(
            [(device, *device.read(address, size)) for device in devices if device.return_level >= 1]
        )

    def _refuse(self, request: Request, refusal: Refusal) -> None:
        self._confirm(request, lambda device: refusal)

    def _confirm(self, request: Request, act: Callable[[Device], Refusal]) -> None:
        """Let everyone who is meant act; a single addressee says how it went."""
        answers: list[Answer] = []
        for device in self._wires.hearing(request.servo, 1):
            refusal = act(device)
            if request.servo != BROADCAST and device.return_level == 2:
                answers.append((device, refusal, b""))
        self._reply(answers)

    def _reply(self, answers: Sequence[Answer]) -> bool:
        """Put a status on the wires; False when there is none."""
        packets = [status(device.id, _error(device, refusal), data) for device, refusal, data in answers]
        return self._wires.put(answers[0][0].return_delay if answers else 0.0, packets)


def _error(device: Device, refusal: Refusal) -> int:
    error = ERRORS[refusal]
    for complaint in device.complaints():
        error |= COMPLAINTS[complaint]
    return error
