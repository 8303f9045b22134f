"""A predictor on two joints that move as they please, tick by tick."""

import math
from collections.abc import Callable, Collection

from bentod.config_learn import Gvf, Learn
from bentod.frames import EmgFrame, GroupFrame
from bentod.learn.horde import unhurried
from bentod.learn.predictor import Body, Predictor
from bentod.learn.signals import Percept
from tests.fakes import PERIOD, SPECS, at

BODY = Body(SPECS, (), {"arm": ["shoulder", "elbow"]}, 1 / PERIOD)
SMALL: dict[str, object] = {
    "joints": ("shoulder", "elbow"),
    "timescales": (5.0, 20.0),
    "tilings": 8,
    "memory": 64,
}
"""A representation of 65 features, of which up to 9 are active, and four questions of the arm."""

NO_EMG = EmgFrame(False, False, "", 0, 0.0, 0, {}, 0)


def new_predictor(**learn: object) -> Predictor:
    return Predictor(BODY, Learn.model_validate(SMALL | learn))


def gvf(**keys: object) -> Gvf:
    """The speed of the elbow, 20 ticks ahead, or what `keys` make of it."""
    return Gvf.model_validate({"name": "speed", "cumulant": "elbow.velocity", "timescale": 20.0} | keys)


def angles(tick: int) -> tuple[float, float]:
    """Where shoulder and elbow are (rad)."""
    return math.sin(tick / 9), 0.8 * math.cos(tick / 7)


def percept(tick: int, stale: Collection[int] = (), gap: bool = False) -> Percept:
    state = at(*angles(tick), velocity=math.cos(tick / 5) / 2, stale=tuple(stale), time=tick * PERIOD)
    group = GroupFrame("arm", ("shoulder", "elbow"), ("shoulder", "elbow")[tick // 40 % 2], 0.0, "")
    return Percept(tick, tick * PERIOD, gap, state, NO_EMG, (group,))


def live(
    predictor: Predictor,
    first: int,
    end: int,
    has_time: Callable[[], bool] = unhurried,
    every: int = 1,
) -> list[dict[str, float]]:
    """All newest predictions in each of the ticks, of which only every `every`-th comes to pass."""
    told = []
    for tick in range(first, end, every):
        predictor.see(percept(tick))
        predictor.step(has_time)
        told.append({q.name: predictor.newest(q.name) for q in predictor.horde.questions})
    return told


def without(told: list[dict[str, float]], *names: str) -> list[dict[str, float]]:
    """The same, but nothing of the questions `names`."""
    return [{name: value for name, value in tick.items() if name not in names} for tick in told]
