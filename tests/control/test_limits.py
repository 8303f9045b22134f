"""Limits of one joint: what leaves is within all of them, whatever was asked and wherever the joint is."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bentod.control.limiter import LEAST, JointLimiter, Sent
from bentod.control.limits import CRAWL, FALLEN, LEAST_SHARE, loaded, share_of_speed, speed_towards_limit
from bentod.frames import Bounds, Command, Freshness, JointSpec, JointState, Position, Stop, Velocity

PERIOD = 1 / 30
ANY = 1e6
"""Rad/s² at which there is no ramp."""
SPEC = JointSpec("elbow", -0.4, 0.8, 0.5, 0.0, {}, Bounds(acceleration=3.0))
STEP = SPEC.bounds.acceleration * PERIOD
ROUNDING = 1e-9


def at(position: float, load: float = 0.0, temperature: float = 30.0) -> JointState:
    return JointState(position, 0.0, load, 12.0, temperature, 0.0, Freshness.FRESH)


def after(*commands: Command, position: float = 0.0, spec: JointSpec = SPEC) -> list[Sent]:
    """What becomes of commands, one a tick, for a joint that stays where it is."""
    limiter = JointLimiter(spec)
    return [limiter.step(command, at(position), PERIOD) for command in commands]


def settled(command: Command, reading: JointState, spec: JointSpec = SPEC) -> Sent:
    """What becomes of a command once there has been time enough for any ramp."""
    limiter = JointLimiter(replace(spec, bounds=replace(spec.bounds, acceleration=ANY)))
    return limiter.step(command, reading, PERIOD)


def speeds(sent: Sequence[Sent]) -> list[float]:
    return [one.velocity for one in sent]


def test_a_velocity_is_cut_to_the_joints_maximum() -> None:
    assert settled(Velocity(3.0), at(0.0)) == Sent(Velocity(0.5), 0.5, "velocity")
    assert settled(Velocity(-3.0), at(0.0)) == Sent(Velocity(-0.5), -0.5, "velocity")


def test_what_is_within_every_limit_passes_and_says_so() -> None:
    assert settled(Velocity(0.3), at(0.0)) == Sent(Velocity(0.3), 0.3)
    assert settled(Position(0.5, 0.3), at(0.0)) == Sent(Position(0.5, 0.3), 0.3)


def test_at_a_limit_only_the_way_back_is_open() -> None:
    assert settled(Velocity(0.2), at(0.8)) == Sent(Stop(), limited="position")
    assert settled(Velocity(-0.2), at(0.8)).command == Velocity(-0.2)
    assert settled(Velocity(-0.2), at(-0.41)) == Sent(Stop(), limited="position")


def test_a_position_is_brought_into_the_limits_and_its_speed_too() -> None:
    assert settled(Position(2.0, 9.0), at(0.0)).command == Position(0.8, 0.5)
    assert settled(Position(2.0, 0.1), at(0.0)).limited == "position"


@pytest.mark.parametrize(
    "wish",
    [
        Velocity(math.nan),
        Velocity(-math.inf),
        Position(math.nan, 0.1),
        Position(0.1, math.nan),
        Position(0.1, math.inf),
    ],
)
def test_what_is_no_number_becomes_a_stop(wish: Command) -> None:
    assert settled(wish, at(0.0)) == Sent(Stop(), limited="not finite")


def test_a_joint_that_is_nowhere_is_stopped() -> None:
    assert settled(Velocity(0.1), at(math.nan)) == Sent(Stop(), limited="stale")
    assert settled(Position(0.1, 0.1), at(math.inf)) == Sent(Stop(), limited="stale")


def test_a_velocity_or_a_speed_of_zero_is_a_stop() -> None:
    assert settled(Velocity(0.0), at(0.0)) == Sent(Stop())
    assert settled(Position(0.1, 0.0), at(0.0)).command == Stop()


def test_stops_and_limp_joints_pass_as_they_are() -> None:
    assert settled(Stop(), at(0.0)) == Sent(Stop())
    limp = JointLimiter(SPEC).step(None, at(0.0), PERIOD)
    assert limp == Sent(None)


def test_a_joint_sets_off_and_turns_round_no_faster_than_its_acceleration_allows() -> None:
    sent = after(*[Velocity(0.25)] * 4, *[Velocity(-0.25)] * 6)
    assert speeds(sent) == pytest.approx([0.1, 0.2, 0.25, 0.25, 0, -0.1, -0.2, -0.25, -0.25, -0.25])
    assert sent[4] == Sent(Stop(), 0.0, "acceleration")
    assert [one.limited for one in sent[:4]] == ["acceleration", "acceleration", "", ""]


def test_a_joint_that_turns_slowly_does_not_go_on_the_old_way_for_long() -> None:
    limiter = JointLimiter(replace(SPEC, bounds=Bounds(acceleration=0.1)))
    for _ in range(200):
        limiter.step(Velocity(0.5), at(0.0), PERIOD)
    assert limiter.step(Velocity(-0.5), at(0.0), PERIOD).command == Stop()
    sent = [limiter.step(Velocity(-0.5), at(0.0), PERIOD) for _ in range(3)]
    assert speeds(sent) == pytest.approx([-0.1 * PERIOD * n for n in (1, 2, 3)])


def test_a_tremble_about_rest_passes_through_zero_without_a_stop() -> None:
    wishes = [Velocity(0.04), Velocity(-0.04), Velocity(0.04)]
    assert speeds(after(*wishes)) == pytest.approx([0.04, -0.04, 0.04])


@pytest.mark.parametrize("wish", [Velocity(1e-16), Velocity(-0.9 * LEAST), Position(0.5, 1e-16)])
def test_what_is_slower_than_any_servo_is_a_stop(wish: Command) -> None:
    sent = after(*[wish] * 3)[-1]
    assert (sent.command, sent.limited) == (Stop(), "too slow")


def test_a_joint_that_gathers_speed_ever_so_slowly_sets_off_all_the_same() -> None:
    limiter = JointLimiter(replace(SPEC, bounds=Bounds(acceleration=0.01)))
    sent = [limiter.step(Velocity(0.5), at(0.0), 0.001) for _ in range(200)]
    assert sent[0].command == Stop()
    assert sent[-1].velocity == pytest.approx(0.002)
    assert sent[-1].command == Velocity(sent[-1].velocity)


def test_a_joint_slows_down_no_faster_either() -> None:
    assert speeds(after(*[Velocity(0.5)] * 5, *[Velocity(0.05)] * 5)[5:]) == pytest.approx(
        [0.4, 0.3, 0.2, 0.1, 0.05]
    )


def test_a_stop_is_never_slowed_down_and_after_it_a_joint_sets_off_from_rest() -> None:
    sent = after(*[Velocity(0.5)] * 5, Stop(), Velocity(0.5))
    assert sent[5] == Sent(Stop())
    assert sent[6].velocity == pytest.approx(STEP)


def test_a_joint_that_was_limp_sets_off_from_rest() -> None:
    limiter = JointLimiter(SPEC)
    for command in (Velocity(0.5), None):
        limiter.step(command, at(0.0), 1.0)
    assert limiter.step(Velocity(0.5), at(0.0), PERIOD).velocity == pytest.approx(STEP)


def test_who_asks_makes_no_difference_to_how_smoothly_a_joint_goes_over() -> None:
    sent = after(*[Velocity(-0.5)] * 5, *[Position(0.5, 0.3)] * 9)
    assert speeds(sent[4:]) == pytest.approx([-0.5, 0, 0.1, 0.2, 0.3, 0.3, 0.3, 0.3, 0.3, 0.3], abs=1e-9)
    assert sent[5].command == Stop()
    assert isinstance(sent[-1].command, Position)


def test_a_tick_that_comes_late_has_more_time_and_one_that_comes_at_once_has_none() -> None:
    limiter = JointLimiter(SPEC)
    assert limiter.step(Velocity(0.5), at(0.0), 2 * PERIOD).velocity == pytest.approx(2 * STEP)
    assert limiter.step(Velocity(0.5), at(0.0), 0.0).velocity == pytest.approx(2 * STEP)


@dataclass
class Ideal:
    """A joint that does exactly what it is sent."""

    spec: JointSpec
    position: float

    def run(self, command: Command, seconds: float) -> list[Sent]:
        limiter = JointLimiter(self.spec)
        sent = []
        for _ in range(round(seconds / PERIOD)):
            sent.append(limiter.step(command, at(self.position), PERIOD))
            way = sent[-1].velocity * PERIOD
            if isinstance(sent[-1].command, Position):
                left = sent[-1].command.position - self.position
                way = max(-abs(left), min(abs(left), way))
            self.position += way
        return sent


@pytest.mark.parametrize("acceleration", [0.5, 3.0, 10.0, 100.0])
@pytest.mark.parametrize("zone", [0.0, 0.05, 0.3])
def test_a_joint_arrives_at_its_limit_at_a_crawl_without_braking_too_hard(
    acceleration: float, zone: float
) -> None:
    joint = Ideal(replace(SPEC, bounds=Bounds(acceleration=acceleration, soft_zone=zone)), 0.0)
    sent = joint.run(Velocity(0.5), 8.0)
    *moving, stopped = sent[: next(i for i, one in enumerate(sent) if one.command == Stop()) + 1]
    assert stopped.limited == "position"
    assert moving[-1].velocity <= CRAWL + acceleration * PERIOD
    assert joint.position <= SPEC.maximum + CRAWL * PERIOD + ROUNDING
    assert any(one.limited == "soft zone" for one in moving)


def test_away_from_a_limit_a_joint_is_free_in_its_soft_zone() -> None:
    assert settled(Velocity(-0.5), at(0.79)).command == Velocity(-0.5)
    assert settled(Velocity(0.5), at(0.79)).limited == "soft zone"


@pytest.mark.parametrize("goal", [0.8, 0.3, -0.4])
@pytest.mark.parametrize("acceleration", [0.5, 3.0, 100.0])
def test_a_position_is_reached_and_kept_without_swinging(goal: float, acceleration: float) -> None:
    joint = Ideal(replace(SPEC, bounds=Bounds(acceleration=acceleration)), 0.05)
    sent = joint.run(Position(goal, 0.5), 8.0)
    assert joint.position == pytest.approx(goal, abs=0.001)
    assert {type(one.command) for one in sent} == {Position}


@given(st.lists(st.floats(-0.002, 0.002), min_size=30), st.floats(0.5, 100))
def test_a_joint_that_rests_at_its_goal_is_not_sent_to_and_fro(
    noise: list[float], acceleration: float
) -> None:
    limiter = JointLimiter(replace(SPEC, bounds=Bounds(acceleration=acceleration)))
    sent = [limiter.step(Position(0.3, 0.5), at(0.3 + error), PERIOD) for error in noise]
    assert {type(one.command) for one in sent} == {Position}


def test_a_load_above_its_bound_bars_the_way_on_and_not_the_way_back() -> None:
    assert settled(Velocity(0.2), at(0.0, load=0.85)) == Sent(Stop(), limited="load")
    assert settled(Position(0.3, 0.2), at(0.0, load=0.85)) == Sent(Stop(), limited="load")
    assert settled(Velocity(-0.2), at(0.0, load=0.85)).command == Velocity(-0.2)
    assert settled(Velocity(-0.2), at(0.0, load=-0.85)).limited == "load"
    assert settled(Velocity(0.2), at(0.0, load=0.75)).command == Velocity(0.2)


def test_a_load_that_flickers_about_its_bound_does_not_make_the_joint_flicker() -> None:
    limiter = JointLimiter(SPEC)
    bound = SPEC.bounds.load
    loads = [bound + 0.01, bound - 0.01, bound + 0.01, FALLEN * bound + 0.01]
    assert {limiter.step(Velocity(0.2), at(0.0, load), PERIOD).limited for load in loads} == {"load"}
    assert limiter.step(Velocity(0.2), at(0.0, FALLEN * bound - 0.01), PERIOD).command == Velocity(STEP)


@given(st.sampled_from([-1, 0, 1]))
def test_a_load_that_is_not_known_changes_nothing(before: int) -> None:
    assert loaded(before, math.nan, 0.8) == before


def test_a_warm_joint_is_slower_the_warmer_it_is() -> None:
    warm, hot = SPEC.bounds.warm, SPEC.bounds.hot
    assert settled(Velocity(0.5), at(0.0, temperature=warm)).command == Velocity(0.5)
    half = settled(Velocity(0.5), at(0.0, temperature=(warm + hot) / 2))
    assert half.velocity == pytest.approx(0.3)
    assert half.limited == "warm"
    assert settled(Position(0.7, 0.5), at(0.0, temperature=hot)).velocity == pytest.approx(0.1)
    assert share_of_speed(SPEC, 200.0) == LEAST_SHARE
    assert share_of_speed(SPEC, math.nan) == 1.0


WISHES = st.one_of(
    st.none(),
    st.just(Stop()),
    st.builds(Velocity, st.floats() | st.floats(-1, 1)),
    st.builds(Position, st.floats() | st.floats(-1, 1), st.floats() | st.floats(0, 1)),
)
READINGS = st.builds(
    at,
    st.floats(-0.5, 0.9) | st.floats(),
    st.floats(-1, 1) | st.just(math.nan),
    st.floats(20, 90) | st.just(math.nan),
)
SPECS = st.builds(
    lambda *bounds: replace(SPEC, bounds=Bounds(*bounds)),
    st.floats(0.01, 1000),
    st.floats(0, 1),
    st.floats(0.01, 1),
    st.floats(20, 60),
    st.floats(61, 100),
)


@given(SPECS, st.lists(st.tuples(WISHES, READINGS, st.floats(0, 0.1)), max_size=40))
def test_nothing_beyond_any_limit_ever_leaves(
    spec: JointSpec, story: list[tuple[Command | None, JointState, float]]
) -> None:
    limiter = JointLimiter(spec)
    before = 0.0
    for wish, reading, elapsed in story:
        sent = limiter.step(wish, reading, elapsed)
        assert_within_limits(sent, spec, reading)
        assert_smooth(sent, before, spec, reading, elapsed)
        assert (sent.command is None) == (wish is None)
        assert sent.limited or isinstance(wish, Position) or sent.command == wish or wish == Velocity(0.0)
        before = sent.velocity


def assert_within_limits(sent: Sent, spec: JointSpec, reading: JointState) -> None:
    """Position, velocity and load."""
    velocity, position = sent.velocity, reading.position
    match sent.command:
        case Velocity(velocity=asked):
            assert asked == velocity != 0
            assert not (position >= spec.maximum and velocity > 0)
            assert not (position <= spec.minimum and velocity < 0)
        case Position(position=goal, speed=speed):
            assert spec.minimum <= goal <= spec.maximum
            assert speed == abs(velocity) > 0
            assert (goal - position) * velocity >= 0
        case _:
            assert abs(velocity) < LEAST
    assert abs(velocity) <= spec.max_velocity
    assert not (reading.load > spec.bounds.load and velocity > 0)
    assert not (reading.load < -spec.bounds.load and velocity < 0)


def assert_smooth(sent: Sent, before: float, spec: JointSpec, reading: JointState, elapsed: float) -> None:
    """Acceleration; and what the soft zone and the temperature ask, unless that would be a jerk."""
    change = spec.bounds.acceleration * elapsed
    if sent.velocity:
        assert abs(sent.velocity - before) <= change + ROUNDING * (1 + change)
    braked = abs(before) - change
    speed = abs(sent.velocity)
    left = spec.maximum - reading.position if sent.velocity > 0 else reading.position - spec.minimum
    assert speed <= max(braked, spec.max_velocity * share_of_speed(spec, reading.temperature)) + ROUNDING
    assert not sent.velocity or speed <= max(braked, speed_towards_limit(spec, left, 0.0)) + ROUNDING
