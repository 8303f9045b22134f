"""From a joystick to what its user asks: efforts of groups and joints, toggles, and what buttons do."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from bentod.config_joystick import Button
from bentod.config_joystick import Joystick as Table
from bentod.contracts import JoystickSource, Pad
from bentod.control.joystick_axes import Sight, Sticks
from bentod.control.joystick_buttons import Buttons, Presses
from bentod.control.operators import Asked
from bentod.frames import Value
from bentod.joystick_frame import JoystickFrame

SILENT = 0.1
"""s after the last sign of life of a pad's driver, from which on it is not believed."""

TOGGLES = {"toggle": 1, "toggle_back": -1, "own_pause": 0}
"""Actions that are nothing that a client could ask: steps of a group, and none."""


@dataclass(frozen=True, slots=True)
class Push:
    """What the joystick asks in one tick."""

    asked: Asked  # of groups
    joints: Asked  # of joints by name: its efforts are by joint
    pressed: tuple[Button, ...] = ()  # what is to be done at once, as if a client had asked
    home: Button | None = None  # by which joints were sent home, as long as somebody holds on


class Joystick:
    """A joystick as the controller sees it.

    A pad that is new, was lost or cannot be believed, or whose own pause ends, must be seen at rest with the
    dead man's button let go before it moves anything.
    """

    def __init__(self, table: Table, source: JoystickSource | None = None) -> None:
        """`source`: None where there is nobody, as in a replay."""
        self.paused = False
        self.tell: Callable[[str, Mapping[str, Value]], None] = lambda *_: None
        """Told of what comes and goes: a sentence and its data."""
        self._table = table
        self._source = source
        self._sticks = Sticks(table.axes, table.dead_man_button)
        self._buttons = Buttons(table.buttons)
        self._openings = 0
        self._home: Button | None = None
        self._told: str | None = None
        self.frame = JoystickFrame(False, False, "The joystick has not been looked at yet.", False, {})
        """What it asked at the last look."""

    def look(self, now: float, held_up: bool = False) -> Push:
        """What is asked now (monotonic s); `held_up`: presses and pushes may be old ones."""
        pad = self._latest()
        old = held_up or bool(self._told)  # nor does anybody know when it was that somebody pressed meanwhile
        problem = _absent(pad, now)
        self._notice(problem)
        if problem:
            return self._nothing(pad, problem)
        if pad.openings != self._openings or old:
            self._openings = pad.openings
            self._sticks.reset()
        problem = self._sticks.missing(pad) or _garbage(pad)
        if problem:
            self._sticks.reset()
            pressed = self._press(pad, held=False, hushed=True)
            return self._nothing(pad, problem, pressed.heard)
        return self._push(pad, now, old)

    def describe(self) -> Value:
        """The mapping and how things stand, as clients see them."""
        frame = self.frame
        return {
            "source": self._table.source.name,
            "dead_man": self._table.dead_man,
            "still_s": self._table.still_s,
            "axes": [axis.model_dump() for axis in self._table.axes],
            "buttons": [button.model_dump() for button in self._table.buttons],
            "connected": frame.connected,
            "problem": frame.problem,
            "paused": frame.paused,
            "held": frame.held,
        }

    def _push(self, pad: Pad, now: float, old: bool) -> Push:
        sight = self._sticks.step(pad)
        presses = self._press(pad, sight.held and not self._sticks.waiting, self.paused or old)
        for button in presses.unheld:
            why = self._waiting() or f"It needs button {self._table.dead_man} held."
            self.tell(f"not done: '{button.action}': {why}", {})
        if any(sight.asked) and now - pad.changed > self._table.still_s:
            self._sticks.reset()
            self.tell(f"let go: nothing of the joystick has changed for {self._table.still_s:g} s", {})
        self._home = self._homeward(pad, sight, presses)
        self.frame = self._framed(sight)
        steps = [(button.group or "", TOGGLES.get(button.action, 0)) for button in presses.heard]
        on, back = ([group for group, step in steps if step == way] for way in (1, -1))
        done = tuple(button for button in presses.heard if button.action not in TOGGLES)
        if self.paused or self._sticks.waiting:
            return Push(Asked({}, on, back), Asked({}), done, self._home)
        groups = self._together([axis.group for axis in self._table.axes], sight)
        joints = self._together([axis.joint for axis in self._table.axes], sight)
        return Push(Asked(groups.efforts, on, back, groups.tense), joints, done, self._home)

    def _press(self, pad: Pad, held: bool, hushed: bool) -> Presses:
        """What was pressed. The own pause acts here, and at once."""
        presses = self._buttons.step(pad, held, hushed)
        if any(button.action == "own_pause" for button in presses.heard):
            self.paused = not self.paused
            self._sticks.reset()
            self.tell(f"the joystick is {'paused' if self.paused else 'released'}", {"paused": self.paused})
        return presses

    def _homeward(self, pad: Pad, sight: Sight, presses: Presses) -> Button | None:
        """The button by which joints are on their way home, which goes on while somebody holds on."""
        pressed = [button for button in presses.heard if button.action == "home"]
        home = pressed[-1] if pressed else self._home
        if home is None or self.paused or self._sticks.waiting or not sight.held:
            return None
        return home if self._table.dead_man_button is not None or pad.buttons[home.button] else None

    def _together(self, targets: Sequence[str | None], sight: Sight) -> Asked:
        """Efforts by target: axes of one target add up. Whose axis is pushed in vain is not at rest."""
        efforts: dict[str, float] = {}
        tense = set()
        for target, asked, shaped in zip(targets, sight.asked, sight.shaped, strict=True):
            if target is None:
                continue
            efforts[target] = max(-1.0, min(1.0, efforts.get(target, 0.0) + asked))
            if shaped != asked:
                tense.add(target)
        return Asked(efforts, tense=tense)

    def _nothing(self, pad: Pad, problem: str, heard: Sequence[Button] = ()) -> Push:
        self._home = None
        self.frame = JoystickFrame(pad.connected, self.paused, problem, False, {})
        done = tuple(button for button in heard if button.action not in TOGGLES)
        return Push(Asked({}), Asked({}), done)

    def _framed(self, sight: Sight) -> JoystickFrame:
        numbers = [str(axis.axis) for axis in self._table.axes]
        axes = dict(zip(numbers, sight.shaped, strict=True))
        return JoystickFrame(True, self.paused, self._waiting(), sight.held, axes)

    def _waiting(self) -> str:
        if not self._sticks.waiting or self.paused:
            return ""
        button = self._table.dead_man_button
        also = "" if button is None else f" and button {button} was let go"
        return f"The joystick moves nothing until every axis was at rest{also}."

    def _latest(self) -> Pad:
        if self._source is None:
            return Pad(reason="Nobody looks at the joystick.")
        try:
            return self._source.latest()
        except Exception as error:  # noqa: BLE001 -- of a driver that may be a stranger's
            return Pad(reason=f"The joystick's driver broke: {type(error).__name__}: {error}.")

    def _notice(self, problem: str) -> None:
        """Say once that it came, or why it is not there."""
        if problem:
            self._sticks.reset()
        if problem != self._told:
            self._told = problem
            self.tell(problem or "the joystick is there", {"connected": not problem})


def _absent(pad: Pad, now: float) -> str:
    """Why nobody can say now (monotonic s) what is pushed; empty if somebody can."""
    if not pad.connected:
        return pad.reason or "The joystick is not connected."
    if not now - pad.seen <= SILENT:
        return f"The joystick's driver has given no sign of life for more than {SILENT:g} s."
    return ""


def _garbage(pad: Pad) -> str:
    bad = next((number for number, value in enumerate(pad.axes) if not math.isfinite(value)), None)
    return "" if bad is None else f"Axis {bad} of the joystick is not a finite number."
