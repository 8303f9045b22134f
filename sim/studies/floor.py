"""A floor of differently coloured sectors around a spot, and round objects standing on it."""

import math
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass

TURN = 2 * math.pi

BEIGE_TILE = 0.72
BLACK_TILE = 0.10
BLACK_TAPE = 0.05
BLUE_TAPE = 0.28
"""Share of the infrared light that each surface throws back: estimates, not measurements."""


@dataclass(frozen=True, slots=True)
class Sector:
    """A piece of the floor, up to where the next begins."""

    start: float  # rad, counter-clockwise from x, 0..2π
    reflectance: float  # 0..1


@dataclass(frozen=True, slots=True)
class Post:
    """A round object."""

    x: float  # m
    y: float  # m
    radius: float  # m

    def distance(self, x: float, y: float, heading: float) -> float:
        """m, from (x, y) in the direction `heading` (rad); infinite if that way misses the object."""
        ahead = (self.x - x) * math.cos(heading) + (self.y - y) * math.sin(heading)
        aside = (self.y - y) * math.cos(heading) - (self.x - x) * math.sin(heading)
        if ahead <= 0 or abs(aside) >= self.radius:
            return math.inf
        return ahead - math.sqrt(self.radius**2 - aside**2)


def post(bearing_deg: float, distance: float, radius: float) -> Post:
    """A post whose middle is `distance` (m) from the origin."""
    bearing = math.radians(bearing_deg)
    return Post(distance * math.cos(bearing), distance * math.sin(bearing), radius)


class Floor:
    """Sectors that meet at the origin, the first of which begins at 0, and what stands around."""

    def __init__(self, sectors: Sequence[Sector], posts: Sequence[Post]) -> None:
        starts = [sector.start for sector in sectors]
        if not starts or starts[0] != 0 or sorted(set(starts)) != starts or starts[-1] >= TURN:
            raise ValueError(f"Sectors must begin at 0 and then ever later, below 2π, not at {starts}.")
        self._starts = starts
        self._ends = [*starts[1:], TURN]
        self._reflectances = [sector.reflectance for sector in sectors]
        self._posts = tuple(posts)

    def under(self, x: float, y: float, spot: float) -> float:
        """Mean reflectance of a spot `spot` (m) wide around (x, y)."""
        bearing, radius, half = math.atan2(y, x) % TURN, math.hypot(x, y), spot / 2
        at = bisect_right(self._starts, bearing) - 1
        here = self._reflectances[at]
        after_border = (bearing - self._starts[at]) * radius
        before_border = (self._ends[at] - bearing) * radius
        if after_border < half:
            return here + (half - after_border) / spot * (self._reflectances[at - 1] - here)
        if before_border < half:
            following = self._reflectances[(at + 1) % len(self._starts)]
            return here + (half - before_border) / spot * (following - here)
        return here

    def range(self, x: float, y: float, heading: float) -> float:
        """m, to the nearest object in that direction; infinite if there is none."""
        return min((post.distance(x, y, heading) for post in self._posts), default=math.inf)


def thesis_floor() -> Floor:
    """Black tape, blue tape, beige tiles, black tiles and some objects (thesis 4.5.1), placed by us."""
    edges = (
        (0, BEIGE_TILE),
        (22, BLACK_TAPE),
        (42, BEIGE_TILE),
        (78, BLUE_TAPE),
        (98, BEIGE_TILE),
        (150, BLACK_TILE),
        (228, BEIGE_TILE),
        (268, BLACK_TAPE),
        (288, BEIGE_TILE),
        (316, BLUE_TAPE),
        (336, BEIGE_TILE),
    )
    sectors = [Sector(math.radians(start), reflectance) for start, reflectance in edges]
    return Floor(sectors, [post(60, 0.27, 0.05), post(190, 0.30, 0.07), post(305, 0.26, 0.04)])
