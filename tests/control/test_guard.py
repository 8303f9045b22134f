"""What readings mean: a joint that is hot rests, and one that is not fit is not armed."""

import math
from dataclasses import replace

import pytest

from bentod.control.arming import OUTSIDE, SAG
from bentod.control.heat import CERTAIN, COOLED, STEADY
from bentod.control.leases import Holder
from bentod.desk import Desk
from bentod.errors import Refused
from bentod.frames import Bounds, Freshness, JointState, Mode, State, Velocity
from tests.fakes import LADDER, at, desk_of

SHOULDER, ELBOW = 0, 1
BOUNDS = Bounds()
GOOD = at(0.5, 0.5).joints[ELBOW]


def seen(elbow: JointState, time: float = 0.0) -> State:
    """A reading with an elbow like this."""
    return replace(at(0.5, 0.5, time=time), joints=(GOOD, elbow))


def limp_at(elbow: JointState) -> Desk:
    """A limp arm, read just now."""
    desk = desk_of(torque=(False, False))
    desk.watch(seen(elbow), 0.0)
    return desk


@pytest.fixture
def desk() -> Desk:
    """Both joints released."""
    desk = desk_of()
    desk.watch(seen(GOOD), 0.0)
    desk.pause((SHOULDER, ELBOW), False)
    desk.journal.take()
    return desk


def warmed(desk: Desk, temperature: float, times: int = 1) -> list[str]:
    """What is told of an elbow that is so warm (degrees Celsius) in so many readings."""
    for _ in range(times):
        desk.watch(seen(replace(GOOD, temperature=temperature), time=1.0), 1.0)
    return [event.text for event in desk.journal.take()]


UNFIT = [
    (replace(GOOD, velocity=0.45), "elbow moves at 0.45 rad/s, bound 0.2 rad/s: hold it still, or wait"),
    (replace(GOOD, velocity=-0.45), "elbow moves at 0.45 rad/s, bound 0.2 rad/s"),
    (replace(GOOD, velocity=math.nan), "elbow moves at nan rad/s"),
    (
        replace(GOOD, position=1.2),
        r"elbow stands at 1.200 rad, 0.200 rad outside its limit of 1.000 rad, bound",
    ),
    (replace(GOOD, position=-1.2), "elbow stands at -1.200 rad, 0.200 rad outside its limit of -1.000 rad"),
    (replace(GOOD, temperature=66.0), "elbow is at 66 °C, bound 63 °C: let it cool"),
    (replace(GOOD, load=-0.9), "elbow bears 0.90 of its greatest torque, bound 0.8: take the load off"),
    (
        replace(GOOD, age=0.25, freshness=Freshness.STALE),
        "elbow was last read 0.25 s ago, bound 0.1 s: check",
    ),
    (replace(GOOD, position=math.nan), "elbow was last read 0.00 s ago"),
]


@pytest.mark.parametrize(("elbow", "why"), UNFIT)
def test_a_joint_that_is_not_fit_is_not_armed_and_nothing_else_is(elbow: JointState, why: str) -> None:
    desk = limp_at(elbow)
    with pytest.raises(Refused, match=f"not armed: {why}"):
        desk.torque((SHOULDER, ELBOW), True)
    assert desk.modes.wanted_torque == (False, False)
    assert not any(event.kind == "mode" for event in desk.journal.take())
    desk.torque((SHOULDER,), True)
    assert desk.modes.wanted_torque == (True, False)


@pytest.mark.parametrize(
    "elbow",
    [
        replace(GOOD, velocity=0.9 * SAG),
        replace(GOOD, position=1.0 + 0.9 * OUTSIDE),
        replace(GOOD, temperature=BOUNDS.hot - COOLED - 0.1),
        replace(GOOD, load=0.99 * BOUNDS.load, temperature=math.nan),
        replace(GOOD, age=0.09, freshness=Freshness.STALE),
    ],
)
def test_a_joint_that_is_within_its_bounds_is_armed(elbow: JointState) -> None:
    desk = limp_at(elbow)
    desk.torque((SHOULDER, ELBOW), True)
    assert desk.modes.wanted_torque == (True, True)


def test_every_joint_that_is_not_fit_is_named() -> None:
    desk = desk_of(torque=(False, False))
    desk.watch(at(2.0, 2.0), 0.0)
    with pytest.raises(Refused, match=r"shoulder stands at 2.000 rad.*; elbow stands at 2.000 rad"):
        desk.torque((SHOULDER, ELBOW), True)


