"""What keys mean to the arm: each press becomes what is asked of the daemon. Pure; `watch` carries it out."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from bentod.cli.view_values import Table, entries, fields, text
from bentod.frames import Value

SURE = 2.0
"""s within which what is not done at once must be confirmed: by y, which no other key that is held can be."""

REPEAT = 0.25
"""s between two presses, below which a key is merely being held: terminals repeat it faster than that."""

BEGINS_TO_REPEAT = 0.75
"""s within which a key that is held repeats for the first time."""

JOG_EFFORT = 0.5
"""Share of the active joint's top speed that an arrow asks for."""

JOG_LEASE = 0.15
"""s that each event of an arrow key is good for; a held key comes again sooner."""

HOME_LEASE = 0.5
"""s; renewed every fifth of it."""

STOPS = ("s", "space", "escape")

HELP = (
    ("Space, s, Esc", "stop every joint at once, and pause"),
    ("p", "pause, or release (asks back)"),
    ("h", "go home; any key cancels"),
    ("← →", "move the active joint while held, at half speed"),
    ("Tab", "the group's next joint"),
    ("g", "the next group: the one that arrows and Tab are for"),
    ("t", "torque on, or off (asks back: the arm may fall)"),
    ("a", "assist off, and on again"),
    ("r", "record, or end the recording (asks back)"),
    ("m", "mark this moment"),
    ("?", "these keys; any key closes them, and does only that"),
    ("q", "leave; the arm goes on as it is"),
)


@dataclass(frozen=True, slots=True)
class Ask:
    """One request to the daemon."""

    method: str
    params: Mapping[str, Value] = field(default_factory=dict)


