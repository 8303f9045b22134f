"""A simulated operator: looks, decides now and then, pushes, toggles, and is surprised by help."""

import math
import random
from dataclasses import dataclass

from sim.people.hand import Hand
from sim.people.scene import Act, Course, Point, View, Way, moved
from sim.people.senses import Eyes
from sim.people.switch import Switch
from sim.people.traits import Traits
from sim.people.trust import Look, Trust

CHUNK = 1.5
"""Intervals between decisions that the last push before a stop may run without another look; assumed."""

TRANSIT = 0.06
"""s from effort to motion that the arm takes: a tick, a dead time, and the limits of acceleration."""

GLANCE = 0.2
"""s over which a motion is seen."""

EASES = (1.0, 0.6, 0.35, 0.2)
"""Shares of the full effort among which somebody chooses who lets the other joint come along; assumed."""

BACKWARD = 0.3
"""What a gain counts that is only had by going back; assumed."""

MANUAL = 0.5
"""s after a toggle in which the arm does not help, as who trusts it has learned (thesis 5.3)."""

SKIM = 0.02
"""rad beyond the first touch of a wall that whoever is lenient lets the rod slide along it; assumed."""

PATIENCE = 1.5
"""s for which nothing seems worth doing before one tries something all the same; assumed."""

RELUCTANCE = 4.0
"""How many times more worth it must be to go back from a wall that was not touched; assumed."""


@dataclass(frozen=True, slots=True)
class _Plan:
    """What a joint could do now."""

    way: Way
    ease: float  # share of the full effort
    drift: float  # rad of the other joint for each rad


