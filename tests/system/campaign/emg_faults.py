"""Faults of the source of muscle signals."""

from typing import TypeVar

from sim.emg import Synthetic
from tests.system.campaign.case import Breaks, Case, Mends
from tests.system.campaign.outcome import DEAD_TIME, RESTING, ROUND, TICK, Bound
from tests.system.campaign.rig import RESTARTED, Rig

T = TypeVar("T")

SPEED = 0.8
"""rad/s, what full effort asks of the shoulder."""

STOPPED_AFTER = 0.1
"""s after the last sample that can be believed, when the arm has been told to stop (`bentod.config`)."""

STALL = Bound(STOPPED_AFTER + ROUND + DEAD_TIME + RESTING, "stall 60 + tick 33, round 17, servo 269", SPEED)

RELAXED = Bound(0.06 + TICK + ROUND + DEAD_TIME + RESTING, "window 60 + answer 320", SPEED)


def _source(rig: Rig) -> Synthetic:
    assert rig.source
    return rig.source


def becomes(attribute: str, broken: T, whole: T) -> tuple[Breaks, Mends]:
    """An attribute of the source while the fault lasts, and after it."""

    async def begin(rig: Rig) -> None:
        setattr(_source(rig), attribute, broken)

    async def end(rig: Rig) -> None:
        setattr(_source(rig), attribute, whole)

    return begin, end


def _case(fault: str, attribute: str, broken: T, whole: T, told: str) -> Case:
    return Case(fault, STALL, *becomes(attribute, broken, whole), told, by_muscles=True)


def _drifting(fault: str, share: float) -> Case:
    return Case(fault, RELAXED, *becomes("drift", share, 0.0), by_muscles=True, lasts=8.0)


SLOW = _drifting("EMG clock 1 % slow", -0.01)

CASES = (
    Case("EMG source ends", STALL, *becomes("end", True, False), "ended", (RESTARTED,), by_muscles=True),
    _case("EMG stalls", "stall", True, False, "No EMG sample"),
    _case("EMG stuck at one value", "stuck", {0: 50e-6}, {}, "stuck"),
    _case("EMG at the rails", "saturated", (0,), (), "saturated|stuck"),
    _case("EMG is NaN", "nan", True, False, "not a finite number"),
    _case("EMG 0.3 s late", "late", 0.3, 0.0, "EMG sample"),
    _drifting("EMG clock 1 % fast", 0.01),
    SLOW,
)
