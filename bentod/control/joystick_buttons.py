"""From the buttons of a joystick to what is to be done: each press once, and what needs the dead man held."""

from collections.abc import Sequence
from dataclasses import dataclass

from bentod.config_joystick import Button
from bentod.contracts import Pad

RESTRAINT = frozenset({"stop", "pause", "own_pause"})
"""Always heard: in the own pause, before the pad was seen at rest, and after the daemon was held up."""

PERMITS = frozenset({"release", "torque", "home"})
"""What may set the arm in motion, and so needs the dead man held as any motion does."""


@dataclass(frozen=True, slots=True)
class Presses:
    """What was pressed since the last look, in the order of the config."""

    heard: tuple[Button, ...] = ()
    unheld: tuple[Button, ...] = ()  # not done, because the dead man's button was not held


class Buttons:
    """Counts presses. A button that bounces, or is pressed twice in one tick, was pressed once.

    A button that is held while the pad is opened is no press, since the pad does not count it.
    """

    def __init__(self, buttons: Sequence[Button]) -> None:
        self._buttons = tuple(buttons)
        self._opening = 0
        self._before: tuple[int, ...] = ()

    def step(self, pad: Pad, held: bool, hushed: bool) -> Presses:
        """Look at a pad that is there; `held`: the dead man's button; `hushed`: only restraint counts."""
        before = self._before if pad.openings == self._opening else (0,) * len(pad.presses)
        self._opening, self._before = pad.openings, pad.presses
        pressed = [button for button in self._buttons if _count(pad.presses, button) > _count(before, button)]
        pressed = [button for button in pressed if button.action in RESTRAINT or not hushed]
        unheld = [button for button in pressed if button.action in PERMITS and not held]
        return Presses(tuple(one for one in pressed if one not in unheld), tuple(unheld))


def _count(presses: Sequence[int], button: Button) -> int:
    return presses[button.button] if button.button < len(presses) else 0
