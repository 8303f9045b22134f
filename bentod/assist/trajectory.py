"""The delegation view of collaborative control: the user pushes and pulls all joints along a learned path.

Thesis 6.4, Figs. 6.2 and 6.3. While it is sure where the joints will be, "all joints together" is one more
entry of the toggle list. Who selects it pushes (effort above 0) towards where the joints are expected, all
in proportion, or pulls (below 0) back along the way that they came. Nothing moves without effort, and one
toggle gives the joints back.
"""

import math
from collections.abc import Mapping, Sequence

from bentod.assist.path import Path, Posture
from bentod.assist.sureness import Sureness, options_of
from bentod.contracts_assist import Assist, Assistance, AssistSettings, Situation
from bentod.frames import Freshness, JointSpec, Value, Velocity

DEAD_BAND = 0.012
"""rad/s; the least speed of a Dynamixel MX: 0.114 rpm a step."""

SETTLE = 0.2
"""s that the rest of the way takes at least, so that the lag of a servo takes no joint beyond it."""

ARRIVED = 0.01
"""rad within which a joint is where it is expected."""


class Trajectory(Assist):
    """Offers all joints at once where it knows the way, and moves them while they are selected and pushed.

    Pulling needs no prediction, but stops like pushing where one is not finite. That the way is unknown is
    found out at rest or while pushing only: so who pulls out of a bad place gets out.
    """

    def __init__(self, specs: Sequence[JointSpec], settings: AssistSettings) -> None:
        """Raises BadRequest: an option is unknown, or out of its bounds."""
        self._specs = tuple(specs)
        self._settings = settings
        self._sure = Sureness(options_of(settings.options))
        self._path = Path()
        self._manual_from = -math.inf

    def adjust(self, settings: AssistSettings) -> None:
        """As in `Assist`."""
        self._sure.options = options_of(settings.options)
        self._settings = settings

    def wish(self, situation: Situation) -> Assistance:
        """As in `Assist`."""
        pulls = situation.together and situation.effort < 0
        expected = self._expected(situation)
        self._sure.look(situation, self._settings.timescale, expected is not None, hold=pulls)
        here = _posture(situation)
        if here is not None and not pulls:
            self._path.note(here)
        if not situation.together:
            return Assistance({}, False, self._sure.reason)
        if not self._sure.offers or expected is None or here is None:
            return Assistance({}, False, f"All joints stop and fall back to one. {self._sure.reason}")
        if obstacle := self._obstacle(situation):
            return Assistance({}, False, obstacle)
        return self._pull(situation, here) if pulls else self._push(situation, here, expected)

    def toggled(self, now: float) -> None:
        """As in `Assist`."""
        self._manual_from = now

    def offers_together(self) -> bool:
        """While it knows the way."""
        return self._sure.offers

    def told(self) -> Mapping[str, Value]:
        """How sure it is, and how long the way back is (postures)."""
        return {**self._sure.told(), "way_back": len(self._path)}

    def _obstacle(self, situation: Situation) -> str:
        if situation.time < self._manual_from + self._settings.manual:
            return f"Waits {self._settings.manual:g} s after a toggle."
        if situation.attended is not None:
            name = self._specs[situation.attended].spoken
            return f"Waits: {name} is moved by itself."
        if not (situation.effort and math.isfinite(situation.effort)):
            return "All joints together: push to go on, pull to go back."
        return ""

    def _push(self, situation: Situation, here: Posture, expected: Posture) -> Assistance:
        target = zip(situation.joints, expected, strict=True)
        goal = tuple(self._specs[joint].clamp(position) for joint, position in target)
        if all(abs(to - at) < ARRIVED for to, at in zip(goal, here, strict=True)):
            return Assistance({}, True, "All joints are where they are expected: nothing lies ahead.")
        wishes = self._wishes(situation, here, goal, settle=True)
        names = ", ".join(self._specs[joint].spoken for joint in wishes)
        return Assistance(
            wishes, True, f"Pushed along the learned path: {names}; confidence {self._sure.confidence:.2f}."
        )

    def _pull(self, situation: Situation, here: Posture) -> Assistance:
        goal = self._path.back(here)
        if goal is None:
            return Assistance({}, True, "Pulled back as far as the way is remembered.")
        wishes = self._wishes(situation, here, goal, settle=len(self._path) == 1)
        names = ", ".join(self._specs[joint].spoken for joint in wishes)
        return Assistance(wishes, True, f"Pulled back along the way it came: {names}.")

    def _wishes(
        self, situation: Situation, here: Posture, goal: Posture, settle: bool
    ) -> dict[int, Velocity]:
        """In proportion to their ways, so that the joint that needs longest goes at effort · its maximum."""
        ways = {j: to - at for j, to, at in zip(situation.joints, goal, here, strict=True)}
        longest = max(abs(way) / self._maximum(joint) for joint, way in ways.items())  # s at full speed
        if longest == 0:
            return {}
        rate = min(abs(situation.effort), 1.0) / longest
        rate = min(rate, 1 / SETTLE) if settle else rate
        return {j: Velocity(way * rate) for j, way in ways.items() if abs(way * rate) >= DEAD_BAND}

    def _maximum(self, joint: int) -> float:
        return min(self._specs[joint].max_velocity, self._settings.velocity_limit)

    def _expected(self, situation: Situation) -> Posture | None:
        told = tuple(situation.outlook.position(j, self._settings.timescale) for j in situation.joints)
        return told if all(map(math.isfinite, told)) else None


def _posture(situation: Situation) -> Posture | None:
    """Where the joints are; None: one of them was not read in this tick."""
    seen = [situation.state.joints[joint] for joint in situation.joints]
    fresh = all(joint.freshness is Freshness.FRESH and math.isfinite(joint.position) for joint in seen)
    return tuple(joint.position for joint in seen) if fresh else None


def open_assist(specs: Sequence[JointSpec], rate_hz: float, settings: AssistSettings) -> Trajectory:
    """The assist. Raises BadRequest: an option is unknown, or out of its bounds."""
    return Trajectory(specs, settings)
