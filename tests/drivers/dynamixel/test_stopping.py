import math
from dataclasses import replace
from typing import get_args

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivers.dynamixel.stopping import RULES, StopRule, Travel, resting_place

SLOWEST = math.radians(0.684)
ALL: tuple[StopRule, ...] = get_args(StopRule)

TRAVELS = st.builds(
    Travel,
    position=st.floats(-3, 3),
    previous=st.floats(-3, 3),
    velocity=st.floats(-3, 3),
    reference=st.floats(-4, 4),
    rate=st.floats(-3, 3),
    acceleration=st.floats(0, 38),
)

MOVING = Travel(position=0.5, previous=0.48, velocity=0.8, reference=0.55, rate=0.8)


def test_every_rule_that_can_be_chosen_exists() -> None:
    assert set(ALL) == set(RULES)


@given(TRAVELS, st.sampled_from(ALL))
def test_no_rule_sends_a_moving_joint_back(travel: Travel, rule: StopRule) -> None:
    place = resting_place(travel, rule, SLOWEST)
    if abs(travel.velocity) >= 2 * SLOWEST:
        assert (place - travel.position) * travel.velocity >= 0


@given(TRAVELS, st.sampled_from(ALL))
def test_directions_are_alike(travel: Travel, rule: StopRule) -> None:
    mirrored = replace(
        travel,
        position=-travel.position,
        previous=-travel.previous,
        velocity=-travel.velocity,
        reference=-travel.reference,
        rate=-travel.rate,
    )
    assert resting_place(mirrored, rule, SLOWEST) == pytest.approx(-resting_place(travel, rule, SLOWEST))


def test_the_full_rule_stops_the_reference_where_it_will_be() -> None:
    assert resting_place(MOVING, "full", SLOWEST) == 0.55


def test_the_full_rule_lets_a_ramp_run_out() -> None:
    ramped = replace(MOVING, acceleration=4.0)
    assert resting_place(ramped, "full", SLOWEST) == pytest.approx(0.55 + 0.08)  # 0.8² / (2 · 4)


def test_the_thesis_rule_goes_on_by_the_last_difference() -> None:
    assert resting_place(MOVING, "thesis", SLOWEST) == pytest.approx(0.52)


def test_the_last_position_is_what_it_says() -> None:
    assert resting_place(MOVING, "last_position", SLOWEST) == 0.5


def test_a_reference_that_a_lowered_load_has_overtaken_does_not_turn_the_joint_round() -> None:
    assert resting_place(replace(MOVING, reference=0.45), "full", SLOWEST) == 0.5


def test_a_joint_at_rest_keeps_hanging_from_its_reference() -> None:
    at_rest = replace(MOVING, velocity=SLOWEST, reference=0.45, rate=0.0)
    assert resting_place(at_rest, "full", SLOWEST) == 0.45
