import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivers.dynamixel.correction import LONGEST_DEAD_TIME, MEMORY, DeadTime, Sample, StartWatch, StopWatch

SLOWEST = math.radians(0.684)
TICK = math.tau / 4096


def sample(time: float, position: float, velocity: float = 0.0, reference: float | None = None) -> Sample:
    return Sample(time, position, velocity, 0.1, position if reference is None else reference, velocity)


def test_what_was_calibrated_stands_until_it_is_outvoted() -> None:
    dead_time = DeadTime(0.025, learning=True)
    dead_time.observe(0.05)
    assert dead_time.value == 0.025
    for _ in range(2):
        dead_time.observe(0.05)
    assert dead_time.value == 0.05


def test_a_wild_observation_changes_nothing() -> None:
    dead_time = DeadTime(0.02, learning=True)
    for seconds in (0.021, 0.09, 0.019, 0.0, 0.02):
        dead_time.observe(seconds)
    assert dead_time.value == 0.02


@given(st.lists(st.floats(), max_size=3 * MEMORY), st.floats(0, 0.2))
def test_a_learned_dead_time_is_bounded(observed: list[float], calibrated: float) -> None:
    dead_time = DeadTime(calibrated, learning=True)
    for seconds in observed:
        dead_time.observe(seconds)
    assert 0 <= dead_time.value <= LONGEST_DEAD_TIME or dead_time.value == calibrated


def test_learning_can_be_switched_off_and_begun_anew() -> None:
    stubborn, learner = DeadTime(0.02, learning=False), DeadTime(0.02, learning=True)
    for _ in range(MEMORY):
        stubborn.observe(0.05)
        learner.observe(0.05)
    assert stubborn.value == 0.02
    assert learner.value == 0.05
    learner.recalibrate(0.03)
    assert learner.value == 0.03
    learner.observe(0.05)
    assert learner.value == 0.03


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_start_tells_the_dead_time(sign: float) -> None:
    start = StartWatch(rest=0.3, sign=sign, tick=TICK)
    start.order(10.0, 0.4)
    start.order(10.1, 0.8)
    told = None
    for number in range(6):
        time = 10.0 + 0.033 * (number + 2)
        obeyed = time - 0.037 - 10.0  # s of orders; 0.4 rad/s for 0.1 s, then 0.8 rad/s
        way = 0.4 * min(obeyed, 0.1) + 0.8 * max(obeyed - 0.1, 0.0)
        told = told or start.see(sample(time, 0.0, reference=0.3 + sign * way))
    assert told == pytest.approx(0.037)


def test_a_short_start_tells_what_it_can() -> None:
    start = StartWatch(rest=0.0, sign=1.0, tick=TICK)
    start.order(10.0, 0.5)
    assert start.told() is None
    assert start.see(sample(10.1, 0.0, reference=0.04)) is None
    assert start.told() == pytest.approx(0.02)


def test_a_start_that_is_slow_or_held_tells_nothing() -> None:
    slow, held = StartWatch(0.0, 1.0, TICK), StartWatch(0.0, 1.0, TICK)
    slow.order(10.0, 0.1)
    held.order(10.0, 0.5)
    slow.see(sample(10.2, 0.0, reference=0.018))
    held.see(Sample(10.1, 0.0, 0.0, 0.9, 0.04, 0.0))
    assert slow.told() is None
    assert held.told() is None


def stop(goal: float, estimated: bool = True) -> StopWatch:
    return StopWatch("full", 10.0, 0.2, 1.0, 0.5, SLOWEST, TICK, goal=goal, estimated=estimated)


def test_a_stop_is_reported_when_the_joint_rests() -> None:
    watch = stop(0.25)
    assert watch.see(sample(10.03, 0.24, 0.5)) is None
    assert watch.see(sample(10.06, 0.27, 0.1)) is None
    for time in (10.1, 10.13):
        assert watch.see(sample(time, 0.25)) is None
    report = watch.see(sample(10.16, 0.25))
    assert report is not None
    assert (report.rule, report.time) == ("full", 10.0)
    assert report.travel == pytest.approx(0.05)
    assert report.bounce == pytest.approx(0.02)


def test_a_joint_that_falls_back_behind_its_start_has_negative_travel_and_a_bounce() -> None:
    watch = stop(0.2)
    for time in (10.1, 10.13, 10.16):
        report = watch.see(sample(time, 0.17))
    assert report is not None
    assert report.travel == pytest.approx(-0.03)
    assert report.bounce == pytest.approx(0.03)


def test_a_reference_seen_beyond_the_goal_was_stopped_too_late() -> None:
    watch = stop(0.25)
    watch.see(sample(10.03, 0.2, 0.5, reference=0.265))
    assert watch.lateness() == pytest.approx(0.03)  # 0.015 rad at 0.5 rad/s


def test_a_joint_that_swings_about_a_reference_that_stands_tells_nothing() -> None:
    watch = stop(0.25)
    watch.see(sample(10.03, 0.29, 0.5, reference=0.25))
    assert watch.lateness() == 0.0


def test_a_goal_that_was_not_an_estimate_tells_nothing() -> None:
    watch = stop(0.25, estimated=False)
    watch.see(sample(10.03, 0.2, 0.5, reference=0.3))
    assert watch.lateness() == 0.0
