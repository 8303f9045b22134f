"""Setting a register that survives power-off: torque off only, confirmed by reading it back."""

from bentod.errors import BusError
from drivers.dynamixel.bus import Bus
from drivers.dynamixel.doctor.findings import Repair
from drivers.dynamixel.doctor.vitals import Vitals
from drivers.dynamixel.tables import MODELS

UNKNOWN = {1: MODELS["MX-28"], 2: MODELS["MX-28(2.0)"]}
"""By protocol: whose table stands for a servo that cannot say what it is; the registers that are mended are
at the same place in all."""


async def mend(bus: Bus, servo: Vitals, repair: Repair) -> None:
    """Set the register and read it back; nothing moves, and torque is neither switched on nor off.

    Raises:
        BusError: its torque is on, its settings are locked, or it did not take the value.
    """
    what = f"{servo}: {repair.register}"
    if servo.raw.get("Torque Enable"):
        raise BusError(f"{what} was not changed, because its torque is on; make it limp first.")
    if servo.raw.get("Lock"):
        raise BusError(f"{what} was not changed, because its Lock is 1; power it off and on first.")
    register = (servo.model or UNKNOWN[servo.protocol]).table[repair.register]
    data = repair.value.to_bytes(register.size, "little")
    await bus.write(servo.protocol, servo.id, register.address, data)
    await bus.settle()  # writing to the EEPROM takes a servo about 6 ms a byte (xevelabs' notes on AX servos)
    replies = await bus.read(servo.protocol, (servo.id,), register.address, register.size)
    if servo.id not in replies or replies[servo.id].data != data:
        raise BusError(f"{what} was to be {repair.value} and is not.")
