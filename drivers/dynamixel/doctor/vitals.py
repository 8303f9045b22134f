"""What a servo says about itself: the registers that matter, read one by one."""

from collections.abc import Mapping
from dataclasses import dataclass

from drivers.dynamixel.bus import Bus, Reply
from drivers.dynamixel.codec import Version
from drivers.dynamixel.registers import Register, from_raw, to_raw
from drivers.dynamixel.tables import MODELS, NAMES, ServoModel

MODEL_NUMBER = Register(0, 2)
"""The one register that is at the same place in every servo of either protocol."""

WANTED = (
    "Firmware Version", "Baud Rate", "Return Delay Time", "Drive Mode", "Operating Mode",
    "CW Angle Limit", "CCW Angle Limit", "Min Position Limit", "Max Position Limit",
    "Temperature Limit", "Min Voltage Limit", "Max Voltage Limit",
    "Max Torque", "PWM Limit", "Status Return Level", "Shutdown", "Torque Enable",
    "P Gain", "Position P Gain", "Torque Limit", "Hardware Error Status", "BUS Watchdog",
    "Present Position", "Present Voltage", "Present Input Voltage", "Present Temperature", "Lock",
)  # fmt: skip
"""Of those, each model has some."""

ATTEMPTS = 3


@dataclass(frozen=True, slots=True)
class Vitals:
    """One servo that answered a ping."""

    id: int
    protocol: Version
    baud: int  # bit/s at which it answered
    number: int | None  # in its Model Number register; None when it answers pings only
    raw: Mapping[str, int]  # by the manual's name of the register, as far as it answered
    error: int = 0  # the error byte of its last reply

    @property
    def name(self) -> str:
        """The model as configs have it, empty when it is not known."""
        return NAMES.get(self.number, "") if self.number is not None else ""

    @property
    def model(self) -> ServoModel | None:
        """The model's tables, None when it is not known."""
        return MODELS.get(self.name)

    def value(self, *names: str) -> float | None:
        """The first of the registers that this servo has, in its unit; None when there is none."""
        for name in names:
            if self.model is not None and name in self.raw:
                return from_raw(self.model.table[name], self.raw[name])
        return None

    def __str__(self) -> str:
        return f"Servo {self.id}"


async def examine(bus: Bus, id_: int, protocol: Version, baud: int) -> Vitals:
    """Read a servo; it is not written to."""
    number = await _read(bus, protocol, id_, MODEL_NUMBER)
    if number is None:
        return Vitals(id_, protocol, baud, None, {})
    found = Vitals(id_, protocol, baud, to_raw(MODEL_NUMBER, number.data), {}, number.error)
    table = found.model.table if found.model else {}
    raw: dict[str, int] = {}
    error = number.error
    for name in WANTED:
        reply = await _read(bus, protocol, id_, table[name]) if name in table else None
        if reply is not None:
            raw[name] = to_raw(table[name], reply.data, table[name].address)
            error = reply.error
    return Vitals(id_, protocol, baud, found.number, raw, error)


async def _read(bus: Bus, protocol: Version, id_: int, register: Register) -> Reply | None:
    for _ in range(ATTEMPTS):
        replies = await bus.read(protocol, (id_,), register.address, register.size)
        if id_ in replies:
            return replies[id_]
        await bus.settle()
    return None
