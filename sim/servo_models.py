"""What distinguishes one servo model from another: motor, gears, friction, and how its registers count.

MX-64 and MX-106 are model m1 of Rhoban/bam (Apache-2.0; Duclusaud et al., ICRA 2025, `bam/params`); the
controller law in `sim.servo` is from the same source. Everything is seen from the output shaft.
"""

from dataclasses import dataclass, replace
from math import pi, radians

RPM = 2 * pi / 60
"""rad/s of one revolution a minute."""


@dataclass(frozen=True, slots=True)
class Scale:
    """How a position and a speed become numbers in registers."""

    centre: int  # position at 0 rad
    last: int  # greatest position
    tick: float  # rad of one step of position
    speed: float  # rad/s of one step of speed

    def ticks(self, position: float) -> int:
        """The number that stands for `position` (rad), in the sensor's range or not."""
        return self.centre + round(position / self.tick)

    def angle(self, ticks: int) -> float:
        """The position (rad) that `ticks` stands for."""
        return (ticks - self.centre) * self.tick


MX_SCALE = Scale(2048, 4095, 2 * pi / 4096, 0.114 * RPM)
"""MX with firmware 1."""

MX2_SCALE = Scale(2048, 4095, 2 * pi / 4096, 0.229 * RPM)
"""MX with firmware 2."""

AX_SCALE = Scale(512, 1023, radians(300 / 1024), 0.111 * RPM)
"""AX: nothing is seen of the 60° outside."""


@dataclass(frozen=True, slots=True)
class ServoModel:
    """Physical constants of one servo model at the output shaft."""

    name: str
    torque_constant: float  # N m/A
    resistance: float  # Ω
    armature: float  # kg m²
    coulomb: float  # N m
    viscous: float  # N m s
    scale: Scale = MX_SCALE


AX_12A = ServoModel("AX-12A", 1.6, 8.0, 0.004, 0.06, 0.01, AX_SCALE)
"""Assumed: no fit is published, and the datasheet (1.5 N m at 1.5 A, 59 rpm) gives no more than the order."""

MX_28 = ServoModel("MX-28", 1.95, 8.57, 0.0034, 0.045, 0.006)
"""No fit is published: scaled from the datasheet's stall torque (2.5 N m, 1.4 A) and no-load speed."""

MX_64 = ServoModel("MX-64", 1.622, 3.949, 0.01195, 0.0904, 0.0117)

MX_106 = ServoModel("MX-106", 2.191, 2.965, 0.0266, 0.1035, 0.0352)

_FIRMWARE_1 = (MX_28, MX_64, MX_106)
_FIRMWARE_2 = tuple(replace(model, name=f"{model.name}(2.0)", scale=MX2_SCALE) for model in _FIRMWARE_1)

SERVO_MODELS = {model.name: model for model in (AX_12A, *_FIRMWARE_1, *_FIRMWARE_2)}
