"""What happened once: sentences for people, data for clients; the tick takes and publishes them."""

import math
from collections.abc import Mapping, Sequence

from bentod.frames import Event, GoalFrame, JointSpec, State, Value

QUIET = 10.0
"""s between two events about the same matter that goes on."""


class Journal:
    """Events since they were last taken."""

    def __init__(self, specs: Sequence[JointSpec]) -> None:
        self.now = 0.0
        """Monotonic s, the stamp of what is noted next."""
        self._names = tuple(spec.name for spec in specs)
        self._errors: tuple[tuple[str, ...], ...] = ((),) * len(self._names)
        self._events: list[Event] = []
        self._quiet_until: dict[str, float] = {}

    def note(self, kind: str, text: str, data: Mapping[str, Value] | None = None) -> None:
        """Record something that happened once."""
        self._events.append(Event(self.now, kind, text, data or {}))

    def note_seldom(self, kind: str, about: str, text: str, data: Mapping[str, Value] | None = None) -> None:
        """Record something that may happen in every tick; of one matter (`about`) once in `QUIET`."""
        if self.now >= self._quiet_until.get(about, -math.inf):
            self._quiet_until[about] = self.now + QUIET
            self.note(kind, text, data)

    def settled(self, about: str) -> None:
        """The matter has ended: should it come again, it is recorded at once."""
        self._quiet_until.pop(about, None)

    def goal(self, goal: GoalFrame) -> None:
        """Record how a goal stands."""
        text = f"{goal.kind} {goal.status}, {goal.progress:.0%}" + (f": {goal.reason}" if goal.reason else "")
        data: dict[str, Value] = {
            "id": goal.id,
            "status": goal.status,
            "progress": goal.progress,
            "reason": goal.reason,
        }
        self.note("goal", text, data)

    def errors(self, state: State) -> None:
        """Record what servos complain of, when it changes."""
        for name, joint, before in zip(self._names, state.joints, self._errors, strict=True):
            if joint.errors != before:
                text = f"{name} reports {', '.join(joint.errors) or 'no error any more'}"
                self.note("servo", text, {"joint": name, "errors": list(joint.errors)})
        self._errors = tuple(joint.errors for joint in state.joints)

    def take(self) -> list[Event]:
        """What was recorded since the last call."""
        events, self._events = self._events, []
        return events