def test_an_arm_that_was_never_read_or_not_for_a_while_is_not_armed() -> None:
    desk = desk_of(torque=(False, False))
    with pytest.raises(Refused, match="the arm has not been read yet"):
        desk.torque((ELBOW,), True)
    desk.watch(seen(GOOD), 0.0)
    desk.begin(LADDER.fault + 0.1)
    with pytest.raises(Refused, match=r"the arm was last read 0.60 s ago, bound 0.5 s"):
        desk.torque((ELBOW,), True)


def test_a_joint_that_has_torque_is_paused_by_torque_on_however_it_moves(desk: Desk) -> None:
    desk.watch(seen(replace(GOOD, velocity=0.5)), 0.0)
    desk.torque((ELBOW,), True)
    assert desk.modes.of(ELBOW) is Mode.PAUSED


def test_a_fault_is_named_before_what_else_is_wrong() -> None:
    desk = limp_at(replace(GOOD, velocity=0.45))
    desk.fault("smoke")
    with pytest.raises(Refused, match="smoke"):
        desk.torque((ELBOW,), True)


def test_torque_off_is_never_refused() -> None:
    desk = limp_at(replace(GOOD, velocity=0.45, temperature=99.0))
    desk.torque((SHOULDER, ELBOW), False)


def test_a_joint_that_becomes_warm_is_told_once_and_once_when_it_has_cooled(desk: Desk) -> None:
    assert warmed(desk, BOUNDS.warm - 0.5, 5) == []
    assert warmed(desk, BOUNDS.warm + 0.5, 5) == ["elbow is warm, 60 °C: slower from 60 °C on, limp at 68 °C"]
    assert warmed(desk, BOUNDS.warm - STEADY + 0.5, 5) == []
    assert warmed(desk, BOUNDS.warm + 0.5, 5) == []
    assert warmed(desk, BOUNDS.warm - STEADY, 5) == ["elbow has cooled to 58 °C"]
    assert desk.modes.fault == ""


def test_a_joint_that_is_hot_goes_limp_alone_and_the_fault_says_why(desk: Desk) -> None:
    warmed(desk, BOUNDS.hot, CERTAIN)
    assert desk.modes.fault == "too hot: elbow is at 68 °C (limp from 68 °C on); let it cool"
    assert desk.modes.wanted_torque == (True, False)


def test_a_reading_that_is_hot_by_mistake_lets_nothing_fall(desk: Desk) -> None:
    for _ in range(5):
        warmed(desk, 200.0, CERTAIN - 1)
        warmed(desk, 30.0)
    stale = replace(GOOD, temperature=200.0, freshness=Freshness.STALE, age=0.05)
    for _ in range(10):
        desk.watch(seen(stale), 1.0)
    assert desk.modes.fault == ""
    assert desk.modes.wanted_torque == (True, True)


def test_a_hot_joint_goes_limp_in_another_fault_too(desk: Desk) -> None:
    desk.fault("smoke")
    warmed(desk, 70.0, CERTAIN)
    assert desk.modes.fault == "smoke"
    assert desk.modes.wanted_torque == (True, False)


def test_after_heat_it_takes_a_cool_joint_a_clear_torque_and_a_release_to_move_again(desk: Desk) -> None:
    warmed(desk, 70.0, CERTAIN)
    desk.torque_confirmed((True, False))
    with pytest.raises(Refused, match="the cause is still there: too hot: elbow is at 70 °C"):
        desk.clear_fault()
    warmed(desk, 66.0)
    desk.clear_fault()
    assert (desk.modes.of(SHOULDER), desk.modes.of(ELBOW)) == (Mode.HOLDING, Mode.LIMP)
    with pytest.raises(Refused, match="torque is off on elbow"):
        desk.pause((ELBOW,), False)
    with pytest.raises(Refused, match="elbow is at 66 °C, bound 63 °C"):
        desk.torque((ELBOW,), True)
    warmed(desk, 50.0)
    desk.torque((ELBOW,), True)
    desk.torque_confirmed((True, True))
    with pytest.raises(Refused, match="elbow is holding: release it"):
        desk.move(ELBOW, Velocity(0.1), Holder(1, "ann"), 1.0)
    desk.pause((ELBOW,), False)
    desk.move(ELBOW, Velocity(0.1), Holder(1, "ann"), 1.0)
