"""The servo models: what distinguishes one from another, and which registers a tick uses."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from drivers.dynamixel import firmware1, firmware2
from drivers.dynamixel.codec import Version
from drivers.dynamixel.registers import Register


@dataclass(frozen=True, slots=True)
class Window:
    """A run of registers without a gap."""

    address: int
    size: int  # bytes

    @property
    def end(self) -> int:
        """The address after the last byte."""
        return self.address + self.size


@dataclass(frozen=True, slots=True)
class Layout:
    """Which registers do a job that servos of both generations have, in each one's words."""

    protocol: Version
    windows: tuple[Window, ...]
    """What a round reads. The first is the usual one; the others hold it, and each is longer than the one
    before: see `planner.Group`."""
    goal: tuple[str, str]  # neighbours, written as one in each tick, in the order of their addresses
    speed: str
    fastest: int  # the greatest raw speed that is written
    lowest: str
    highest: str
    gain: str
    acceleration: str
    greatest_acceleration: int  # raw
    protected: int  # bits that Shutdown must have: overheating and overload


# 34 to 43, Torque Limit (0 after an alarm shutdown) to Present Temperature.
FIRMWARE_1 = Layout(
    protocol=1,
    windows=tuple(Window(start, end - start) for start in (34, 32, 30, 28) for end in (44, 45)),
    goal=("Goal Position", "Moving Speed"),
    speed="Moving Speed",
    fastest=1023,  # https://emanual.robotis.com/docs/en/dxl/mx/mx-28/#moving-speed
    lowest="CW Angle Limit",
    highest="CCW Angle Limit",
    gain="P Gain",
    acceleration="Goal Acceleration",
    greatest_acceleration=254,  # https://emanual.robotis.com/docs/en/dxl/mx/mx-28/#goal-acceleration
    protected=0b10_0100,
)

# 126 to 146, Present Load or Current to Present Temperature; none of the windows has an undefined address
# in it, which protocol 2.0 answers with an access error.
FIRMWARE_2 = Layout(
    protocol=2,
    windows=tuple(Window(start, 147 - start) for start in (126, 124, 123, 122, 120, 116, 112, 108)),
    goal=("Profile Velocity", "Goal Position"),
    speed="Profile Velocity",
    fastest=32767,  # https://emanual.robotis.com/docs/en/dxl/mx/mx-28-2/#profile-velocity
    lowest="Min Position Limit",
    highest="Max Position Limit",
    gain="Position P Gain",
    acceleration="Profile Acceleration",
    greatest_acceleration=32767,
    protected=0b10_0100,
)


@dataclass(frozen=True, slots=True)
class ServoModel:
    """One model as it is sold, or as its firmware was changed."""

    number: int  # in the Model Number register
    table: Mapping[str, Register]
    layout: Layout
    centre: int = 2048  # ticks at 0 rad
    last_tick: int = 4095
    grouped: bool = True  # several can be read with one instruction
    gain: int = 32  # the register's default
    least_gain: int = 1
    greatest_gain: int = 254
    gain_per_lsb: float = 1.0  # in steps of firmware 1
    stall_current: float = 1.0  # A at 12 V, of those that show current instead of load

    @property
    def tick(self) -> float:
        """One step of a position, rad."""
        return self.table["Goal Position"].per_lsb

    @property
    def speed_step(self) -> float:
        """One step of a speed, and the slowest that a servo can be told to move, rad/s."""
        return self.table[self.layout.speed].per_lsb

    @property
    def greatest_acceleration(self) -> float:
        """The greatest acceleration that it can be limited to, rad/s²; 0 if to none."""
        register = self.table.get(self.layout.acceleration)
        return self.layout.greatest_acceleration * register.per_lsb if register else 0.0

    @property
    def load_step(self) -> float:
        """One step of what the window has as load, as a share of the greatest torque."""
        if "Present Load" in self.table:
            return self.table["Present Load"].per_lsb
        return self.table["Present Current"].per_lsb / self.stall_current


GAIN_STEP_2 = 4096 / math.tau / 128 / 885 / 0.158
"""One step of Position P Gain in steps of firmware 1's P Gain; so the default of 850 is like one of 31.

Kp is the register / 128, from ticks to PWM of 885 (https://emanual.robotis.com/docs/en/dxl/mx/mx-28-2/
#position-pid-gain); a step of firmware 1 is a share of 0.158 of full output per rad (Rhoban's bam)."""


def _firmware_2(number: int, table: Mapping[str, Register], stall_current: float = 1.0) -> ServoModel:
    return ServoModel(
        number, table, FIRMWARE_2,
        gain=850, greatest_gain=16383, gain_per_lsb=GAIN_STEP_2, stall_current=stall_current,
    )  # fmt: skip


MODELS = {
    # Bulk reads of AX servos fail (DynamixelSDK#40, #46, #386), so they are read one by one. Torque is in
    # proportion to the error over a compliance slope of 32 positions and a margin of 1, the defaults; by the
    # law of `reference.lag` an MX does the same with a P gain of 38.
    "AX-12A": ServoModel(
        12,
        firmware1.AX_12A,
        FIRMWARE_1,
        centre=512,
        last_tick=1023,
        grouped=False,
        gain=38,
        least_gain=38,
        greatest_gain=38,
    ),
    "MX-28": ServoModel(29, firmware1.MX_28, FIRMWARE_1),
    "MX-64": ServoModel(310, firmware1.MX_64, FIRMWARE_1),
    "MX-106": ServoModel(320, firmware1.MX_106, FIRMWARE_1),
    "MX-28(2.0)": _firmware_2(30, firmware2.MX_28),
    "MX-64(2.0)": _firmware_2(311, firmware2.MX_64, stall_current=4.1),
    "MX-106(2.0)": _firmware_2(321, firmware2.MX_106, stall_current=5.2),
}
"""By the name that the config has for them. Stall currents are those of the manual's specifications."""

NAMES = {model.number: name for name, model in MODELS.items()}

KNOWN_NUMBERS = {
    number: ("an AX-12A" if number == 12 else f"an {name.removesuffix('(2.0)')}")
    + (" with firmware for protocol 2.0" if name.endswith("(2.0)") else "")
    for number, name in NAMES.items()
}
"""What a servo with this model number is, for a sentence."""

ALARM_SHUTDOWN = "Torque Limit 0 after Alarm Shutdown"
"""Firmware 1 sets Torque Limit to 0 when it shuts down. "Once error conditions are resolved and Torque Limit
is changed to the value other than 0, the motor can be operated again":
https://emanual.robotis.com/docs/en/dxl/mx/mx-28/#torque-limit"""

HARDWARE_ALERT = "Hardware Error Alert"
"""What firmware 2 complains of until its Hardware Error Status has been read."""

WATCHDOG = "BUS Watchdog Error"
"""The bus was quiet for longer than the watchdog bears; the servo has stopped and takes no goals."""
