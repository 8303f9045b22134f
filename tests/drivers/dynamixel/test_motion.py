import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bentod.frames import Command, Freshness, JointSpec, JointState, Position, Stop, Velocity
from drivers.dynamixel.deadman import SETTLING
from drivers.dynamixel.motion import Goal, JointMotion
from drivers.dynamixel.stopping import StopRule
from drivers.dynamixel.tuning import Tuning

SPEC = JointSpec("elbow_flexion", -0.4, 0.8, 0.9, 0.0, {})
TUNING = Tuning()
STEP = TUNING.slowest
SPEED = 42 * STEP  # 0.501 rad/s
MIDDLE = JointState(0.1, 0.0, 0.0, 12.0, 30.0, 0.002, Freshness.FRESH)
MOVING = replace(MIDDLE, velocity=0.5, load=0.1)
LEAD = math.radians(1.133)  # of the reference at a load of 0.1

RULES = st.sampled_from(["full", "thesis", "last_position", "creep"])
ANY_COMMAND: st.SearchStrategy[Command] = st.one_of(
    st.just(Stop()),
    st.builds(Velocity, st.floats()),
    st.builds(Position, st.floats(), st.floats()),
)
READINGS = st.builds(
    JointState,
    position=st.floats(-1, 1) | st.just(math.nan),
    velocity=st.floats(-2, 2) | st.just(math.inf),
    load=st.floats(-1, 1) | st.just(math.nan),
    voltage=st.just(12.0),
    temperature=st.just(30.0),
    age=st.floats(0, 100) | st.just(math.inf),
    freshness=st.sampled_from(Freshness),
)
TUNINGS = st.builds(
    Tuning, rule=RULES, dead_man=st.sampled_from([0.0, 0.3]), goal_acceleration=st.sampled_from([0.0, 5.0])
)


class Moved:
    """A joint that is told something once a tick, by readings of that tick."""

    def __init__(self, tuning: Tuning = TUNING) -> None:
        self.motion = JointMotion(SPEC, tuning)
        self.now = 100.0

    def tell(self, command: Command, reading: JointState, ticks: int = 1) -> Goal:
        for _ in range(ticks):
            self.now += 1 / 30
            goal = self.motion.command(command, reading, self.now)
        return goal


@given(st.lists(st.tuples(ANY_COMMAND, READINGS), min_size=1, max_size=10), TUNINGS)
def test_every_goal_is_within_the_limits_and_has_a_speed(
    told: list[tuple[Command, JointState]], tuning: Tuning
) -> None:
    joint = Moved(tuning)
    seen = [0.0]
    for command, reading in told:
        goal = joint.tell(command, reading)
        seen += [reading.position] if math.isfinite(reading.position) else []
        # No farther out than the joint has been seen: a stop holds it there and does not pull it in.
        assert min(SPEC.minimum, *seen) <= goal.position <= max(SPEC.maximum, *seen)
        assert 0 < goal.speed <= SPEC.max_velocity


@given(st.lists(READINGS, min_size=1, max_size=10), ANY_COMMAND)
def test_a_stop_that_is_repeated_never_chases_the_joint(readings: list[JointState], before: Command) -> None:
    joint = Moved()
    joint.tell(before, MOVING)
    first = joint.tell(Stop(), MOVING)
    assert all(joint.tell(Stop(), reading) == first for reading in readings)


@given(st.lists(st.tuples(st.floats(0.01, 0.9), st.floats(0, 0.01)), min_size=2, max_size=20))
def test_a_bounded_goal_never_turns_back_while_the_speed_does_not_fall(
    told: list[tuple[float, float]],
) -> None:
    joint = Moved(Tuning(dead_man=0.3))
    goals = [
        joint.tell(Velocity(speed), replace(MOVING, position=0.1 + noise)).position
        for (_, noise), speed in zip(told, sorted(speed for speed, _ in told), strict=True)
    ]
    assert goals == sorted(goals)


def test_a_velocity_is_the_limit_in_its_direction_and_a_speed() -> None:
    assert Moved().tell(Velocity(0.5), MIDDLE) == Goal(0.8, 0.5)
    assert Moved().tell(Velocity(-0.5), MIDDLE) == Goal(-0.4, 0.5)


def test_with_a_dead_man_a_motion_is_ordered_no_farther_than_it_may_go() -> None:
    joint = Moved(Tuning(dead_man=SETTLING + 0.1))
    joint.motion.pin(0.1)
    assert joint.tell(Velocity(0.5), MIDDLE).position == pytest.approx(0.15)
    assert joint.tell(Position(-0.3, 0.4), MIDDLE).position < 0.1


