import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivers.dynamixel.stopping import StopRule, Travel, coast, lag, resting_place

SLOWEST = math.radians(0.684)
RULES: tuple[StopRule, ...] = ("full", "thesis", "last_position")

TRAVELS = st.builds(
    Travel,
    position=st.floats(-3, 3),
    previous=st.floats(-3, 3),
    velocity=st.floats(-3, 3),
    load=st.floats(-1, 1),
    delay=st.floats(0, 0.5),
    p_gain=st.floats(1, 254),
    acceleration=st.floats(0, 38),
)

MOVING = Travel(position=0.5, previous=0.48, velocity=0.8, load=0.2, delay=0.03)


@given(TRAVELS, st.sampled_from(RULES))
def test_no_rule_sends_a_moving_joint_back(travel: Travel, rule: StopRule) -> None:
    place = resting_place(travel, rule, SLOWEST)
    if abs(travel.velocity) >= 2 * SLOWEST:
        assert (place - travel.position) * travel.velocity >= 0


@given(TRAVELS, st.sampled_from(RULES))
def test_directions_are_alike(travel: Travel, rule: StopRule) -> None:
    mirrored = replace(
        travel,
        position=-travel.position,
        previous=-travel.previous,
        velocity=-travel.velocity,
        load=-travel.load,
    )
    assert resting_place(mirrored, rule, SLOWEST) == pytest.approx(-resting_place(travel, rule, SLOWEST))


def test_the_full_rule_adds_delay_lag_and_deceleration() -> None:
    travel = replace(MOVING, acceleration=4.0)
    expected = 0.5 + 0.8 * 0.03 + math.radians(11.33) * 0.2 + 0.8**2 / (2 * 4.0)
    assert resting_place(travel, "full", SLOWEST) == pytest.approx(expected)


def test_the_thesis_rule_goes_on_by_the_last_difference() -> None:
    assert resting_place(MOVING, "thesis", SLOWEST) == pytest.approx(0.52)


def test_the_last_position_is_what_it_says() -> None:
    assert resting_place(MOVING, "last_position", SLOWEST) == 0.5


def test_the_lag_has_the_sign_of_the_load_and_shrinks_with_the_gain() -> None:
    assert lag(0.5, 32) == pytest.approx(math.radians(5.665))
    assert lag(-0.5, 64) == pytest.approx(-math.radians(5.665) / 2)


def test_a_load_that_is_lowered_shortens_the_way_but_never_turns_it_round() -> None:
    lowering = replace(MOVING, load=-0.05)
    assert 0.5 < resting_place(lowering, "full", SLOWEST) < 0.5 + 0.8 * 0.03
    assert resting_place(replace(MOVING, load=-1.0), "full", SLOWEST) == 0.5


def test_a_joint_at_rest_keeps_hanging_from_its_reference() -> None:
    at_rest = replace(MOVING, velocity=SLOWEST, load=-0.2)
    assert resting_place(at_rest, "full", SLOWEST) < 0.5


def test_a_servo_without_a_profile_does_not_coast() -> None:
    assert coast(2.0, 0.0) == 0
    assert math.degrees(coast(math.radians(103), math.radians(257))) == pytest.approx(20.6, abs=0.1)
    assert coast(-1.0, 1.0) == -0.5