class Operator:
    """Works through a course with one joint at a time, intermittently and with delay.

    Between two decisions a push runs on by itself. A decision looks at where the arm was seen, adds what the
    hand has done since, and asks how far the joint that is believed to be driven can usefully go: if it is
    worth it, that is pushed; if only the other joint has something to gain, the operator toggles.
    """

    def __init__(self, traits: Traits, seed: int, speed: float) -> None:
        """`speed`: rad/s of a joint at full effort."""
        self.traits = traits
        self._speed = speed
        self._draw = random.Random(f"{seed}/{traits.name}")
        self._eyes = Eyes(traits.senses, speed, self._draw)
        self._hand = Hand(traits.hands, speed, self._draw)
        self._switch = Switch(traits.switching, self._draw)
        self.trust = Trust(traits.autonomy, self._draw)
        self._next = -math.inf
        self._leg = -1
        self._kept = self._margin = traits.caution.margin
        self._toggle_after = False
        self._touching = False
        self._astray = 0.0
        self._lost_since = math.inf
        self._time: float | None = None

    def circuit_done(self, assisted: bool) -> None:
        """A circuit ends: the arm's own ways become a habit."""
        self.trust.circuits += assisted

    def step(self, view: View, course: Course) -> Act:
        """One tick, in which things are as in `view`; what is done about it is an answer to older ones."""
        eyes, now = self._eyes, view.time
        eyes.look(view)
        elapsed = 0.0 if self._time is None else now - self._time
        self._time = now
        if eyes.heard().resting:
            self._hand.rest()
            self._await(now)
        else:
            self._attend(self._look(elapsed), now, course)
        toggle = self._switch.step(now, eyes.told())
        if toggle or self._switch.busy:
            self._hand.rest()
            self._next = now  # what follows the press was decided with it
        effort = self._hand.step(now)
        eyes.felt(now, self._switch.belief, effort)
        return Act(effort, toggle)

    def _look(self, elapsed: float) -> Look:
        seen, before = self._eyes.seen(), self._eyes.seen(GLANCE)
        first, second = (
            (new - old) / GLANCE for new, old in zip(seen.position, before.position, strict=True)
        )
        return Look(seen.position, (first, second), seen.active, elapsed, seen.assisted)

    def _await(self, now: float) -> None:
        """Hold until the second sound, with nothing in mind but the joint that the voice named last."""
        self._next, self._toggle_after, self._touching = now, False, False
        self.trust.settle(self._eyes.seen().position)

    def _attend(self, look: Look, now: float, course: Course) -> None:
        seen = self._eyes.seen()
        if seen.leg != self._leg:
            self._leg = seen.leg
            caution = self.traits.caution
            self._kept = max(0.0, self._draw.gauss(caution.margin, caution.scatter))
        lenient = self.traits.caution.lenience * self.trust.trust if look.assisted else 0.0
        self._margin = self._kept - lenient * (self._kept + SKIM)
        self._notice_joint(look, now)
        self._notice_wall(look, seen.pressing or (seen.touching and self._margin >= 0), now)
        if not self._switch.busy:
            self._notice_arm(look, now, course)
        if now >= self._next and not self._switch.busy:
            self._decide(look, now, course)

    def _notice_joint(self, look: Look, now: float) -> None:
        """Driving the wrong joint shows after a while, later when both joints move anyway."""
        if self._switch.belief == look.joint or not self._hand.pushing:
            self._astray = 0.0
            return
        self._astray += look.elapsed / (2.0 if look.both else 1.0)
        if self._astray > self.traits.autonomy.realise:
            self._switch.realise(look.joint)
            self._pause(now)

    def _notice_wall(self, look: Look, touching: bool, now: float) -> None:
        """A touch stops the hand."""
        if touching and not self._touching:
            if look.both:
                self.trust.blame()
                self._correct(look)
            self._pause(now + self.traits.caution.error_pause)
        self._touching = touching

    def _notice_arm(self, look: Look, now: float, course: Course) -> None:
        verdict = self.trust.watch(look, course, self._margin)
        if verdict.wait:
            self._pause(now + verdict.wait)
        if verdict.harmed or verdict.wait:
            self._correct(look)

    def _pause(self, until: float) -> None:
        """Let go, and decide anew at `until` (s)."""
        self._hand.rest()
        self._toggle_after, self._next = False, until

    def _correct(self, look: Look) -> None:
        """One wants to set right what both joints did, and may not know any more which of them obeys."""
        if self._switch.belief == look.joint and self.trust.confused():
            self._switch.lose()

    def _decide(self, look: Look, now: float, course: Course) -> None:
        self._next = now + self.traits.hands.interval
        prepared, self._toggle_after = self._toggle_after, False
        if prepared:
            self._switch.begin(now, prepared=True)
            self._lost_since = math.inf
            return
        joint, worth = self._switch.belief, self.traits.caution.worth
        position = self._estimate(look, course)
        plan = self._plan(look, position, joint, course)
        other = course.way(position, 1 - joint, 0.0, self._margin)
        tempting = other.gain >= self._needed(other)
        leaves = tempting and plan.drift != 0.0 and self._rather_toggles(plan, other)
        if plan.way.gain >= self._needed(plan.way) and not leaves:
            self._push(plan, joint, position, now, course, look.assisted)
        elif tempting:
            self._switch.begin(now, prepared=False)
        else:
            without = plan if plan.way.gain >= worth else self._alone(position, joint, course)
            if without.way.gain >= worth:
                self._push(without, joint, position, now, course, look.assisted)
            elif other.gain >= worth:
                self._switch.begin(now, prepared=False)
            else:
                self._wonder(look, now)
                return
        self._lost_since = math.inf

    def _wonder(self, look: Look, now: float) -> None:
        """Nothing seems worth doing: where the arm helps, one soon dares more, and tries the other joint."""
        self._hand.rest()
        self._lost_since = min(self._lost_since, now)
        if look.assisted and now - self._lost_since > PATIENCE:
            self._lost_since = math.inf
            self._kept /= 2
            self._switch.begin(now, prepared=False)

    def _alone(self, position: Point, joint: int, course: Course) -> _Plan:
        """What a joint could do if the other one did not come along, against what is expected of it."""
        return _Plan(course.way(position, joint, 0.0, self._margin), 1.0, 0.0)

    def _needed(self, way: Way) -> float:
        """What a way must be worth (rad) to be gone: before a toggle as after it, lest one dithers."""
        return self.traits.caution.worth * (RELUCTANCE if way.back and not self._touching else 1.0)

    def _rather_toggles(self, plan: _Plan, other: Way) -> bool:
        """Whether the other joint is worth more a second, although it costs a toggle."""
        going = abs(other.distance) / self._speed + self._toggling()
        staying = abs(plan.way.distance) / (plan.ease * self._speed) + GLANCE
        return other.gain / going > plan.way.gain / staying

    def _plan(self, look: Look, position: Point, joint: int, course: Course) -> _Plan:
        """The best that `joint` can do, perhaps slowly, so that the other joint comes along."""
        rate = self.trust.expects(look, course.place(position), joint)
        trust, autonomy = self.trust, self.traits.autonomy
        care = autonomy.careful * (1 - trust.trust) * trust.strangeness if look.assisted else 0.0
        eases = EASES if rate and self._draw.random() < autonomy.easing else (1.0 - care,)
        plans = []
        for ease in eases:
            drift = rate / (ease * self._speed)
            plans.append(_Plan(course.way(position, joint, drift, self._margin), ease, drift))
        return max(plans, key=self._worth)

    def _worth(self, plan: _Plan) -> float:
        """Progress (rad/s) if a toggle is due at the end of the way: slow and far may beat fast and near."""
        lasts = abs(plan.way.distance) / (plan.ease * self._speed) + self._toggling()
        return plan.way.gain / lasts * (BACKWARD if plan.way.back else 1.0)

    def _toggling(self) -> float:
        """What a toggle costs (s), with what it costs of the arm's help as far as that is trusted."""
        switching = self.traits.switching
        return GLANCE + switching.choice + switching.press + self.trust.trust * MANUAL

    def _push(
        self, plan: _Plan, joint: int, position: Point, now: float, course: Course, assisted: bool
    ) -> None:
        """Push the whole way; a look in between may correct it, and what comes next may be prepared."""
        if self._draw.random() < self.traits.switching.wrong:
            self._switch.begin(now, prepared=False)
            return
        by = plan.way.distance
        ends = self._hand.push(by, plan.ease, now)
        if ends < now + CHUNK * self.traits.hands.interval:
            there = moved(position, joint, by, plan.drift * abs(by))
            after = course.way(there, 1 - joint, 0.0, self._margin)
            goes_on = course.way(there, joint, plan.drift, self._margin).gain >= self.traits.caution.worth
            wanted = after.gain >= self.traits.caution.worth and not (goes_on or plan.way.back)
            looks = plan.drift != 0.0 or (assisted and self._draw.random() < self.trust.trust)
            self._toggle_after = wanted and not looks and self._switch.foresees()
            self._next = ends

    def _estimate(self, look: Look, course: Course) -> Point:
        """Where the arm will be if one lets go now, as far as one can know."""
        position = self._eyes.blurred(look.position)
        senses, place = self.traits.senses, course.place(look.position)
        for joint in (0, 1):
            own = self._eyes.foreseen(joint, TRANSIT, self.traits.hands.lag)
            position = moved(position, joint, own)
        if look.both:
            late = senses.visual_delay * senses.prediction
            position = moved(position, 1 - look.joint, self.trust.expects(look, place, look.joint) * late)
        return position