def test_a_bounded_motion_that_slows_down_is_bounded_anew() -> None:
    joint = Moved(Tuning(dead_man=SETTLING + 0.1))
    far = joint.tell(Velocity(0.9), MOVING, ticks=10).position
    assert joint.tell(Velocity(0.1), MOVING).position < far


def test_no_speed_exceeds_the_joints_maximum_or_falls_below_what_a_servo_can_do() -> None:
    assert Moved().tell(Velocity(5.0), MIDDLE).speed == 0.9
    assert Moved().tell(Velocity(1e-9), MIDDLE).speed == TUNING.slowest
    assert Moved().tell(Position(0.2, 5.0), MIDDLE) == Goal(0.2, 0.9)


def test_a_position_beyond_the_limits_ends_at_them() -> None:
    assert Moved().tell(Position(3.0, 0.2), MIDDLE) == Goal(0.8, 0.2)


def test_a_stop_goes_on_by_lag_and_delays() -> None:
    joint = Moved()
    joint.tell(Velocity(SPEED), MOVING, ticks=10)
    goal = joint.tell(Stop(), MOVING)
    delay = 0.002 + TUNING.bus_time_s + TUNING.dead_time_s
    assert goal.position == pytest.approx(0.1 + LEAD + SPEED * delay)
    assert goal.speed == SPEED


def test_a_stop_right_after_the_start_counts_only_what_was_ordered() -> None:
    joint = Moved(Tuning(dead_time_s=0.1))
    joint.motion.pin(0.1)
    joint.tell(Velocity(SPEED), MIDDLE)
    assert joint.tell(Stop(), MIDDLE).position == pytest.approx(0.1 + SPEED / 30)


def test_a_stop_after_a_change_of_speed_counts_each_speed_for_its_own_time() -> None:
    joint = Moved(Tuning(dead_time_s=0.048))
    joint.tell(Velocity(10 * STEP), MOVING, ticks=10)
    joint.tell(Velocity(40 * STEP), MOVING)
    goal = joint.tell(Stop(), replace(MOVING, age=0.0))
    # The sampling is 50 ms (bus and dead time) ahead of the stop: 16.7 ms slow, a tick of 33.3 ms fast.
    way = 10 * STEP * (0.05 - 1 / 30) + 40 * STEP / 30
    assert goal.position == pytest.approx(0.1 + LEAD + way)


def test_a_joint_that_is_back_from_silence_is_held_where_it_is_found() -> None:
    joint = Moved()
    joint.tell(Velocity(SPEED), MOVING)
    unheard = joint.tell(Stop(), MOVING)
    joint.motion.lose()
    found = replace(MIDDLE, position=0.3)
    assert unheard.position < 0.2
    assert joint.tell(Stop(), found).position == pytest.approx(0.3)
    assert joint.tell(Stop(), replace(found, position=0.31)).position == pytest.approx(0.3)


def test_firmware_2_shows_its_reference() -> None:
    joint = JointMotion(SPEC, TUNING)
    for tick in range(10):
        joint.command(Velocity(SPEED), MOVING, 100 + tick / 30, (0.11, SPEED))
    goal = joint.command(Stop(), MOVING, 100 + 10 / 30, (0.13, SPEED))
    assert goal.position == pytest.approx(0.13 + SPEED * (0.002 + TUNING.bus_time_s + TUNING.dead_time_s))


def test_a_ramp_on_firmware_2_runs_out() -> None:
    ramped = Tuning(goal_acceleration=4.0)
    joint = JointMotion(SPEC, ramped)
    for tick in range(10):
        joint.command(Velocity(SPEED), MOVING, 100 + tick / 30, (0.11, SPEED))
    goal = joint.command(Stop(), MOVING, 100 + 10 / 30, (0.13, SPEED))
    ahead = SPEED * (0.002 + TUNING.bus_time_s + TUNING.dead_time_s) + SPEED**2 / 8
    assert goal.position == pytest.approx(0.13 + ahead)


def test_a_joint_that_was_found_moving_goes_on_as_it_was_read() -> None:
    goal = Moved().tell(Stop(), MOVING)
    delay = 0.002 + TUNING.bus_time_s + TUNING.dead_time_s
    assert goal.position == pytest.approx(0.1 + LEAD + 0.5 * delay)
    assert goal.speed == TUNING.pin_speed


def test_a_stop_of_a_joint_that_is_held_adds_no_push() -> None:
    joint = Moved()
    held = replace(MIDDLE, load=0.6)
    joint.tell(Velocity(SPEED), held, ticks=10)
    assert joint.tell(Stop(), held).position == pytest.approx(0.1 + math.radians(11.33 * 0.6))


