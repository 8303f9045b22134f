"""A wearer for whom the best timescale is known: short where the elbow is low, long where it is high."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from bentod.assist.timescales.choice import Choice
from bentod.contracts_assist import AssistSettings, Situation
from bentod.frames import Freshness, JointSpec, JointState, State
from bentod.learn.tiles import TileCoder

RATE = 20.0
TIMESCALES = (5.0, 10.0, 40.0)
SPECS = tuple(JointSpec(name, -1.0, 1.0, 0.5, 0.0, {}) for name in ("shoulder", "elbow"))
SHOULDER, ELBOW = 0, 1
PLACES = {-0.6: TIMESCALES[0], 0.6: TIMESCALES[-1]}
"""Where the elbow is (rad), and which timescale is the best there (ticks)."""


@dataclass
class Told:
    """Predictions that tell by their value which timescale they are of."""

    sure: float = 0.9
    answers: Mapping[str, float] = field(default_factory=dict)
    timescales: tuple[float, ...] = TIMESCALES
    lost: bool = False

    def position(self, joint: int, timescale: float) -> float:
        return math.nan if self.lost else timescale / 100

    def confidence(self, joint: int, timescale: float) -> float:
        return self.sure

    def surprise(self, joint: int, timescale: float) -> float:
        return timescale

    def familiarity(self) -> float:
        return 1.0

    def answer(self, name: str) -> float:
        return self.answers.get(name, float("nan"))


SURE = Told()


def situation(
    elbow: float, moves: bool = True, active: int = SHOULDER, told: Told = SURE, stale: bool = False
) -> Situation:
    """One tick of a wearer who moves the selected joint, or rests."""
    fresh = Freshness.STALE if stale else Freshness.FRESH
    joints = [JointState(position, 0.0, 0.0, 12.0, 30.0, 0.0, fresh) for position in (0.0, elbow)]
    attended = active if moves else None
    return Situation(
        0.0, RATE, (0, 1), active, attended, float(moves), False, State(0.0, tuple(joints)), told
    )


def choice(by: str, timescale: float = 10.0, timescales: Sequence[float] = TIMESCALES) -> Choice:
    """What finds timescales for both joints, as yet without experience."""
    found = Choice("arm", SPECS, (SHOULDER, ELBOW), RATE, timescales, lambda d: TileCoder(d, 8, 0.25, 512))
    settings = AssistSettings(timescale=timescale, timescale_by=by)
    found.check(settings)
    found.adjust(settings)
    return found


def followed(chooser: Choice, elbow: float) -> float:
    """The prediction (rad) that stands at the timescale of the settings by the end of a motion."""
    expected = 0.0
    for _ in range(12):
        seen = chooser.look(situation(elbow))
        expected = seen.outlook.position(ELBOW, 10.0)
    chooser.look(situation(elbow, moves=False))
    return expected


def live(chooser: Choice, motions: int, reply: Callable[[float, float], None]) -> None:
    """Motions here and there; after each, `reply` is told what was followed and what would have been best."""
    for motion in range(motions):
        for elbow, best in PLACES.items():
            at = elbow + 0.1 * (motion % 3 - 1)
            reply(followed(chooser, at), best / 100)
