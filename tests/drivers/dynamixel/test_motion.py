import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bentod.frames import Command, Freshness, JointSpec, JointState, Position, Stop, Velocity
from drivers.dynamixel.motion import Goal, JointMotion, Tuning

SPEC = JointSpec("elbow_flexion", -0.4, 0.8, 0.9, 0.0, {})
TUNING = Tuning()
MIDDLE = JointState(0.1, 0.0, 0.0, 12.0, 30.0, 0.002, Freshness.FRESH)
MOVING = replace(MIDDLE, velocity=0.5, load=0.1)

ANY_COMMAND: st.SearchStrategy[Command] = st.one_of(
    st.just(Stop()),
    st.builds(Velocity, st.floats()),
    st.builds(Position, st.floats(), st.floats()),
)
READINGS = st.builds(
    JointState,
    position=st.floats(-1, 1),
    velocity=st.floats(-2, 2),
    load=st.floats(-1, 1),
    voltage=st.just(12.0),
    temperature=st.just(30.0),
    age=st.floats(0, 100),
    freshness=st.sampled_from(Freshness),
)


def motion(tuning: Tuning = TUNING) -> JointMotion:
    return JointMotion(SPEC, tuning)


@given(st.lists(st.tuples(ANY_COMMAND, READINGS), min_size=1, max_size=10))
def test_every_goal_is_within_the_limits_and_has_a_speed(told: list[tuple[Command, JointState]]) -> None:
    joint = motion()
    for command, reading in told:
        goal = joint.command(command, reading)
        assert SPEC.minimum <= goal.position <= SPEC.maximum
        assert 0 < goal.speed <= SPEC.max_velocity


@given(st.lists(READINGS, min_size=1, max_size=10), ANY_COMMAND)
def test_a_stop_that_is_repeated_never_chases_the_joint(readings: list[JointState], before: Command) -> None:
    joint = motion()
    joint.command(before, MOVING)
    first = joint.command(Stop(), MOVING)
    assert all(joint.command(Stop(), reading) == first for reading in readings)


def test_a_velocity_is_the_limit_in_its_direction_and_a_speed() -> None:
    assert motion().command(Velocity(0.5), MIDDLE) == Goal(0.8, 0.5)
    assert motion().command(Velocity(-0.5), MIDDLE) == Goal(-0.4, 0.5)


def test_no_speed_exceeds_the_joints_maximum_or_falls_below_what_a_servo_can_do() -> None:
    assert motion().command(Velocity(5.0), MIDDLE).speed == 0.9
    assert motion().command(Velocity(1e-9), MIDDLE).speed == TUNING.slowest
    assert motion().command(Position(0.2, 5.0), MIDDLE) == Goal(0.2, 0.9)


def test_a_position_beyond_the_limits_ends_at_them() -> None:
    assert motion().command(Position(3.0, 0.2), MIDDLE) == Goal(0.8, 0.2)


def test_a_stop_goes_on_by_what_the_delays_cost() -> None:
    joint = motion()
    joint.command(Velocity(0.6), MOVING)
    goal = joint.command(Stop(), MOVING)
    ahead = 0.5 * (0.002 + TUNING.bus_time_s + TUNING.dead_time_s) + math.radians(11.33) * 0.1
    assert goal.position == pytest.approx(0.1 + ahead)
    assert goal.speed == 0.6


@pytest.mark.parametrize(
    "command",
    [Velocity(0.0), Velocity(math.nan), Velocity(math.inf), Position(math.nan, 0.1), Position(0.1, 0.0)],
)
def test_what_is_not_a_motion_is_a_stop(command: Command) -> None:
    joint, other = motion(), motion()
    joint.command(Velocity(0.5), MOVING)
    other.command(Velocity(0.5), MOVING)
    assert joint.command(command, MOVING) == other.command(Stop(), MOVING)


def test_the_rules_can_be_compared() -> None:
    earlier = replace(MOVING, position=0.08)
    stops = {}
    for rule in ("full", "thesis", "last_position"):
        joint = motion(Tuning(rule=rule))
        joint.command(Velocity(0.5), earlier)
        stops[rule] = joint.command(Stop(), MOVING).position
    assert stops["thesis"] == pytest.approx(0.12)
    assert stops["last_position"] == pytest.approx(0.1)
    assert stops["full"] > stops["thesis"]


def test_a_stop_on_the_way_to_a_position_never_leads_beyond_it() -> None:
    joint = motion()
    joint.command(Position(0.105, 0.5), MOVING)
    assert joint.command(Stop(), MOVING).position == pytest.approx(0.105)


def test_a_stop_close_to_a_limit_ends_at_the_limit() -> None:
    joint = motion()
    joint.command(Velocity(0.9), replace(MOVING, position=0.795))
    assert joint.command(Stop(), replace(MOVING, position=0.795)).position == 0.8


def test_moving_again_after_a_stop_ends_in_a_new_stop() -> None:
    joint = motion()
    joint.command(Velocity(0.5), MOVING)
    first = joint.command(Stop(), MOVING)
    joint.command(Velocity(0.5), MOVING)
    assert joint.command(Stop(), replace(MOVING, position=0.3)).position > first.position


def test_a_pinned_joint_stays_where_it_was_pinned() -> None:
    joint = motion()
    pinned = joint.pin(0.2)
    assert pinned == Goal(0.2, TUNING.pin_speed)
    assert joint.command(Stop(), replace(MIDDLE, position=0.19, load=0.3)) == pinned


def test_a_joint_just_outside_its_limits_is_pinned_at_them() -> None:
    assert motion().pin(0.81).position == 0.8


def test_the_first_stop_of_a_joint_that_was_found_holding_is_slow() -> None:
    goal = motion().command(Stop(), MIDDLE)
    assert goal == Goal(0.1, TUNING.pin_speed)


def test_an_old_reading_is_not_extrapolated_for_ever() -> None:
    joint = motion(Tuning(longest_age_s=0.1))
    joint.command(Velocity(0.5), MOVING)
    old = replace(MOVING, age=60.0, load=0.0)
    assert joint.command(Stop(), old).position == pytest.approx(0.1 + 0.5 * (0.1 + 0.019))
