"""Somebody at a task: places that are reached and held, circuits, walls, and time that means nothing."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bentod.tasks.engine import UNSEEN, Engine, Happening
from tests.tasks.courses import BETWEEN, ONE, TICK, TWO, Somebody, maze, waypoints

INSIDE, BEHIND = (0.0, 0.2), (0.101, 0.2)
FLOATS = st.floats(allow_nan=True, allow_infinity=True, width=32)


def test_a_way_point_is_entered_and_held_for_three_seconds() -> None:
    somebody = Somebody(waypoints())
    assert somebody.kinds(BETWEEN, 1.0) == []
    assert somebody.stay(TWO, 2.9) == [Happening("entered", "2")]
    assert (somebody.engine.resting, somebody.engine.inside) == (True, True)
    assert somebody.engine.held == pytest.approx(0.96, abs=0.02)
    assert somebody.stay(TWO, 0.2) == [Happening("held", "2")]
    assert (somebody.engine.leg, somebody.engine.target.name) == (1, "1")


def test_a_way_point_is_reached_within_the_tolerance_of_both_joints() -> None:
    somebody = Somebody(waypoints())
    assert somebody.kinds((TWO[0] + 0.021, TWO[1])) == []
    assert somebody.kinds((TWO[0], TWO[1] - 0.021)) == []
    assert somebody.kinds((TWO[0] + 0.019, TWO[1] - 0.019)) == ["entered"]


def test_who_leaves_too_early_goes_on_as_in_the_thesis() -> None:
    somebody = Somebody(waypoints())
    somebody.stay(TWO, 1.0)
    assert somebody.kinds(BETWEEN, 1.0) == ["left"]
    assert somebody.kinds(TWO, 0.5) == ["returned"]
    assert somebody.kinds(BETWEEN, 1.0) == ["left", "held"]
    assert somebody.engine.lap.slips == 2


def test_who_leaves_too_early_begins_anew_where_the_task_says_so() -> None:
    somebody = Somebody(waypoints(restart=True))
    somebody.stay(TWO, 2.0)
    assert somebody.kinds(BETWEEN, 2.0) == ["left"]
    assert not somebody.engine.resting
    assert somebody.kinds(TWO, 2.9) == ["entered"]
    assert somebody.kinds(TWO, 0.2) == ["held"]


def test_a_circuit_takes_what_its_legs_and_rests_take() -> None:
    somebody = Somebody(waypoints())
    somebody.stay(BETWEEN, 2.0)
    somebody.stay(TWO, 3.1)
    somebody.stay(BETWEEN, 1.0)
    assert somebody.kinds(ONE, 3.1) == ["entered", "held", "circuit"]
    (lap,) = somebody.engine.laps
    assert lap.time == pytest.approx(9.1, abs=3 * TICK)
    assert lap.legs == pytest.approx((2.0, 1.1), abs=2 * TICK)
    assert lap.length == pytest.approx(2 * math.dist(BETWEEN, TWO) + math.dist(BETWEEN, ONE))
    assert (lap.number, lap.contacts, lap.slips, lap.paused, lap.unseen) == (1, 0, 0, 0, 0)
    assert (somebody.engine.lap.number, somebody.engine.leg) == (2, 0)


def test_the_trial_may_begin_when_the_start_was_held_and_waits_until_it_does() -> None:
    somebody = Somebody(waypoints(), begun=False)
    somebody.stay(TWO, 4.0)
    assert somebody.engine.phase == "approach"
    assert somebody.kinds(ONE, 3.1) == ["entered", "held", "ready"]
    assert somebody.kinds(TWO, 4.0) == []
    somebody.engine.begin(somebody.time)
    assert somebody.kinds(TWO, 0.1) == ["entered"]


def test_a_circuit_of_a_maze_ends_with_the_barrier_and_the_next_begins_with_a_rest() -> None:
    somebody = Somebody(maze(), begun=False)
    assert somebody.kinds((0.0, 0.005)) == ["entered", "ready"]
    somebody.engine.begin(somebody.time)
    assert somebody.kinds((0.0, 0.0), 1.1) == ["held"]
    somebody.stay(INSIDE, 1.0)
    assert somebody.kinds((0.04, 0.495), 1.1) == ["entered", "held"]
    assert somebody.kinds((0.06, 0.0), 0.5) == [], "beside what is felt"
    assert somebody.stay((0.0, 0.0)) == [Happening("entered", "green"), Happening("circuit", "green")]
    assert somebody.engine.resting
    assert somebody.engine.laps[0].legs == pytest.approx((1.0, 0.5), abs=3 * TICK)


def test_a_touch_that_bounces_is_one_contact_and_a_later_one_another() -> None:
    somebody = Somebody(maze())
    somebody.stay(INSIDE, 2.0)
    assert somebody.kinds(BEHIND, 1.0) == ["contact"]
    assert somebody.kinds(INSIDE, 0.2) == []
    assert somebody.kinds(BEHIND, 0.1) == []
    assert somebody.kinds(INSIDE, 1.0) == ["clear"]
    assert somebody.kinds(BEHIND) == ["contact"]
    assert somebody.engine.lap.contacts == somebody.engine.contacts == 2


def test_a_pause_is_counted_beside_the_time_that_goes_on() -> None:
    somebody = Somebody(waypoints())
    somebody.stay(BETWEEN, 1.0)
    assert somebody.kinds(BETWEEN, 2.0, paused=True) == ["paused"]
    assert somebody.kinds(BETWEEN, 1.0) == ["resumed"]
    assert somebody.engine.lap.paused == pytest.approx(2.0, abs=2 * TICK)
    assert somebody.engine.lap.time == pytest.approx(4.0, abs=2 * TICK)


def test_time_in_which_nobody_saw_the_arm_is_told_and_counted() -> None:
    somebody = Somebody(waypoints())
    somebody.stay(BETWEEN)
    somebody.time += 2.0
    assert somebody.kinds(BETWEEN) == ["unseen"]
    assert somebody.engine.lap.unseen == pytest.approx(2.0, abs=2 * TICK)


def test_a_position_that_is_no_number_is_as_good_as_not_seen() -> None:
    somebody = Somebody(waypoints())
    somebody.stay(BETWEEN)
    assert somebody.kinds((math.nan, 0.0), 2 * UNSEEN) == []
    assert somebody.kinds(BETWEEN) == ["unseen"]


def test_time_that_runs_backwards_changes_nothing() -> None:
    engine = Engine(waypoints())
    engine.step(10.0, ONE)
    assert engine.step(9.0, TWO) == []
    assert engine.inside


@given(st.lists(st.tuples(st.floats(-0.05, 1.0), FLOATS, FLOATS, st.booleans()), max_size=60), st.booleans())
def test_nothing_that_a_frame_can_say_breaks_the_count(
    steps: list[tuple[float, float, float, bool]], walls: bool
) -> None:
    engine, time = Engine(maze() if walls else waypoints()), 0.0
    engine.begin(time)
    for since, x, y, paused in steps:
        time += since
        engine.step(time, (x, y), paused)
        assert 0.0 <= engine.held <= 1.0
        assert engine.lap.paused + engine.lap.unseen <= engine.lap.time + 0.06


@given(st.lists(st.tuples(st.floats(-0.15, 0.15), st.floats(-0.1, 0.6)), max_size=120))
def test_contacts_are_as_many_as_begin_and_end_one_after_the_other(walk: list[tuple[float, float]]) -> None:
    somebody = Somebody(maze())
    edges = [
        happening.kind
        for position in walk
        for happening in somebody.stay(position, 0.2)
        if happening.kind in ("contact", "clear")
    ]
    assert edges.count("contact") == somebody.engine.contacts
    assert edges[::2] == ["contact"] * len(edges[::2])
    assert edges[1::2] == ["clear"] * len(edges[1::2])
    assert somebody.engine.touching is bool(len(edges) % 2)
