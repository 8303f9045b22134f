"""What a simulated operator is shown, what they can do about it, and what they know of the task."""

from dataclasses import dataclass
from typing import Protocol, TypeAlias

Point: TypeAlias = tuple[float, float]
"""Angles of the two joints that a task is about (rad)."""


@dataclass(frozen=True, slots=True)
class View:
    """One moment of the arm and of the task, as it truly is: senses make it late and imprecise."""

    time: float  # monotonic s
    position: Point  # rad
    active: int  # which of the two joints the operator drives, 0 or 1
    toggles: int  # since the start; each is followed by a voice that says the joint's name
    resting: bool  # between a target's first sound and its second
    touching: bool  # the rod touches a wall
    leg: int  # of the circuit, from 0
    assisted: bool  # the operator was told that the arm may help
    pressing: bool = False  # it touches so hard that it bends


@dataclass(frozen=True, slots=True)
class Act:
    """What the operator does in one tick."""

    effort: float = 0.0  # -1..1, of the joystick or of the pair of muscles
    toggle: bool = False  # the button goes down, or the other forearm contracts


@dataclass(frozen=True, slots=True)
class Way:
    """How far one joint should go from where it is, and what that is worth."""

    distance: float  # rad, signed; 0: it should stay
    gain: float  # rad of progress, 0 or more
    back: bool = False  # it is only worth something because it leads away from a wall


class Course(Protocol):
    """What somebody who looks at the task knows of the leg under way. Nothing here knows of any assist."""

    def value(self, position: Point, margin: float) -> float:
        """How far one has come (rad), less what it costs to be nearer to a wall than `margin` (rad)."""
        ...

    def way(self, position: Point, joint: int, drift: float, margin: float) -> Way:
        """The best way for `joint`, if the other joint moves `drift` rad for each rad of it, either way."""
        ...

    def place(self, position: Point) -> int:
        """A coarse name of where on the circuit this is, as one remembers places."""
        ...


def moved(position: Point, joint: int, by: float, other: float = 0.0) -> Point:
    """`position` with `joint` moved `by` rad and the other joint by `other` rad."""
    first, second = position
    return (first + by, second + other) if joint == 0 else (first + other, second + by)
