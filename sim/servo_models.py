"""What distinguishes one servo model from another: its motor, its gears and its friction.

MX-64 and MX-106 are model m1 of Rhoban/bam (Apache-2.0; Duclusaud et al., ICRA 2025, `bam/params`); the
controller law in `sim.servo` is from the same source. Everything is seen from the output shaft.
"""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class ServoModel:
    """Physical constants of one servo model at the output shaft."""

    name: str
    torque_constant: float  # N m/A
    resistance: float  # Ω
    armature: float  # kg m²
    coulomb: float  # N m
    viscous: float  # N m s


MX_28 = ServoModel("MX-28", 1.95, 8.57, 0.0034, 0.045, 0.006)
"""No fit is published: scaled from the datasheet's stall torque (2.5 N m, 1.4 A) and no-load speed."""

MX_64 = ServoModel("MX-64", 1.622, 3.949, 0.01195, 0.0904, 0.0117)

MX_106 = ServoModel("MX-106", 2.191, 2.965, 0.0266, 0.1035, 0.0352)

SERVO_MODELS = {model.name: model for model in (MX_28, MX_64, MX_106)}
