"""What hangs on a servo's output shaft, and how it moves under torque, gravity and friction."""

from dataclasses import dataclass
from math import copysign, inf, pi, sin

GRASP = 40.0
"""N m/rad, of a hand that leads it: assumed, as stiff as to overcome friction and gravity within 0.1 rad."""

GRASP_DAMPING = 2.0
"""N m s/rad, of the same hand: assumed, so that it does not swing."""


@dataclass(frozen=True, slots=True)
class Link:
    """What hangs on the output shaft."""

    gravity: float = 0.0  # N m when it points sideways
    rest: float = 0.0  # rad, where it hangs still
    inertia: float = 0.0  # kg m², without the servo's own armature
    low: float = -pi  # rad, hard stop
    high: float = pi  # rad, hard stop


@dataclass(slots=True)
class Stand:
    """What keeps an arm where it is until one of its joints is first driven; then it is taken away."""

    there: bool = False


class Shaft:
    """A turning mass. Positions in rad, 0 at the centre, counter-clockwise positive."""

    def __init__(self, link: Link, armature: float, coulomb: float, position: float) -> None:
        """`armature`: kg m² of the motor; `coulomb`: N m of friction; `position`: rad."""
        self.link = link
        self.position = position
        self.velocity = 0.0
        self.stuck = False
        self.stand = Stand()
        self.obstacle = inf
        """rad: it gets no farther than this, as fingers do around an object."""
        self.guided: float | None = None
        """rad, to where a person's hand leads it; None: nobody holds it."""
        self._inertia = armature + link.inertia
        self._coulomb = coulomb

    def block(self, on: bool) -> None:
        """Put an obstacle right before it, on the side of its maximum, or take it away."""
        self.obstacle = self.position if on else inf

    def _turn(self, dt: float, torque: float, damping: float) -> None:
        """Newton, friction implicit: (J + d·dt)·ω' + c·dt·sign ω' = J·ω + τ·dt; within c it sticks."""
        link = self.link
        if link.gravity:
            torque += link.gravity * sin(link.rest - self.position)
        if self.guided is not None:
            torque += GRASP * (self.guided - self.position)
            damping += GRASP_DAMPING
        momentum = self._inertia * self.velocity + dt * torque
        grip = dt * self._coulomb
        if self.stuck or self.stand.there or -grip <= momentum <= grip:
            self.velocity = 0.0
            return
        momentum -= copysign(grip, momentum)
        self.velocity = momentum / (self._inertia + dt * damping)
        position = self.position + dt * self.velocity
        if position < link.low or position > link.high or position > self.obstacle:
            position = min(max(position, link.low), link.high, self.obstacle)
            self.velocity = 0.0
        self.position = position