@pytest.mark.parametrize(
    "command",
    [Velocity(0.0), Velocity(math.nan), Velocity(math.inf), Position(math.nan, 0.1), Position(0.1, 0.0)],
)
def test_what_is_not_a_motion_is_a_stop(command: Command) -> None:
    joint, other = Moved(), Moved()
    joint.tell(Velocity(0.5), MOVING)
    other.tell(Velocity(0.5), MOVING)
    assert joint.tell(command, MOVING) == other.tell(Stop(), MOVING)


def test_the_rules_can_be_compared() -> None:
    stops: dict[StopRule, float] = {}
    rules: tuple[StopRule, ...] = ("full", "thesis", "last_position")
    for rule in rules:
        joint = Moved(Tuning(rule=rule))
        joint.tell(Velocity(0.5), replace(MOVING, position=0.08))
        stops[rule] = joint.tell(Stop(), MOVING).position
    assert stops["thesis"] == pytest.approx(0.12)
    assert stops["last_position"] == pytest.approx(0.1)
    assert stops["full"] > stops["thesis"]


def test_a_creeping_stop_slows_down_first_and_never_to_raw_0() -> None:
    joint = Moved(Tuning(rule="creep"))
    joint.tell(Velocity(0.5), MOVING, ticks=10)
    assert joint.tell(Stop(), MOVING, ticks=5) == Goal(0.8, TUNING.slowest)
    slow = replace(MOVING, velocity=TUNING.slowest, position=0.15)
    end = joint.tell(Stop(), slow)
    assert end.position == pytest.approx(0.15 + LEAD, abs=1e-3)
    assert joint.tell(Stop(), replace(slow, position=0.14)) == end


def test_a_creeping_joint_that_is_pushed_is_told_where_to_stay_after_all() -> None:
    joint = Moved(Tuning(rule="creep"))
    joint.tell(Velocity(0.5), MOVING, ticks=10)
    assert joint.tell(Stop(), MOVING, ticks=32).position < 0.8


def test_a_joint_that_swings_back_is_stopped_where_its_reference_is() -> None:
    joint = Moved()
    joint.tell(Velocity(SPEED), MOVING, ticks=10)
    swinging = replace(MOVING, velocity=-0.05)
    assert joint.tell(Stop(), swinging).position > 0.1 + LEAD


def test_a_stop_on_the_way_to_a_position_never_leads_beyond_it() -> None:
    joint = Moved()
    joint.tell(Position(0.105, 0.5), MOVING)
    assert joint.tell(Stop(), MOVING).position == pytest.approx(0.105)


def test_a_stop_close_to_a_limit_ends_at_the_limit() -> None:
    joint = Moved()
    joint.tell(Velocity(0.9), replace(MOVING, position=0.795))
    assert joint.tell(Stop(), replace(MOVING, position=0.795)).position == 0.8


def test_moving_again_after_a_stop_ends_in_a_new_stop() -> None:
    joint = Moved()
    joint.tell(Velocity(0.5), MOVING)
    first = joint.tell(Stop(), MOVING)
    joint.tell(Velocity(0.5), MOVING)
    assert joint.tell(Stop(), replace(MOVING, position=0.3)).position > first.position


def test_a_pinned_joint_stays_where_it_was_pinned() -> None:
    joint = Moved()
    pinned = joint.motion.pin(0.2)
    assert pinned == Goal(0.2, TUNING.pin_speed)
    assert joint.tell(Stop(), replace(MIDDLE, position=0.19, load=0.3)) == pinned


def test_a_joint_just_outside_its_limits_is_pinned_at_them() -> None:
    assert JointMotion(SPEC, TUNING).pin(0.81).position == 0.8


def test_the_first_stop_of_a_joint_that_was_found_holding_is_slow() -> None:
    goal = Moved().tell(Stop(), MIDDLE)
    assert goal == Goal(0.1, TUNING.pin_speed)


def test_an_old_reading_is_not_extrapolated_for_ever() -> None:
    joint = Moved(Tuning(longest_age_s=0.1))
    joint.tell(Velocity(SPEED), MOVING, ticks=10)
    old = replace(MOVING, age=60.0, load=0.0)
    # It is newer than none that was seen before, so it is taken to be 0.1 s old and no more.
    assert joint.tell(Stop(), old).position == pytest.approx(0.1 + SPEED * (0.1 + 0.019))


def test_a_recalibrated_joint_begins_anew() -> None:
    motion = JointMotion(SPEC, TUNING)
    assert motion.dead_time == TUNING.dead_time_s
    motion.recalibrate(0.04)
    assert motion.dead_time == 0.04


def test_a_stop_does_not_pull_in_a_joint_that_stands_outside_its_limits() -> None:
    motion = JointMotion(SPEC, TUNING)
    outside = SPEC.maximum + 0.3
    goal = motion.command(Stop(), replace(MIDDLE, position=outside), now=0.0)
    assert goal.position == pytest.approx(outside, abs=0.01)
