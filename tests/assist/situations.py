"""Situations of an assist, made by hand."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from bentod.contracts_assist import Assistance, Situation
from bentod.frames import Freshness, JointSpec, JointState, State, Velocity

PERIOD = 1 / 30
SHOULDER, ELBOW, WRIST = range(3)
SPECS = tuple(
    JointSpec(name, minimum=-1.5, maximum=1.5, max_velocity=top, home=0.0, hardware={})
    for name, top in (("shoulder", 2.0), ("elbow", 1.0), ("wrist", 2.0))
)


@dataclass
class Told:
    """An outlook that says what it is told to."""

    positions: Sequence[float] = (0.0, 0.0, 0.0)
    sure: float = 0.9
    known: float = 0.9
    answers: Mapping[str, float] = field(default_factory=dict)
    timescales: tuple[float, ...] = (20.0,)

    def position(self, joint: int, timescale: float) -> float:
        return self.positions[joint]

    def confidence(self, joint: int, timescale: float) -> float:
        return self.sure

    def surprise(self, joint: int, timescale: float) -> float:
        return 0.0

    def familiarity(self) -> float:
        return self.known

    def answer(self, name: str) -> float:
        return self.answers.get(name, float("nan"))


def situation(
    outlook: Told,
    now: float = 100.0,
    positions: Sequence[float] = (0.0, 0.0, 0.0),
    effort: float = 0.0,
    together: bool = False,
    attended: int | None = None,
    active: int = SHOULDER,
    joints: tuple[int, ...] = (SHOULDER, ELBOW),
    freshness: Freshness = Freshness.FRESH,
) -> Situation:
    seen = tuple(JointState(p, 0.0, 0.0, 12.0, 30.0, 0.0, freshness) for p in positions)
    return Situation(now, 30.0, joints, active, attended, effort, together, State(now, seen), outlook, "arm")


def velocities(helped: Assistance) -> dict[int, float]:
    return {j: wish.velocity for j, wish in helped.wishes.items() if isinstance(wish, Velocity)}
