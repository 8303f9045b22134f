"""From the axes of a joystick to efforts: dead zone, expo, direction, and the dead man's button."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from bentod.config_joystick import Axis
from bentod.contracts import Pad


def shaped(value: float, axis: Axis) -> float:
    """The effort, -1..1, of an axis at `value` (-1..1); what is no number asks for nothing.

    With the dead zone d and the expo e: x = (|value| - d) / (1 - d), and the effort is
    ((1 - e) x + e x³) times the axis' share of the speed.
    """
    if not math.isfinite(value):
        return 0.0
    level = max(-1.0, min(1.0, (value + 1) / 2 if axis.one_sided else value))
    beyond = (abs(level) - axis.dead_zone) / (1 - axis.dead_zone)
    if beyond <= 0:
        return 0.0
    effort = ((1 - axis.expo) * beyond + axis.expo * beyond**3) * axis.max
    return effort if (level > 0) is not axis.invert else -effort


def at_rest(value: float, axis: Axis) -> bool:
    """Whether an axis is in its dead zone; what is no number is not."""
    return math.isfinite(value) and shaped(value, axis) == 0


@dataclass(frozen=True, slots=True)
class Sight:
    """What axes show in one tick, in the order of the config."""

    shaped: tuple[float, ...]  # -1..1
    asked: tuple[float, ...]  # the same of those that may move something, 0 of others
    held: bool  # the dead man's button, true where none is wanted


class Sticks:
    """Which axes may move something.

    At first, and after `reset`, all must be seen at rest at once, the dead man's button let go. From then on
    an axis moves something while that button is held, once it has been seen at rest since it was pressed: a
    stick that is wedged moves nothing, whatever is pressed.
    """

    def __init__(self, axes: Sequence[Axis], dead_man: int | None) -> None:
        self._axes = tuple(axes)
        self._dead_man = dead_man
        self._free: set[int] = set()
        self.waiting = True
        """Whether all must still be seen at rest."""

    def reset(self) -> None:
        """Nothing moves any more until all have been seen at rest."""
        self._free.clear()
        self.waiting = True

    def step(self, pad: Pad) -> Sight:
        """Look at `pad`, which has all axes and the button."""
        values = [pad.axes[axis.axis] for axis in self._axes]
        pairs = list(zip(values, self._axes, strict=True))
        resting = {place for place, pair in enumerate(pairs) if at_rest(*pair)}
        held = self._dead_man is None or pad.buttons[self._dead_man]
        if len(resting) == len(pairs) and not (held and self._dead_man is not None):
            self.waiting = False
        self._free |= resting
        self._free -= {place for place, value in enumerate(values) if not math.isfinite(value)}
        if self.waiting or not held:
            self._free.clear()
        efforts = tuple(shaped(*pair) for pair in pairs)
        asked = tuple(effort if place in self._free else 0.0 for place, effort in enumerate(efforts))
        return Sight(efforts, asked, held)

    def missing(self, pad: Pad) -> str:
        """What of the config the pad does not have, as a sentence; empty if it has all."""
        for axis in self._axes:
            if axis.axis >= len(pad.axes):
                return f"The joystick has no axis {axis.axis}, which the config names."
        if self._dead_man is not None and self._dead_man >= len(pad.buttons):
            return f"The joystick has no button {self._dead_man}, the dead man's of the config."
        return ""
