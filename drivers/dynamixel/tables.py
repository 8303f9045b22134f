"""The control tables of MX servos with firmware for protocol 1.0, as data."""

import math
from dataclasses import dataclass
from enum import StrEnum
from typing import Literal, TypeAlias

Unit: TypeAlias = Literal["", "bit/s", "s", "rad", "degrees Celsius", "V", "rad/s", "A", "rad/s²"]

TICK = 2 * math.pi / 4096
"""rad: one step of a position, 0.088 degrees."""

SPEED_STEP = 0.114 * 2 * math.pi / 60
"""rad/s: one step of Moving Speed and Present Speed, 0.114 rev/min."""

ACCELERATION_STEP = math.radians(8.583)
"""rad/s²: one step of Goal Acceleration."""


class Signed(StrEnum):
    """How a register holds values below zero."""

    NO = "never below zero"
    BIT_10 = "bit 10 set: clockwise"
    OFFSET_2048 = "2048 is zero"
    TWOS = "two's complement"


@dataclass(frozen=True, slots=True)
class Register:
    """One line of a control table; values are little-endian."""

    address: int
    size: int  # bytes
    signed: Signed = Signed.NO
    unit: Unit = ""
    per_lsb: float = 1.0  # `unit` per step

    @property
    def end(self) -> int:
        """The address after the last byte."""
        return self.address + self.size


# https://emanual.robotis.com/docs/en/dxl/mx/mx-28/#control-table-of-eeprom-area
# The order and the words are the manual's.
MX_28 = {
    "Model Number": Register(0, 2),
    "Firmware Version": Register(2, 1),
    "ID": Register(3, 1),
    "Baud Rate": Register(4, 1),  # 2,000,000 / (value + 1) bit/s
    "Return Delay Time": Register(5, 1, unit="s", per_lsb=2e-6),
    "CW Angle Limit": Register(6, 2, unit="rad", per_lsb=TICK),
    "CCW Angle Limit": Register(8, 2, unit="rad", per_lsb=TICK),
    "Temperature Limit": Register(11, 1, unit="degrees Celsius"),
    "Min Voltage Limit": Register(12, 1, unit="V", per_lsb=0.1),
    "Max Voltage Limit": Register(13, 1, unit="V", per_lsb=0.1),
    "Max Torque": Register(14, 2, per_lsb=1 / 1023),
    "Status Return Level": Register(16, 1),
    "Alarm LED": Register(17, 1),
    "Shutdown": Register(18, 1),
    "Multi Turn Offset": Register(20, 2, Signed.TWOS, unit="rad", per_lsb=TICK),
    "Resolution Divider": Register(22, 1),
    "Torque Enable": Register(24, 1),
    "LED": Register(25, 1),
    "D Gain": Register(26, 1),
    "I Gain": Register(27, 1),
    "P Gain": Register(28, 1),
    "Goal Position": Register(30, 2, unit="rad", per_lsb=TICK),
    "Moving Speed": Register(32, 2, unit="rad/s", per_lsb=SPEED_STEP),  # 0: no limit on the speed
    "Torque Limit": Register(34, 2, per_lsb=1 / 1023),
    "Present Position": Register(36, 2, unit="rad", per_lsb=TICK),
    "Present Speed": Register(38, 2, Signed.BIT_10, unit="rad/s", per_lsb=SPEED_STEP),
    "Present Load": Register(40, 2, Signed.BIT_10, per_lsb=1 / 1023),
    "Present Voltage": Register(42, 1, unit="V", per_lsb=0.1),
    "Present Temperature": Register(43, 1, unit="degrees Celsius"),
    "Registered": Register(44, 1),
    "Moving": Register(46, 1),
    "Lock": Register(47, 1),
    "Punch": Register(48, 2),
    "Realtime Tick": Register(50, 2, unit="s", per_lsb=1e-3),  # from firmware 40 on
    "Goal Acceleration": Register(73, 1, unit="rad/s²", per_lsb=ACCELERATION_STEP),
}

# https://emanual.robotis.com/docs/en/dxl/mx/mx-64/#control-table-of-ram-area
MX_64 = MX_28 | {
    "Current": Register(68, 2, Signed.OFFSET_2048, unit="A", per_lsb=4.5e-3),
    "Torque Ctrl Mode Enable": Register(70, 1),
    "Goal Torque": Register(71, 2, Signed.BIT_10, unit="A", per_lsb=4.5e-3),
}

# https://emanual.robotis.com/docs/en/dxl/mx/mx-106/#control-table-of-eeprom-area
MX_106 = MX_64 | {
    "Drive Mode": Register(10, 1),
}


@dataclass(frozen=True, slots=True)
class ServoModel:
    """One model as it is sold."""

    number: int  # in the Model Number register
    table: dict[str, Register]


MODELS = {
    "MX-28": ServoModel(29, MX_28),
    "MX-64": ServoModel(310, MX_64),
    "MX-106": ServoModel(320, MX_106),
}

KNOWN_NUMBERS = {
    12: "an AX-12A",
    29: "an MX-28",
    30: "an MX-28 with firmware for protocol 2.0",
    310: "an MX-64",
    311: "an MX-64 with firmware for protocol 2.0",
    320: "an MX-106",
    321: "an MX-106 with firmware for protocol 2.0",
}
"""What may be found where another servo was expected."""

# https://emanual.robotis.com/docs/en/dxl/protocol1/#error
ERRORS = (
    "Input Voltage Error",
    "Angle Limit Error",
    "Overheating Error",
    "Range Error",
    "Checksum Error",
    "Overload Error",
    "Instruction Error",
)
"""Names of the bits of a status packet's error byte, from bit 0."""

REFUSED = 0b0101_1010
"""Errors that say an instruction was not carried out: angle limit, range, checksum, instruction.
The other bits are conditions of the servo, under which a reply is valid."""

ALARM_SHUTDOWN = "Torque Limit 0 after Alarm Shutdown"
"""An alarm shutdown sets Torque Limit to 0, which it stays at until the servo is powered off."""
