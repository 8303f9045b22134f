"""What can be wrong with the registers of a servo: it is not the one, or not set up as the config has it."""

from collections.abc import Mapping, Sequence

from bentod.errors import BadRequest
from sim.arm import Inject
from sim.dynamixel.cells import Cell
from sim.dynamixel.device import Device
from sim.dynamixel.firmware2 import Firmware2

OTHER_MODEL, ANOTHER_MODEL = 12, 320

OLD_FIRMWARE = 36
"""Before the Realtime Tick of firmware 1 (40) and the Bus Watchdog of firmware 2 (38)."""

NARROWER = 8
"""Part of the range by which each EEPROM limit moves inwards."""


class RegisterFaults:
    """Faults by joint; ending one gives the register back what it held."""

    def __init__(self, devices: Sequence[Device]) -> None:
        self._devices = tuple(devices)
        self._ids = [device.id for device in devices]
        self._saved: dict[tuple[int, Cell], int] = {}

    def faults(self) -> Mapping[str, Inject]:
        """By name."""
        return {
            "wrong_model": self._wrong_model,
            "wrong_firmware": self._wrong_firmware,
            "id_clash": self._id_clash,
            "narrow_limits": self._narrow_limits,
            "watchdog": self._watchdog,
        }

    def _wrong_model(self, joint: int, on: bool) -> None:
        device = self._devices[joint]
        cell = device.table.common.model
        wrong = ANOTHER_MODEL if device.get(cell) == OTHER_MODEL else OTHER_MODEL
        self._change(joint, cell, wrong, on)

    def _wrong_firmware(self, joint: int, on: bool) -> None:
        self._change(joint, self._devices[joint].table.common.firmware, OLD_FIRMWARE, on)

    def _id_clash(self, joint: int, on: bool) -> None:
        other = self._ids[0 if joint else -1]
        self._change(joint, self._devices[joint].table.common.id, other, on)

    def _narrow_limits(self, joint: int, on: bool) -> None:
        device = self._devices[joint]
        lowest, highest = device.table.common.lowest, device.table.common.highest
        inwards = (device.get(highest) - device.get(lowest)) // NARROWER
        self._change(joint, lowest, device.get(lowest) + inwards, on)
        self._change(joint, highest, device.get(highest) - inwards, on)

    def _watchdog(self, joint: int, on: bool) -> None:
        device = self._devices[joint]
        if not isinstance(device, Firmware2):
            raise BadRequest(f"servo {device.id} ({device.table.name}) has no watchdog", "joint")
        if on:
            device.servo.bite()
        else:
            device.servo.watch(0.0)

    def _change(self, joint: int, cell: Cell, value: int, on: bool) -> None:
        device = self._devices[joint]
        if on and (joint, cell) not in self._saved:
            self._saved[joint, cell] = device.get(cell)
            device.provision(cell, value)
        elif not on and (joint, cell) in self._saved:
            device.provision(cell, self._saved.pop((joint, cell)))
