"""Collaborative control that heeds its confidence: it comes when it is sure, and goes when it is not wanted.

Each unattended joint goes to where it is expected as in thesis (5.1), with what the thesis found missing:

* a gate of confidence, surprise and familiarity for each joint (5.6.3, 6.1), through which help fades in;
* trust for each joint, which the wearer's corrections cost (6.4: "the user must have a way to correct");
* a bound from the wearer's own motion: a joint goes at most `slope` as fast as the attended one goes the way
  that it is pushed, so that help slows, stops and waits with the wearer, instead of running past a barrier
  that its timescale does not see (5.5) or drifting while they hesitate;
* known ground: no help to where the group has never been without help, so that a prediction that cuts a
  corner does not end at a wall that nobody told the arm of;
* no help while the attended joint goes another way than expected, for then so will the others.
"""

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from bentod.assist.confident_options import confident_options
from bentod.assist.dpcc import dpcc_velocity
from bentod.assist.fade import Evidence, Fade, Gate
from bentod.assist.ground import Ground
from bentod.assist.trust import Trust
from bentod.contracts_assist import Assist, Assistance, AssistSettings, Situation
from bentod.frames import Freshness, JointSpec, Value, Velocity

DEAD_BAND = 0.012
"""rad/s; the least speed of a Dynamixel MX: 0.114 rpm a step."""

PLEASED = 0.2
"""Share of trust that a reward of 1 restores, or one of -1 costs; of joints that were helped lately."""


class _Helped:
    """What is known of the help for one joint."""

    def __init__(self) -> None:
        self.gate = Gate()
        self.fade = Fade()
        self.trust = Trust()
        self.position = math.nan


