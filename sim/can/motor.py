"""A joint's motor, gear and load as a pure `step(dt)`, and the control loops in front of it.

Loops as in ODrive's public documentation: position error → velocity → torque, the integrator on velocity
only, the current limit last. Every constant is assumed, and none of this was compared with a real motor.
Not modelled: elasticity, backlash, cogging, field weakening, sensor noise and filtering.
"""

import math
from dataclasses import dataclass
from enum import IntEnum
from math import copysign

from sim.shaft import Link, Shaft

SUBSTEP = 0.001
"""s: coarser than the 125 µs of an ODrive."""

TORQUE_PER_AMPERE = 0.3
"""N m at the joint, through the gear."""

ARMATURE = 0.01
"""kg m² of motor and gear, at the joint."""

COULOMB, VISCOUS = 0.05, 0.02
"""N m, N m s."""

POSITION_GAIN = 20.0
"""1/s, ODrive's default."""

VELOCITY_GAIN, INTEGRATOR_GAIN = 5.0, 50.0
"""N m s, N m: stiffer than ODrive's defaults, which nobody leaves as they are."""


class Control(IntEnum):
    """ODrive's control modes that are known here."""

    VELOCITY = 2
    POSITION = 3


class Shape(IntEnum):
    """ODrive's input modes that are known here."""

    PASSTHROUGH = 1
    TRAPEZOID = 5


@dataclass(slots=True)
class Settings:
    """What was last asked, in rad, rad/s, rad/s² and A of the joint."""

    control: int = Control.POSITION
    shape: int = Shape.PASSTHROUGH
    position: float = 0.0
    velocity: float = 0.0
    trap_speed: float = 0.5
    trap_acceleration: float = 1.0
    velocity_limit: float = 10.0
    current_limit: float = 10.0


class Motor(Shaft):
    """A motor with what hangs on it. Positions in rad of the joint."""

    def __init__(self, link: Link, position: float) -> None:
        super().__init__(link, ARMATURE, COULOMB, position)
        self.current = 0.0
        """A, positive towards greater angles."""
        self.driven = False
        self.settings = Settings(position=position)
        self._goal = position
        self._rate = 0.0
        self._integrator = 0.0

    def drive(self, on: bool) -> None:
        """Close the loops, or let the motor go."""
        if on and not self.driven:
            self._integrator = 0.0
            self.hold_trajectory()
        self.driven = on

    def hold_trajectory(self) -> None:
        """Begin the next trajectory from where the motor is."""
        self._goal, self._rate = self.position, self.velocity

    def step(self, dt: float) -> None:
        """Advance by `dt` (s)."""
        torque = self._loops(dt) if self.driven else 0.0
        self.current = torque / TORQUE_PER_AMPERE
        self._turn(dt, torque, VISCOUS)

    def _loops(self, dt: float) -> float:
        """Torque, N m."""
        wished = self._shaped(dt)
        settings = self.settings
        error = max(-settings.velocity_limit, min(settings.velocity_limit, wished)) - self.velocity
        torque = VELOCITY_GAIN * error + self._integrator
        most = TORQUE_PER_AMPERE * settings.current_limit
        if abs(torque) > most:
            self._integrator *= 0.99  # as the firmware keeps it from winding up
            return copysign(most, torque)
        self._integrator += INTEGRATOR_GAIN * error * dt
        return torque

    def _shaped(self, dt: float) -> float:
        """The velocity that is wished, rad/s."""
        settings = self.settings
        if settings.control == Control.VELOCITY:
            return settings.velocity
        if settings.shape == Shape.TRAPEZOID:
            self._follow(dt)
        else:
            self._goal, self._rate = settings.position, settings.velocity
        return self._rate + POSITION_GAIN * (self._goal - self.position)

    def _follow(self, dt: float) -> None:
        """One step of the trapezoid."""
        settings = self.settings
        left = settings.position - self._goal
        change = settings.trap_acceleration * dt
        if abs(left) < 1e-5 and abs(self._rate) <= 2 * change:
            self._goal, self._rate = settings.position, 0.0
            return
        top = min(settings.trap_speed, math.sqrt(2 * settings.trap_acceleration * abs(left)))
        self._rate += max(-change, min(change, copysign(top, left) - self._rate))
        self._goal += self._rate * dt
