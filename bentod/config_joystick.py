"""The table of the config that says what the axes and buttons of a joystick ask for (thesis A.1.3)."""

from collections.abc import Collection, Iterator, Mapping
from typing import Annotated, Literal, Self, TypeAlias

from pydantic import BeforeValidator, Field, model_validator

from bentod.config_base import Name, Table
from bentod.config_tables import Chosen
from bentod.errors import nearest

MOST = 127
"""Greatest number of an axis or button."""

Number: TypeAlias = Annotated[int, Field(ge=0, le=MOST)]

Action: TypeAlias = Literal[
    "toggle", "toggle_back", "pause", "release", "torque", "home", "stop", "own_pause", "mark"
]

NEEDS: Mapping[str, Collection[str]] = {"toggle": ("group",), "toggle_back": ("group",), "mark": ("mark",)}
"""Keys that an action cannot do without."""

TAKES: Mapping[str, Collection[str]] = {
    **NEEDS,
    "pause": ("group", "joint"),
    "release": ("group", "joint"),
    "torque": ("group", "joint", "on"),
    "home": ("group", "joint"),
}
"""Keys besides `button` and `action` that an action understands."""


def _button_or_false(value: object) -> object:
    if value is False or (isinstance(value, int) and value is not True and 0 <= value <= MOST):
        return value
    raise ValueError(
        f"{value!r} must be the number of a button, 0 to {MOST}, or false for none (then axes move at once)"
    )


class Axis(Table):
    """One axis, and the group or joint that it drives."""

    axis: Number
    group: Name | None = None
    joint: Name | None = None
    dead_zone: Annotated[float, Field(ge=0, le=0.9)] = 0.15
    """Share of its way, from the middle, in which it asks for nothing."""
    expo: Annotated[float, Field(ge=0, le=1)] = 0.0
    """0: effort grows with the way beyond the dead zone; 1: with its third power, finer around the middle."""
    invert: bool = False
    one_sided: bool = False
    """It rests at its lower end, as triggers do, and asks one way only."""
    max: Annotated[float, Field(gt=0, le=1)] = 1.0
    """Share of the joint's top speed at its end."""

    @model_validator(mode="after")
    def _one_target(self) -> Self:
        if (self.group is None) is (self.joint is None):
            raise ValueError("give a group or a joint, one of both")
        return self


class Button(Table):
    """One button, and what a press of it does."""

    button: Number
    action: Action
    group: Name | None = None
    joint: Name | None = None
    on: bool = True
    """For `torque`: false makes limp."""
    mark: Annotated[str, Field(max_length=64)] = ""

    @model_validator(mode="after")
    def _complete(self) -> Self:
        given = {key for key in ("group", "joint", "mark") if getattr(self, key)}
        given |= {"on"} if not self.on else set()
        takes = TAKES.get(self.action, ())
        problems = [
            f"action '{self.action}' needs {key}" for key in NEEDS.get(self.action, ()) if key not in given
        ]
        problems += [f"action '{self.action}' takes no {key}" for key in sorted(given) if key not in takes]
        if {"group", "joint"} <= given:
            problems.append("give a group or a joint, not both")
        if problems:
            raise ValueError("\n".join(problems))
        return self


class Joystick(Table):
    """A joystick or gamepad at the machine on which the daemon runs."""

    source: Chosen
    dead_man: Annotated[int | Literal[False], BeforeValidator(_button_or_false)]
    """The button that must be held for any axis to move anything; false must be said."""
    still_s: Annotated[float, Field(ge=0.2, le=60)] = 4.0
    """A pad that asks for motion and of which nothing changes for so long is taken to be out of reach."""
    axes: Annotated[tuple[Axis, ...], Field(max_length=32)] = ()
    buttons: Annotated[tuple[Button, ...], Field(max_length=64)] = ()

    @property
    def dead_man_button(self) -> int | None:
        """Its number; None: none is wanted."""
        return None if self.dead_man is False else self.dead_man

    @model_validator(mode="after")
    def _once(self) -> Self:
        axes = [axis.axis for axis in self.axes]
        buttons = [button.button for button in self.buttons]
        problems = [f"axis {n} stands {axes.count(n)} times" for n in sorted({*axes}) if axes.count(n) > 1]
        problems += [
            f"button {n} stands {buttons.count(n)} times" for n in sorted({*buttons}) if buttons.count(n) > 1
        ]
        if self.dead_man_button in buttons:
            problems.append(f"dead_man = {self.dead_man}: the same button has an action, too")
        if problems:
            raise ValueError("\n".join(problems))
        return self

    def strangers(self, joints: Collection[str], groups: Collection[str]) -> Iterator[str]:
        """A sentence for each name that is no joint's or group's of the arm."""
        tables: list[tuple[str, Axis | Button]] = [
            *((f"joystick.axes.{i}", axis) for i, axis in enumerate(self.axes)),
            *((f"joystick.buttons.{i}", button) for i, button in enumerate(self.buttons)),
        ]
        for where, table in tables:
            for kind, name, known in (("group", table.group, groups), ("joint", table.joint, joints)):
                if name is not None and name not in known:
                    yield f"{where}.{kind}: there is no {kind} '{name}'{nearest(name, known)}"
