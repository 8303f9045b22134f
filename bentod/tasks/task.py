"""A task as data: two joints, the places that a circuit leads to, and perhaps walls on the way."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, TypeAlias

from bentod.errors import nearest
from bentod.tasks.corridor import Corridor, Point
from bentod.tasks.places import Place

Range: TypeAlias = tuple[float, float]
"""Lowest and highest angle (rad)."""

Path: TypeAlias = Literal["any", "across_first", "up_first"]
"""How people are asked to go from place to place: as they like, or with one joint after the other."""


@dataclass(frozen=True, slots=True)
class Task:
    """One task. `order`: a circuit, as indices of places, from its start and back there."""

    name: str
    title: str
    joints: tuple[str, str]  # the one that goes across, the one that goes up
    bounds: tuple[Range, Range]  # rad, by joint
    places: tuple[Place, ...]
    order: tuple[int, ...]
    dwell: float  # s that a place is to be held
    restart: bool  # who leaves a place too early has to hold it anew; otherwise time goes on
    path: Path
    counts: Literal["held", "entered"]  # what ends a circuit: its last place is held, or only reached
    corridor: Corridor | None = None
    bounce: float = 0.0  # s without a touch, after which the next one is another contact

    def __post_init__(self) -> None:
        """A circuit needs a start and somewhere to go."""
        if len(self.order) < 3:
            raise ValueError(f"a circuit of {len(self.order)} places leads nowhere, 3 is the least")

    @property
    def kind(self) -> Literal["waypoints", "maze"]:
        """Which of the thesis' two it is like."""
        return "maze" if self.corridor else "waypoints"

    @property
    def start(self) -> Place:
        """Where a circuit begins and ends."""
        return self.places[self.order[0]]

    def clearance(self, position: Point) -> float:
        """How far (rad) it is to the nearest wall, negative behind it; infinite without walls."""
        return self.corridor.clearance(position) if self.corridor else float("inf")


def misfits(task: Task, limits: Mapping[str, Range]) -> list[str]:
    """Why an arm cannot do a task; empty if it can. `limits`: lowest and highest angle (rad) by joint."""
    found = []
    for joint, (low, high) in zip(task.joints, task.bounds, strict=True):
        if joint not in limits:
            found.append(f"the arm has no joint '{joint}'{nearest(joint, limits)}")
            continue
        lowest, highest = limits[joint]
        if low < lowest or high > highest:
            found.append(
                f"{joint} would go from {low:+.3f} to {high:+.3f} rad, "
                f"and its limits are {lowest:+.3f} and {highest:+.3f} rad"
            )
    return found
