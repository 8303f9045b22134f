"""Where one is to go: a spot around a pair of angles, or a barrier across the end of a corridor."""

from dataclasses import dataclass
from math import hypot
from typing import TypeAlias

from bentod.tasks.corridor import Point


@dataclass(frozen=True, slots=True)
class Spot:
    """A way point (thesis 5.4): one is there when both joints are within the tolerance."""

    name: str
    centre: Point  # rad
    tolerance: float  # rad, of each joint

    def holds(self, position: Point) -> bool:
        """Whether `position` (rad) is in it."""
        return all(abs(a - b) <= self.tolerance for a, b in zip(position, self.centre, strict=True))


@dataclass(frozen=True, slots=True)
class Barrier:
    """The end of a corridor (thesis 5.5): what lies before it is the corridor, and its middle is felt."""

    name: str
    centre: Point  # rad
    inwards: Point  # rad, another point of the corridor's centre line
    exposed: float  # rad to either side of the middle
    felt: float  # rad before it

    def holds(self, position: Point) -> bool:
        """Whether `position` (rad) is at its middle, or behind that."""
        dx, dy = self.centre[0] - self.inwards[0], self.centre[1] - self.inwards[1]
        length = hypot(dx, dy)
        x, y = position[0] - self.centre[0], position[1] - self.centre[1]
        beyond, aside = (x * dx + y * dy) / length, (y * dx - x * dy) / length
        return beyond >= -self.felt and abs(aside) <= self.exposed


Place: TypeAlias = Spot | Barrier