class ConfidentDpcc(Assist):
    """See the module. One of it helps with one group; what it knows is by joint."""

    def __init__(self, specs: Sequence[JointSpec], rate_hz: float, settings: AssistSettings) -> None:
        """Raises BadRequest: an option is unknown, or out of its bounds."""
        self._specs = tuple(specs)
        self._period = 1 / rate_hz
        self._rate_hz = rate_hz
        self._options = confident_options(settings.options)
        self._settings = settings
        self._joints = [_Helped() for _ in specs]
        self._ground = Ground(specs)
        self._manual_from = -math.inf
        self._lately: tuple[int, ...] = ()

    def adjust(self, settings: AssistSettings) -> None:
        """As in `Assist`."""
        self._options = confident_options(settings.options)
        self._settings = settings

    def wish(self, situation: Situation) -> Assistance:
        """As in `Assist`."""
        self._notice(situation)
        obstacle = self._obstacle(situation)
        attended = situation.attended
        if obstacle or attended is None:
            for joint in situation.joints:
                self._joints[joint].fade.rest()
            return Assistance({}, False, obstacle)
        told = {j: self._follow(j, attended, situation) for j in situation.joints if j != attended}
        self._joints[attended].fade.rest()
        wishes = {joint: Velocity(v) for joint, (v, _) in told.items() if v}
        self._lately = tuple(wishes) or self._lately
        engaged = any(self._joints[joint].fade.gain > 0 for joint in told)
        return Assistance(wishes, engaged, "; ".join(reason for _, reason in told.values()) + ".")

    def toggled(self, now: float) -> None:
        """As in `Assist`."""
        self._manual_from = now
        for helped in self._joints:
            helped.trust.toggled(now, self._options)
            helped.fade.rest()

    def rewarded(self, reward: float) -> None:
        """As in `Assist`: of the joints that were helped last."""
        if not math.isfinite(reward):
            return
        share = min(PLEASED * abs(reward), 1.0)
        for joint in self._lately:
            trust = self._joints[joint].trust
            (trust.gain if reward > 0 else trust.lose)(share)

    def told(self) -> Mapping[str, Value]:
        """Trust, strength and corrections by joint."""
        by_name = {spec.name: helped for spec, helped in zip(self._specs, self._joints, strict=True)}
        return {
            "trust": {name: round(helped.trust.value, 4) for name, helped in by_name.items()},
            "gain": {name: round(helped.fade.gain, 4) for name, helped in by_name.items()},
            "corrections": {name: helped.trust.corrections for name, helped in by_name.items()},
        }

    def memory(self) -> dict[str, NDArray[np.float64]]:
        """The ground that is known."""
        return self._ground.memory()

    def recall(self, memory: Mapping[str, NDArray[np.float64]]) -> None:
        """As in `Assist`."""
        self._ground.recall(memory)

    def _notice(self, situation: Situation) -> None:
        """What became of the joints since the last tick: helped on undisturbed, or corrected."""
        if not any(helped.fade.velocity for helped in self._joints):
            self._ground.note(situation)
        for joint in situation.joints:
            helped, position = self._joints[joint], situation.state.joints[joint].position
            way, helped.position = position - helped.position, position
            if not math.isfinite(way):
                continue
            if joint == situation.attended:
                helped.trust.moved(position, situation.time, self._options)
            elif helped.fade.velocity:
                helped.trust.helped(way, situation.time, self._period, self._options)

    def _obstacle(self, situation: Situation) -> str:
        if situation.time < self._manual_from + self._settings.manual:
            return f"Manual for {self._settings.manual:g} s after a toggle."
        if situation.attended is None or situation.attended not in situation.joints:
            return "Waits: you are not moving a joint of this group."
        return ""

    def _follow(self, joint: int, attended: int, situation: Situation) -> tuple[float, str]:
        """The velocity of one joint (rad/s), and why it is that."""
        helped, name = self._joints[joint], self._specs[joint].spoken
        reason = self._shut(joint, attended, situation)
        if reason:
            helped.fade.shut()
            return 0.0, f"{name} {reason}"
        helped.fade.grow(self._period, self._options.fade)
        wanted = self._wanted(joint, attended, situation) * helped.fade.gain
        wanted *= helped.trust.strength(self._options)
        threshold = DEAD_BAND * (1 if helped.fade.velocity * wanted > 0 else 2)
        if abs(wanted) < threshold:
            helped.fade.rest()
            return 0.0, f"{name} is about where it is expected"
        timescale = self._settings.timescale
        sure = situation.outlook.confidence(joint, timescale)
        seconds = timescale * self._period
        velocity = helped.fade.ask(wanted, max(threshold, self._options.acceleration * self._period))
        return velocity, f"{name} follows its {seconds:.1f} s prediction, confidence {sure:.2f}"

    def _shut(self, joint: int, attended: int, situation: Situation) -> str:
        """Why there is no help for a joint now; empty if there is."""
        helped, now = self._joints[joint], situation.time
        outlook, timescale = situation.outlook, self._settings.timescale
        read = [situation.state.joints[j].freshness is Freshness.FRESH for j in (joint, attended)]
        position, expected = situation.state.joints[joint].position, outlook.position(joint, timescale)
        if not (all(read) and math.isfinite(position) and math.isfinite(expected)):
            helped.gate.open = False
            return "waits: there is no prediction for it"
        seen = Evidence(
            outlook.confidence(joint, timescale), outlook.surprise(joint, timescale), outlook.familiarity()
        )
        reason = helped.gate.look(seen, self._options)
        if helped.trust.holds_back(now, self._options):
            ago = now - helped.trust.corrected
            return f"holds back: you corrected it {ago:.0f} s ago"
        if reason:
            return f"waits: {reason}"
        return "waits: you go another way than usual" if self._astray(attended, situation) else ""

    def _astray(self, attended: int, situation: Situation) -> bool:
        """Whether the attended joint is expected elsewhere than it is being moved to."""
        expected = situation.outlook.position(attended, self._settings.timescale)
        ahead = (expected - situation.state.joints[attended].position) * math.copysign(1, situation.effort)
        return situation.effort != 0 and ahead < -self._options.astray

    def _wanted(self, joint: int, attended: int, situation: Situation) -> float:
        """(5.1) within all bounds, rad/s."""
        spec, state = self._specs[joint], situation.state.joints
        expected = spec.clamp(situation.outlook.position(joint, self._settings.timescale))
        velocity = dpcc_velocity(expected, state[joint].position, self._rate_hz, self._settings.k)
        going = state[attended].velocity * (math.copysign(1, situation.effort) if situation.effort else 0)
        account = self._options.slope * max(going, 0.0) if math.isfinite(going) else 0.0
        bound = min(spec.max_velocity, self._settings.velocity_limit, account)
        bounded, ahead = min(max(velocity, -bound), bound), self._options.ground
        return self._ground.within(situation, joint, bounded, ahead) if ahead else bounded


def open_assist(specs: Sequence[JointSpec], rate_hz: float, settings: AssistSettings) -> ConfidentDpcc:
    """The assist. Raises BadRequest: an option is unknown, or out of its bounds."""
    return ConfidentDpcc(specs, rate_hz, settings)
