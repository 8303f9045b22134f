"""A corridor in the plane of two joints: a centre line, and how far a position is along it and off it."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import hypot
from typing import TypeAlias

Point: TypeAlias = tuple[float, float]
"""Angles of the two joints of a task (rad): across, and up."""


@dataclass(frozen=True, slots=True)
class Corridor:
    """All within `half_width` (rad) of `centre`, whose ends go on as far again as their pieces are long."""

    centre: tuple[Point, ...]  # rad, two points or more
    half_width: float  # rad

    def along(self, position: Point) -> tuple[float, float, float]:
        """How far (rad) `position` is along the centre line, how far off it, and how long the line is."""
        return measured(self.centre, position)

    def clearance(self, position: Point) -> float:
        """How far (rad) it is to the nearest wall; negative behind it."""
        return self.half_width - self.along(position)[1]


def measured(centre: Sequence[Point], position: Point) -> tuple[float, float, float]:
    """See `Corridor.along`: the piece of the line that is nearest counts, the first of equals."""
    x, y = position
    nearest, along, before = 1e9, 0.0, 0.0
    for i, ((ax, ay), (bx, by)) in enumerate(pairwise(centre)):
        dx, dy = bx - ax, by - ay
        length = hypot(dx, dy)
        share = ((x - ax) * dx + (y - ay) * dy) / (length * length)
        low, high = (-1.0 if i == 0 else 0.0), (2.0 if i == len(centre) - 2 else 1.0)
        share = min(max(share, low), high)
        off = hypot(x - ax - share * dx, y - ay - share * dy)
        if off < nearest:
            nearest, along = off, before + share * length
        before += length
    return along, nearest, before
