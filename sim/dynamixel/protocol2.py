"""How servos answer the instructions of protocol 2.0."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial

from sim.dynamixel.cells import Cell, Refusal
from sim.dynamixel.device import Device
from sim.dynamixel.packets2 import Instruction, Parser, fast_status, status
from sim.dynamixel.wires import BROADCAST, Request, Wires

SLOT = 0.003
"""s an id: when a servo answers a broadcast ping. dynamixel-sdk waits for as long (`broadcastPing`)."""

ALERT = 0x80

ERRORS: Mapping[Refusal, int] = {
    Refusal.NONE: 0,
    Refusal.RESULT: 1,
    Refusal.INSTRUCTION: 2,
    Refusal.CHECKSUM: 3,
    Refusal.RANGE: 4,
    Refusal.LENGTH: 5,
    Refusal.LIMIT: 6,
    Refusal.ACCESS: 7,
}
"""Number in the error byte."""

ALL, ALL_BUT_ID, ALL_BUT_ID_AND_BAUD = 0xFF, 0x01, 0x02
"""What a factory reset resets."""

Answer = tuple[Device, Refusal, bytes]
Part = tuple[int, int, int]
"""Id, address and size: what one servo of several is to read."""


class Protocol2:
    """Finds requests of protocol 2.0 in what the host sends, and answers them.

    In a read of several each servo waits for the one before it, so the first silent one ends it.
    """

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
            Instruction.REBOOT: self._reboot,
            Instruction.SYNC_READ: self._sync_read,
            Instruction.SYNC_WRITE: self._sync_write,
            Instruction.FAST_SYNC_READ: self._sync_read,
            Instruction.BULK_READ: self._bulk_read,
            Instruction.BULK_WRITE: self._bulk_write,
            Instruction.FAST_BULK_READ: self._bulk_read,
        }

    def answer(self, request: Request) -> None:
        """Let everyone who hears it act and reply."""
        if not request.sound:
            self._refuse(request, Refusal.CHECKSUM)
            return
        for device in self._wires.hearing(request.servo, 2):
            device.servo.heard()
        handler = self._handlers.get(request.instruction)
        if handler is None:
            self._refuse(request, Refusal.INSTRUCTION)
        else:
            handler(request)

    def _ping(self, request: Request) -> None:
        """Model and firmware; a broadcast is answered by everyone in the time slot of its id."""
        devices = self._wires.hearing(request.servo, 2)
        if request.servo != BROADCAST:
            self._reply([_introduction(device) for device in devices])
            return
        asked = self._wires.ready
        for slot in sorted({device.id for device in devices}):
            self._wires.wait(max(asked + SLOT * slot - self._wires.ready, 0.0))
            self._reply([_introduction(device) for device in devices if device.id == slot])

    def _read(self, request: Request) -> None:
        if len(request.parameters) != 4:
            self._refuse(request, Refusal.LENGTH)
            return
        address, size = _words(request.parameters)
        self._send(self._wires.only(request.servo, 2), address, size)

    def _write(self, request: Request) -> None:
        if len(request.parameters) < 3:
            self._refuse(request, Refusal.LENGTH)
            return
        address, data = _word(request.parameters), request.parameters[2:]
        self._confirm(request, partial(Device.write, address=address, data=data))

    def _reg_write(self, request: Request) -> None:
        if len(request.parameters) < 3:
            self._refuse(request, Refusal.LENGTH)
            return
        address, data = _word(request.parameters), request.parameters[2:]
        self._confirm(request, partial(Device.register, address=address, data=data))

    def _action(self, request: Request) -> None:
        self._confirm(request, Device.act)

    def _factory_reset(self, request: Request) -> None:
        """Confirmed under the old id. The manual: a broadcast does not reset ids, or all would be 1."""
        option = request.parameters[:1] or b"\x00"
        if option[0] not in (ALL, ALL_BUT_ID, ALL_BUT_ID_AND_BAUD):
            self._refuse(request, Refusal.RANGE)
        elif request.servo != BROADCAST or option[0] != ALL:
            self._confirm(request, lambda device: Refusal.NONE)
            for device in self._wires.hearing(request.servo, 2):
                device.reset(_kept(device, option[0]))

    def _reboot(self, request: Request) -> None:
        self._confirm(request, lambda device: Refusal.NONE)
        for device in self._wires.hearing(request.servo, 2):
            device.servo.reboot()

    def _sync_read(self, request: Request) -> None:
        """Address, size, then ids."""
        if request.servo == BROADCAST and len(request.parameters) >= 5:
            address, size = _words(request.parameters)
            parts = [(servo, address, size) for servo in request.parameters[4:]]
            self._read_several(parts, request.instruction == Instruction.FAST_SYNC_READ)

    def _bulk_read(self, request: Request) -> None:
        """Id, address and size of each servo; a broken list is ignored."""
        chain = request.parameters
        if request.servo == BROADCAST and chain and len(chain) % 5 == 0:
            parts = [(chain[at], *_words(chain[at + 1 :])) for at in range(0, len(chain), 5)]
            self._read_several(parts, request.instruction == Instruction.FAST_BULK_READ)

    def _read_several(self, parts: Sequence[Part], fast: bool) -> None:
        if fast:
            self._read_fast(parts)
            return
        for servo, address, size in parts:
            if not self._send(self._wires.only(servo, 2), address, size):
                return

    def _read_fast(self, parts: Sequence[Part]) -> None:
        """One packet for all; who cannot do it, or does not hear it, ends it too soon."""
        answered: list[tuple[int, int, bytes]] = []
        delay = 0.0
        for servo, address, size in parts:
            able = [device for device in self._wires.only(servo, 2) if device.fast]
            if not able:
                break
            refusal, data = able[0].read(address, size)
            answered.append((servo, _error(able[0], refusal), data.ljust(size, b"\x00")))
            delay += able[0].return_delay
        length = 1 + sum(size + 4 for _, _, size in parts)
        if answered and length <= 0xFFFF:
            self._wires.put(delay, [fast_status(answered, length)])

    def _sync_write(self, request: Request) -> None:
        """Address, size, then id and data of each servo; a broken list is ignored."""
        if request.servo != BROADCAST or len(request.parameters) < 4:
            return
        address, size = _words(request.parameters)
        rest = request.parameters[4:]
        if not size or len(rest) % (size + 1):
            return
        for at in range(0, len(rest), size + 1):
            self._write_one(rest[at], address, rest[at + 1 : at + 1 + size])

    def _bulk_write(self, request: Request) -> None:
        """Id, address, size and data of each servo; what is left of a broken list is ignored."""
        rest = request.parameters if request.servo == BROADCAST else b""
        for servo, address, data in _pieces(rest):
            self._write_one(servo, address, data)

    def _write_one(self, servo: int, address: int, data: bytes) -> None:
        for device in self._wires.only(servo, 2):
            device.write(address, data)

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
        for device in self._wires.hearing(request.servo, 2):
            refusal = act(device)
            if request.servo != BROADCAST and device.return_level == 2:
                answers.append((device, refusal, b""))
        self._reply(answers)

    def _reply(self, answers: Sequence[Answer]) -> bool:
        """Put a status on the wires; False when there is none."""
        packets = [status(device.id, _error(device, refusal), data) for device, refusal, data in answers]
        return self._wires.put(answers[0][0].return_delay if answers else 0.0, packets)


def _introduction(device: Device) -> Answer:
    common = device.table.common
    model, firmware = device.get(common.model), device.get(common.firmware)
    return device, Refusal.NONE, model.to_bytes(2, "little") + bytes((firmware,))


def _kept(device: Device, option: int) -> tuple[Cell, ...]:
    common = device.table.common
    kept = {ALL: (), ALL_BUT_ID: (common.id,), ALL_BUT_ID_AND_BAUD: (common.id, common.baud)}
    return kept[option]


def _error(device: Device, refusal: Refusal) -> int:
    return ERRORS[refusal] | (ALERT if device.alert() else 0)


def _word(data: bytes) -> int:
    return int.from_bytes(data[:2], "little")


def _words(data: bytes) -> tuple[int, int]:
    return _word(data), _word(data[2:])


def _pieces(rest: bytes) -> Iterator[tuple[int, int, bytes]]:
    while len(rest) > 5 and len(rest) >= 5 + _word(rest[3:]):
        end = 5 + _word(rest[3:])
        yield rest[0], _word(rest[1:]), rest[5:end]
        rest = rest[end:]
