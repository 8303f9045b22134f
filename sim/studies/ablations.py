"""Assists that show what the others owe to their predictions: shuffled in time, or replaced by the task."""

import random
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

from bentod.assist.thesis import ThesisDpcc
from bentod.contracts_assist import Assistance, AssistSettings, OpenAssist, Outlook, Situation
from bentod.frames import JointSpec, Velocity
from sim.people.scene import Point

AGES = 600
"""Ticks among which the moment is chosen whose predictions are followed: the last 20 s."""

LASTS = 30
"""Ticks for which one moment's predictions stay those that are followed."""

GAIN = 3.0
"""1/s, as f · k of (5.1) in the maze."""

FASTEST = 0.3
"""rad/s at which the one who knows the task goes at most."""

Guide = Callable[[Point], Point]
"""Where the arm should be next (rad), of where it is."""


@dataclass(frozen=True, slots=True)
class _Elsewhen:
    """An outlook whose expected positions are those of another moment."""

    now: Outlook
    then: Mapping[int, float]

    def position(self, joint: int, timescale: float) -> float:
        return self.then[joint]

    def confidence(self, joint: int, timescale: float) -> float:
        return self.now.confidence(joint, timescale)

    def surprise(self, joint: int, timescale: float) -> float:
        return self.now.surprise(joint, timescale)

    def familiarity(self) -> float:
        return self.now.familiarity()

    def answer(self, name: str) -> float:
        return self.now.answer(name)

    @property
    def timescales(self) -> tuple[float, ...]:
        return self.now.timescales


class Shuffled(ThesisDpcc):
    """The thesis' assist, which follows predictions that are right, but were made at another moment."""

    def __init__(
        self, specs: Sequence[JointSpec], rate_hz: float, settings: AssistSettings, seed: int
    ) -> None:
        super().__init__(specs, rate_hz, settings)
        self._timescale = settings.timescale
        self._draw = random.Random(f"{seed}/shuffled")
        self._past: deque[Mapping[int, float]] = deque(maxlen=AGES)
        self._then: Mapping[int, float] = {}
        self._left = 0

    def wish(self, situation: Situation) -> Assistance:
        """As in `Assist`."""
        outlook = situation.outlook
        self._past.append({joint: outlook.position(joint, self._timescale) for joint in situation.joints})
        self._left -= 1
        if self._left < 0:
            self._left, self._then = LASTS, self._past[self._draw.randrange(len(self._past))]
        return super().wish(replace(situation, outlook=_Elsewhen(outlook, self._then)))


class Oracle(ThesisDpcc):
    """Knows the task instead of learning it, and keeps the other joint on its way: an upper bound."""

    def __init__(
        self, specs: Sequence[JointSpec], rate_hz: float, settings: AssistSettings, guide: Guide
    ) -> None:
        super().__init__(specs, rate_hz, settings)
        self._guide = guide
        self._manual = settings.manual
        self._toggled = float("-inf")

    def toggled(self, now: float) -> None:
        """As in `Assist`."""
        self._toggled = now

    def wish(self, situation: Situation) -> Assistance:
        """As in `Assist`."""
        attended = situation.attended
        if attended not in (0, 1) or situation.time < self._toggled + self._manual:
            return Assistance({}, False, "Nothing to follow.")
        first, second = situation.state.joints[:2]
        position = (first.position, second.position)
        other = 1 - attended
        wanted = GAIN * (self._guide(position)[other] - position[other])
        velocity = min(max(wanted, -FASTEST), FASTEST)
        return Assistance({other: Velocity(velocity)}, True, "Follows the task itself.")


def shuffled(seed: int) -> OpenAssist:
    """A factory of `Shuffled`."""
    return lambda specs, rate_hz, settings: Shuffled(specs, rate_hz, settings, seed)


def oracle(guide: Guide) -> OpenAssist:
    """A factory of `Oracle`."""
    return lambda specs, rate_hz, settings: Oracle(specs, rate_hz, settings, guide)
