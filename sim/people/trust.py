"""How an operator takes an arm that moves by itself: surprise, judgement, trust, expectation."""

import math
import random
from dataclasses import dataclass

from sim.people.scene import Course, Point
from sim.people.traits import Autonomy

MOVES = 0.02
"""rad/s above which one sees a joint move; assumed."""

CLEAR = 0.004
"""rad of value by which a motion must have helped or harmed to be judged at all; assumed."""

SEEN = 0.7
"""Weight of how the other joint is seen to move, against how it usually moves there; assumed."""

OWN_DOING = 0.25
"""s after a change of the joint, in which the other joint's motion is still one's own; assumed."""

LASTING = 0.08
"""Share of a loss of trust that habit does not soften; assumed."""

CONFIRMED = 0.1
"""rad without a surprise, after which the arm is taken as it is; assumed."""


@dataclass(frozen=True, slots=True)
class Look:
    """What one glance tells."""

    position: Point  # rad
    rates: Point  # rad/s
    joint: int  # the one that is driven
    elapsed: float  # s since the last glance
    assisted: bool  # the arm may help

    @property
    def both(self) -> bool:
        """Whether both joints move."""
        return all(abs(rate) > MOVES for rate in self.rates)

    @property
    def own(self) -> float:
        """rad/s of the joint that is driven."""
        return self.rates[self.joint]

    @property
    def other(self) -> float:
        """rad/s of the joint that is not."""
        return self.rates[1 - self.joint]


@dataclass(frozen=True, slots=True)
class Verdict:
    """What an operator makes of a motion that they did not ask for."""

    wait: float = 0.0  # s for which to let go and look; 0: go on
    harmed: bool = False


class Trust:
    """Trust in the arm's own motion, and what motion is expected where.

    How fast the other joint goes by itself while one's own moves is remembered by place and joint. With trust
    one counts on it, which is how toggles become unnecessary, and walls get touched when the arm does not
    come along as it used to.
    """

    def __init__(self, autonomy: Autonomy, draw: random.Random) -> None:
        self._autonomy = autonomy
        self._draw = draw
        self._rates: dict[tuple[int, int], float] = {}
        self._base: Point | None = None
        self._joint = 0
        self._driven = 0.0
        self._expected = 0.0
        self.trust = autonomy.trust
        """0..1"""
        self.circuits = autonomy.experience
        """Assisted circuits behind the operator."""

    @property
    def strangeness(self) -> float:
        """1 for whom it is new, towards 0 with habit."""
        return math.exp(-self.circuits / self._autonomy.habit)

    def expects(self, look: Look, place: int, joint: int) -> float:
        """rad/s that the other joint is counted on to go by itself while `joint` is driven."""
        if not look.assisted:
            return 0.0
        usual = self._rates.get((place, joint), 0.0)
        if look.both and look.joint == joint == self._joint and self._driven >= OWN_DOING:
            usual = SEEN * look.other + (1 - SEEN) * usual
        return self.trust * usual if abs(usual) > MOVES else 0.0

    def settle(self, position: Point) -> None:
        """Take the arm as it is: nothing about it is unexpected any more."""
        self._base, self._expected = position, 0.0

    def confused(self) -> bool:
        """Whether a correction makes one lose track of the joint."""
        return self._draw.random() < self._autonomy.confusion * self.strangeness

    def watch(self, look: Look, course: Course, margin: float) -> Verdict:
        """Judge what the other joint has done since the last look that had something to judge."""
        if self._base is None or look.joint != self._joint:
            self._joint, self._driven = look.joint, 0.0
        self._driven += look.elapsed
        if self._base is None or not look.assisted or self._driven < OWN_DOING:
            self.settle(look.position)
            return Verdict()
        place = course.place(look.position)
        if abs(look.own) > MOVES:
            self._expected += self.expects(look, place, look.joint) * look.elapsed
            self._learn(look, place)
        own, other = (look.position[j] - self._base[j] for j in (look.joint, 1 - look.joint))
        if abs(other) < self._autonomy.notice:
            if abs(own) > CONFIRMED:
                self.settle(look.position)
            return Verdict()
        verdict = self._judged(look, other, course, margin)
        self.settle(look.position)
        return verdict

    def blame(self) -> None:
        """A wall was touched while the arm moved by itself."""
        self._lose()

    def _learn(self, look: Look, place: int) -> None:
        before = self._rates.get((place, look.joint), 0.0)
        share = min(look.elapsed / self._autonomy.learning, 1.0)
        self._rates[place, look.joint] = before + share * (look.other - before)

    def _judged(self, look: Look, other: float, course: Course, margin: float) -> Verdict:
        x, y = look.position
        without = (x, y - other) if look.joint == 0 else (x - other, y)
        gained = course.value(look.position, margin) - course.value(without, margin)
        harmed = gained < -CLEAR
        startled = self._startled(abs(other - self._expected), harmed)
        if harmed:
            self._lose()
        elif gained > CLEAR:
            self.trust += self._autonomy.up * (1 - self.trust)
        return Verdict(self._pause() if startled else 0.0, harmed)

    def _lose(self) -> None:
        """Trust that has grown with habit is not lost in a moment."""
        self.trust *= 1 - self._autonomy.down * (LASTING + (1 - LASTING) * self.strangeness)

    def _startled(self, unexpected: float, harmed: bool) -> bool:
        if unexpected < self._autonomy.notice:
            return False
        doubt = 1.0 if harmed else self.strangeness
        return self._draw.random() < (1 - self.trust) * doubt

    def _pause(self) -> float:
        scatter = math.exp(self._draw.gauss(0.0, 0.3))
        return self._autonomy.wait * (1 - self.trust) * (0.4 + 0.6 * self.strangeness) * scatter
