"""Experiment 1 of the thesis (5.4): way points in the plane of two joints, each to be held for three seconds.

The order, 1-2-3-2-1, the tolerance of 1 degree and the 3 s are the thesis'. Where the points lie shows only
in a figure without numbers: here a circuit is as long as makes 29 of them take about 11 minutes.
"""

from dataclasses import dataclass, field
from math import radians

from sim.people.scene import Point, Way, moved

TOLERANCE = radians(1.0)
DWELL = 3.0
"""s"""

ONE, TWO, THREE = (-0.13, 0.0), (0.13, 0.26), (0.13, 0.52)
LEGS = (TWO, THREE, TWO, ONE)
FIRST = (1, 1, 1, 1)
"""By leg, the joint that goes first: up then right, up, down, down then left."""

LIMITS = ((-0.23, 0.23), (-0.10, 0.62))
"""rad, by joint: the workspace by a small margin."""


@dataclass(slots=True)
class Waypoints:
    """The circuit, as it is and as it is seen on the screen of Fig. 5.3."""

    name: str = "waypoints"
    start: Point = ONE
    limits: tuple[tuple[float, float], tuple[float, float]] = LIMITS
    leg: int = 0
    resting: bool = False
    touching: bool = False
    pressing: bool = False
    contacts: int = 0
    circuits: int = 0
    _until: float = field(default=0.0)

    def step(self, time: float, position: Point) -> bool:
        """Take in where the arm is at `time` (s); whether a circuit ends with that."""
        if self.resting:
            return time >= self._until and self._next()
        target = LEGS[self.leg]
        if all(abs(a - b) <= TOLERANCE for a, b in zip(position, target, strict=True)):
            self.resting, self._until = True, time + DWELL
        return False

    def resume(self) -> None:
        """See `Task`; the first leg begins at once."""

    def value(self, position: Point, margin: float) -> float:
        """See `Course`: there are no walls, and so `margin` means nothing."""
        target = LEGS[self.leg]
        return -abs(target[0] - position[0]) - abs(target[1] - position[1])

    def way(self, position: Point, joint: int, drift: float, margin: float) -> Way:
        """See `Course`: straight to the target's angle, one joint after the other in the order of the leg."""
        first, target = FIRST[self.leg], LEGS[self.leg]
        distance = target[joint] - position[joint]
        pending = abs(target[first] - position[first]) > TOLERANCE
        if (joint != first and pending) or abs(distance) <= 0.6 * TOLERANCE:
            return Way(0.0, 0.0)
        there = moved(position, joint, distance, drift * abs(distance))
        return Way(distance, max(abs(distance), self.value(there, margin) - self.value(position, margin)))

    def place(self, position: Point) -> int:
        """See `Course`: which leg, and which half of it."""
        left = -self.value(position, 0.0)
        return 2 * self.leg + (left < 0.13)

    def _next(self) -> bool:
        self.resting = False
        self.leg = (self.leg + 1) % len(LEGS)
        self.circuits += self.leg == 0
        return self.leg == 0
