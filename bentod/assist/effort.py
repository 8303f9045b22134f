"""Joints that nobody attends to move as the operator is expected to move them (thesis 5.6.5).

What is predicted is not where a joint will be, but what the operator will ask of it: for each joint the mean
of their effort while that joint is active, 0 while another one is, weighted by γ over the ticks to come. So
the same mapping applies to the prediction as to the operator's own effort: a share of the joint's speed. What
the arm does itself is no effort of the operator's. Once it does their work, they no longer do it, and the
prediction fades, until they do it again (5.6.5 names neither; Parker, Dawson & Pilarski 2023 measured it for
signals that a user acts on).
"""

import math
from collections.abc import Mapping, Sequence

from bentod.contracts_assist import Assist, Assistance, AssistSettings, Situation
from bentod.errors import BadRequest
from bentod.frames import JointSpec, Value, Velocity

DEAD_BAND = 0.012
"""rad/s; the least speed of a Dynamixel MX: 0.114 rpm a step."""

OPTIONS = {"gain": (1.0, 0.0, 10.0)}
"""By name: default and bounds. `gain`: times the predicted effort; 0 keeps everything still."""


def effort_of(group: str, joint: str, timescale: float) -> str:
    """The name of the question what the operator will ask of `joint` within `timescale` ticks."""
    return f"{group}.effort_of.{joint}@{timescale:g}"


class EffortAssist(Assist):
    """Moves unattended joints at the velocity that the operator is expected to ask of each, while they move.

    As in DPCC a joint sets off at twice the dead band and is let go at the dead band, none goes faster than
    its own maximum and the settings allow, and after a toggle everything is manual for a while. `k` is not
    used: there is no way of which it could be a share.
    """

    def __init__(self, specs: Sequence[JointSpec], rate_hz: float, settings: AssistSettings) -> None:
        """Raises BadRequest: an option is unknown or out of its bounds."""
        self._specs = tuple(specs)
        self._manual_from = -math.inf
        self._last: Mapping[int, float] = {}
        self.adjust(settings)

    def adjust(self, settings: AssistSettings) -> None:
        """As in `Assist`."""
        for name, value in settings.options.items():
            if name not in OPTIONS:
                raise BadRequest(f"effort has no option '{name}' (it has gain)", "options")
            _, low, high = OPTIONS[name]
            if not low <= value <= high:
                raise BadRequest(f"effort: {name} = {value:g} must be {low:g} to {high:g}", "options")
        self._settings = settings
        self._gain = settings.options.get("gain", OPTIONS["gain"][0])

    def asks(self, group: str, joints: Sequence[str]) -> tuple[Mapping[str, Value], ...]:
        """As in `Asking`: what will be asked of each joint."""
        timescale = self._settings.timescale
        return tuple(
            {
                "name": effort_of(group, joint, timescale),
                "cumulant": f"'{group}.effort' * '{group}.active.{joint}'",
                "timescale": timescale,
                "confidence_range": 2.0,
            }
            for joint in joints
        )

    def wish(self, situation: Situation) -> Assistance:
        """As in `Assist`."""
        if reason := self._obstacle(situation):
            self._last = {}
            return Assistance({}, False, reason)
        expected = {
            joint: self._expected(situation, joint)
            for joint in situation.joints
            if joint != situation.attended
        }
        known = {joint: effort for joint, effort in expected.items() if math.isfinite(effort)}
        wanted = {joint: self._velocity(joint, effort) for joint, effort in known.items()}
        self._last = {joint: v for joint, v in wanted.items() if self._worth_moving(joint, v)}
        wishes = {joint: Velocity(v) for joint, v in self._last.items()}
        return Assistance(wishes, bool(known), self._explain(known))

    def toggled(self, now: float) -> None:
        """As in `Assist`."""
        self._manual_from = now

    def _obstacle(self, situation: Situation) -> str:
        """Why nothing may move; empty when something may."""
        if situation.time < self._manual_from + self._settings.manual:
            return f"Manual for {self._settings.manual:g} s after a toggle."
        if situation.attended not in situation.joints:
            return "The operator is not moving a joint of this group."
        return ""

    def _expected(self, situation: Situation, joint: int) -> float:
        name = effort_of(situation.group, self._specs[joint].name, self._settings.timescale)
        return situation.outlook.answer(name)

    def _velocity(self, joint: int, effort: float) -> float:
        """rad/s: what an effort beyond -1..1, which nobody can make, is cut to, in the joint's limits."""
        spec = self._specs[joint]
        velocity = min(max(self._gain * effort, -1.0), 1.0) * spec.max_velocity
        limit = min(spec.max_velocity, self._settings.velocity_limit)
        return min(max(velocity, -limit), limit)

    def _worth_moving(self, joint: int, velocity: float) -> bool:
        keeps_going = self._last.get(joint, 0.0) * velocity > 0
        return abs(velocity) >= DEAD_BAND * (1 if keeps_going else 2)

    def _explain(self, known: Mapping[int, float]) -> str:
        if not known:
            return f"Nobody knows yet what will be asked at {self._settings.timescale:g} ticks."
        if not self._last:
            return "The operator is not expected to ask anything of another joint soon."
        asked = ", ".join(f"{self._specs[j].name} ({known[j]:+.0%} effort)" for j in self._last)
        return f"Moves {asked} as the operator is expected to ask."


def open_assist(specs: Sequence[JointSpec], rate_hz: float, settings: AssistSettings) -> EffortAssist:
    """As `OpenAssist`. Raises BadRequest: an option is unknown or out of its bounds."""
    return EffortAssist(specs, rate_hz, settings)
