"""A task's file: TOML in, a task out, every mistake at once."""

import tomllib
from collections.abc import Iterable
from itertools import pairwise
from typing import Annotated, Literal, Self, TypeAlias

from pydantic import Field, ValidationError, model_validator

from bentod.config_base import Name, Table
from bentod.config_errors import explain
from bentod.errors import ConfigError, nearest
from bentod.tasks.corridor import Corridor
from bentod.tasks.places import Barrier, Place, Spot
from bentod.tasks.task import Path, Task

Angle: TypeAlias = Annotated[float, Field(ge=-6.3, le=6.3)]
Small: TypeAlias = Annotated[float, Field(ge=0.001, le=1.0)]
Label: TypeAlias = Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9 _-]{0,15}$")]
"""Short, because it stands in the place and in a mark."""


class Common(Table):
    """What every task says."""

    title: Annotated[str, Field(min_length=1, max_length=64)]
    joints: tuple[Name, Name]
    """The joint that goes across the screen, and the one that goes up."""
    bounds_rad: tuple[tuple[Angle, Angle], tuple[Angle, Angle]]
    """Lowest and highest angle of either joint: what the task needs of the arm."""
    dwell_s: Annotated[float, Field(ge=0, le=60)]
    leaving: Literal["restarts", "goes_on"] = "goes_on"
    """What becomes of the time at a place when one leaves it too early."""

    @model_validator(mode="after")
    def _sensible(self) -> Self:
        problems = []
        if self.joints[0] == self.joints[1]:
            problems.append(f"joints: '{self.joints[0]}' cannot go across and up at once")
        for joint, (low, high) in zip(self.joints, self.bounds_rad, strict=True):
            if not low < high:
                problems.append(f"bounds_rad: those of {joint}, {low} and {high}, must rise")
        if problems:
            raise ValueError("\n".join(problems))
        return self

    def outside(self, named: Iterable[tuple[str, tuple[float, float]]]) -> list[str]:
        """A line for each of these points (rad) that is not within the bounds."""
        return [
            f"{name} = {value} of {joint} is outside bounds_rad ({low} to {high})"
            for name, point in named
            for joint, value, (low, high) in zip(self.joints, point, self.bounds_rad, strict=True)
            if not low <= value <= high
        ]


class Waypoint(Table):
    """One of them."""

    name: Label
    at_rad: tuple[Angle, Angle]


class Waypoints(Common):
    """Places to go to and to hold (thesis 5.4)."""

    kind: Literal["waypoints"]
    tolerance_rad: Small
    order: Annotated[tuple[Label, ...], Field(min_length=3, max_length=50)]
    """One circuit; it ends where it begins."""
    path: Path = "any"
    waypoints: Annotated[tuple[Waypoint, ...], Field(min_length=2, max_length=20)]

    @model_validator(mode="after")
    def _circuit(self) -> Self:
        names = [point.name for point in self.waypoints]
        problems = [
            f"waypoints: there are two called '{n}'" for n in sorted(set(names)) if names.count(n) > 1
        ]
        problems += [
            f"order: there is no way point '{n}'{nearest(n, names)}" for n in self.order if n not in names
        ]
        problems += [f"order: '{one}' comes twice running" for one, two in pairwise(self.order) if one == two]
        if self.order[0] != self.order[-1]:
            problems.append(
                f"order: it begins at '{self.order[0]}' and must end there, not at '{self.order[-1]}'"
            )
        problems += self.outside((f"waypoint '{point.name}'", point.at_rad) for point in self.waypoints)
        if problems:
            raise ValueError("\n".join(problems))
        return self

    def task(self, name: str) -> Task:
        """The task of that name."""
        names = [point.name for point in self.waypoints]
        return Task(
            name=name,
            title=self.title,
            joints=self.joints,
            bounds=self.bounds_rad,
            places=tuple(Spot(point.name, point.at_rad, self.tolerance_rad) for point in self.waypoints),
            order=tuple(names.index(place) for place in self.order),
            dwell=self.dwell_s,
            restart=self.leaving == "restarts",
            path=self.path,
            counts="held",
        )


class Maze(Common):
    """A corridor between two barriers, and walls that are not to be touched (thesis 5.5)."""

    kind: Literal["maze"]
    barriers: tuple[Label, Label] = ("green", "yellow")
    """Where a circuit begins, and where it turns round."""
    centre_rad: Annotated[tuple[tuple[Angle, Angle], ...], Field(min_length=2, max_length=50)]
    """The corridor's middle from the first barrier to the second."""
    half_width_rad: Small
    exposed_rad: Small
    """To either side of a barrier's middle: where it is felt."""
    felt_rad: Annotated[float, Field(ge=0, le=0.1)] = 0.0
    """Before a barrier: where it is felt already."""
    bounce_s: Annotated[float, Field(ge=0, le=5)] = 0.3
    """Without a touch, after which the next one is another contact."""

    @model_validator(mode="after")
    def _corridor(self) -> Self:
        problems = [
            f"centre_rad: {list(one)} comes twice running"
            for one, two in pairwise(self.centre_rad)
            if one == two
        ]
        if self.barriers[0] == self.barriers[1]:
            problems.append(f"barriers: both are called '{self.barriers[0]}'")
        if self.exposed_rad > self.half_width_rad:
            problems.append(
                f"exposed_rad = {self.exposed_rad} must be at most half_width_rad = {self.half_width_rad}"
            )
        problems += self.outside(("centre_rad", point) for point in self.centre_rad)
        if problems:
            raise ValueError("\n".join(problems))
        return self

    def task(self, name: str) -> Task:
        """The task of that name."""
        centre = self.centre_rad
        ends = ((centre[0], centre[1]), (centre[-1], centre[-2]))
        places: tuple[Place, ...] = tuple(
            Barrier(label, end, inwards, self.exposed_rad, self.felt_rad)
            for label, (end, inwards) in zip(self.barriers, ends, strict=True)
        )
        return Task(
            name=name,
            title=self.title,
            joints=self.joints,
            bounds=self.bounds_rad,
            places=places,
            order=(0, 1, 0),
            dwell=self.dwell_s,
            restart=self.leaving == "restarts",
            path="any",
            counts="entered",
            corridor=Corridor(centre, self.half_width_rad),
            bounce=self.bounce_s,
        )


KINDS: dict[str, type[Waypoints | Maze]] = {"waypoints": Waypoints, "maze": Maze}


def parse(text: str, name: str, source: str) -> Task:
    """The task `name` that `text` describes; `source` names the file in errors.

    Raises:
        ConfigError: one line for every mistake, each with file, key, value and bound.
    """
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise ConfigError(f"{source}: not valid TOML: {error}") from error
    kind = data.get("kind")
    model = KINDS.get(kind) if isinstance(kind, str) else None
    if model is None:
        raise ConfigError(f"{source}: kind = {kind!r}: there is no such kind{nearest(str(kind), KINDS)}")
    try:
        return model.model_validate(data).task(name)
    except ValidationError as error:
        raise ConfigError("\n".join(f"{source}: {line}" for line in explain(error, model))) from error
