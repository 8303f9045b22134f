from bentod.control.health import Ladder
from bentod.frames import Freshness, JointSpec, JointState, State

LADDER = Ladder(hold=0.1, fault=0.5)
SPECS = [JointSpec(name, -1.0, 1.0, 1.0, 0.0, {}) for name in ("shoulder", "elbow")]


def _state(*ages: float, problem: str = "") -> State:
    joints = tuple(JointState(0.0, 0.0, 0.0, 12.0, 30.0, age, Freshness.STALE) for age in ages)
    return State(10.0, joints, problem)


def test_a_joint_that_misses_a_round_may_still_move() -> None:
    assert LADDER.too_old_to_move(_state(0.03, 0.07)) == frozenset()
    assert LADDER.reason_for_fault(_state(0.03, 0.07), SPECS) == ""


def test_a_joint_that_is_silent_for_longer_is_held_alone() -> None:
    assert LADDER.too_old_to_move(_state(0.0, 0.2)) == {1}
    assert LADDER.reason_for_fault(_state(0.0, 0.2), SPECS) == ""


def test_a_joint_that_stays_silent_is_a_fault_that_names_it() -> None:
    assert "elbow (0.60 s)" in LADDER.reason_for_fault(_state(0.0, 0.6), SPECS)


def test_when_all_are_silent_the_fault_does_not_list_them() -> None:
    assert "from any joint (0.70 s)" in LADDER.reason_for_fault(_state(0.7, 0.6), SPECS)


def test_the_fault_tells_what_is_wrong_with_the_bus() -> None:
    assert LADDER.reason_for_fault(_state(0.6, 0.6, problem="the port is gone"), SPECS).endswith(
        "the port is gone"
    )