@dataclass(slots=True)
class Hands:
    """Whoever sits at the keyboard: what they look at, and what they have begun."""

    operator: bool = False
    """Whether they may do more than stop."""
    frame: Table | None = None
    """What they see; None while there is no daemon."""
    recording: bool = False
    homing: bool = False
    """Whether a homing is to be renewed."""
    help: bool = False
    quits: bool = False
    said: str = ""
    """The newest sentence for them."""
    _group: int = 0
    _unsure: tuple[Ask, float] | None = None  # what must be confirmed, and until when (monotonic s)
    _pressed: dict[str, float] = field(default_factory=dict)
    _closer: str = ""  # the key that closed the help; as long as it is held it does nothing else
    _goal: int | None = None
    _modes: dict[str, str] = field(default_factory=dict)  # of assists that were switched off, by group

    @property
    def group(self) -> str:
        """The group that arrows and Tab are for; empty if there is none."""
        names = [text(fields(group), "name") for group in entries(self.frame or {}, "groups")]
        return names[self._group % len(names)] if names else ""

    def press(self, key: str, now: float) -> list[Ask]:
        """What a key asks for (now: monotonic s)."""
        since = now - self._pressed.get(key, float("-inf"))
        self._pressed[key] = now
        unsure, self._unsure = self._unsure, None
        if key in STOPS:
            self.homing, self.help, self.said = False, False, "stop"
            return [Ask("stop")]
        if self._closes_help(key, since):
            return []
        if self.homing:
            self.quits = key == "q"
            return [] if key == "h" and since < BEGINS_TO_REPEAT else self._let_go()
        if key == "y" and unsure and now <= unsure[1]:
            self.said = ""
            return [unsure[0]]
        return self._act(key, now, since < REPEAT)

    def _act(self, key: str, now: float, held: bool) -> list[Ask]:
        if key in _LOOKING:
            _LOOKING[key](self)
        elif key in _ACTING:
            self.said = self._may_not()
            return [] if self.said else _ACTING[key](self, now, held)
        else:
            self.said = "nothing is to be confirmed" if key == "y" else "no such key: ? lists them"
        return []

    def _closes_help(self, key: str, since: float) -> bool:
        """Whether `key`, pressed `since` s after it was last, does no more than close what hides the arm."""
        held = key == self._closer and since < BEGINS_TO_REPEAT
        self._closer = key if self.help or held else ""
        self.help = False
        return self._closer != ""

    def see(self, frame: Table) -> None:
        """Look at a new frame."""
        self.frame = frame
        goal = fields(frame.get("goal"))
        if self.homing and goal.get("id") == self._goal and goal.get("status") in ("done", "cancelled"):
            self.homing = False
            self.said = f"homing {text(goal, 'status')}: {text(goal, 'reason')}".removesuffix(": ")

    def lose(self, why: str) -> None:
        """There is no daemon any more, and so nothing that was begun."""
        self.frame, self.homing, self.recording, self._unsure, self.said = None, False, False, None, why
        self.help = False

    def renewals(self) -> list[Ask]:
        """What must be asked again, so that it goes on."""
        return [Ask("go_home", {"lease_s": HOME_LEASE})] if self.homing else []

    def answered(self, ask: Ask, answer: Value) -> None:
        """What the daemon said to it."""
        if ask.method == "go_home":
            goal = fields(answer).get("goal")
            self._goal = goal if isinstance(goal, int) else None
        if ask.method in ("recording_start", "recording_stop"):
            self.recording = fields(answer).get("recording") is True

    def refused(self, ask: Ask, why: str) -> None:
        """The daemon did not do it."""
        self.said = why
        if ask.method == "go_home":
            self.homing = False

    def _may_not(self) -> str:
        """Why this person may do nothing but stop now; empty if they may."""
        if self.frame is None:
            return "there is no daemon"
        return "" if self.operator else "you may look, and stop the arm"

    def _ask_back(self, ask: Ask, now: float, question: str) -> list[Ask]:
        self._unsure, self.said = (ask, now + SURE), f"{question}? press y"
        return []

    # What looks.

    def _quit(self) -> None:
        self.quits = True

    def _next_group(self) -> None:
        self._group += 1
        self.said = f"arrows and Tab are for {self.group or 'nothing: there is no group'}"

    def _turn_help(self) -> None:
        self.help = True

    # What acts (now: monotonic s; held: the key repeats by itself).

    def _let_go(self) -> list[Ask]:
        self.homing, self.said = False, "homing cancelled"
        return [Ask("go_home_cancel")]

    def _pause(self, now: float, held: bool) -> list[Ask]:
        if text(self.frame or {}, "mode") == "active":
            self.said = "paused"
            return [Ask("pause", {"on": True})]
        return self._ask_back(Ask("pause", {"on": False}), now, "release the arm")

    def _torque(self, now: float, held: bool) -> list[Ask]:
        joints = [fields(joint) for joint in entries(self.frame or {}, "joints")]
        if not any(joint.get("torque") is True for joint in joints):
            return [] if held else [Ask("torque", {"on": True})]
        return self._ask_back(Ask("torque", {"on": False}), now, "torque off, and the arm may fall")

    def _home(self, now: float, held: bool) -> list[Ask]:
        if held:
            return []
        self.homing, self._goal, self.said = True, None, "going home; any key cancels"
        return self.renewals()

    def _jog(self, way: int) -> list[Ask]:
        if not self.group:
            return []
        params: dict[str, Value] = {"group": self.group, "effort": way * JOG_EFFORT, "lease_s": JOG_LEASE}
        return [Ask("group_command", params)]

    def _toggle(self, now: float, held: bool) -> list[Ask]:
        return [Ask("group_toggle", {"group": self.group})] if self.group and not held else []

    def _assist(self, now: float, held: bool) -> list[Ask]:
        """Off, or back to the mode that was switched off here."""
        frame = self.frame or {}
        helped = [fields(frame.get("assist")), *map(fields, entries(frame, "more_assists"))]
        found = next((assist for assist in helped if text(assist, "group") == self.group), None)
        if found is None:
            self.said = f"nothing helps with {self.group}"
        if found is None or held:
            return []
        mode = text(found, "mode")
        if mode != "off":
            self._modes[self.group] = mode
        elif self.group not in self._modes:
            self.said = "it was off from the start: bentod ctl assist-set mode=…"
            return []
        wanted = "off" if mode != "off" else self._modes[self.group]
        self.said = f"assist of {self.group}: {wanted}"
        return [Ask("assist_set", {"group": self.group, "mode": wanted})]

    def _record(self, now: float, held: bool) -> list[Ask]:
        if not self.recording:
            return [] if held else [Ask("recording_start")]
        return self._ask_back(Ask("recording_stop"), now, "end the recording")

    def _mark(self, now: float, held: bool) -> list[Ask]:
        if held:
            return []
        self.said = "marked"
        return [Ask("mark", {"mark": "note"})]

    def _left(self, now: float, held: bool) -> list[Ask]:
        return self._jog(-1)

    def _right(self, now: float, held: bool) -> list[Ask]:
        return self._jog(1)


_LOOKING: Mapping[str, Callable[[Hands], None]] = {
    "q": Hands._quit,
    "g": Hands._next_group,
    "?": Hands._turn_help,
}

_ACTING: Mapping[str, Callable[[Hands, float, bool], list[Ask]]] = {
    "p": Hands._pause,
    "t": Hands._torque,
    "h": Hands._home,
    "left": Hands._left,
    "right": Hands._right,
    "tab": Hands._toggle,
    "a": Hands._assist,
    "r": Hands._record,
    "m": Hands._mark,
}
