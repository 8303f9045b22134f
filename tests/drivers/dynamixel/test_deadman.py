import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bentod.errors import ConfigError
from drivers.dynamixel.deadman import SETTLING, TICKS_AHEAD, USUAL, bounded, chosen
from drivers.dynamixel.tuning import Tuning

TUNING = Tuning(dead_man=SETTLING + 0.1)


def test_the_goal_is_as_far_ahead_as_the_joint_goes_in_its_time() -> None:
    assert bounded(2.0, 0.3, 0.5, TUNING, None) == pytest.approx(0.35)
    assert bounded(-2.0, 0.3, -0.5, TUNING, None) == pytest.approx(0.25)


def test_a_ramp_needs_its_coast_besides() -> None:
    ramped = Tuning(dead_man=SETTLING + 0.1, goal_acceleration=5.0)
    assert bounded(2.0, 0.3, 0.5, ramped, None) == pytest.approx(0.35 + 0.025)  # 0.5² / (2 · 5)


def test_a_target_that_is_near_is_the_goal() -> None:
    assert bounded(0.31, 0.3, 0.5, TUNING, None) == 0.31


def test_the_slowest_motion_is_some_ticks_ahead() -> None:
    assert bounded(2.0, 0.3, 1e-3, TUNING, None) == pytest.approx(0.3 + TICKS_AHEAD * TUNING.tick)


@given(reference=st.floats(-3, 3), velocity=st.floats(-2, 2), last=st.floats(-3, 3), target=st.floats(-3, 3))
def test_no_goal_lies_behind_the_last_or_beyond_the_target(
    reference: float, velocity: float, last: float, target: float
) -> None:
    sign = math.copysign(1.0, velocity)
    goal = bounded(target, reference, velocity, TUNING, last)
    assert sign * goal <= sign * target + 1e-12
    assert sign * goal >= min(sign * last, sign * target) - 1e-12


def test_a_time_in_which_orders_could_come_too_late_is_refused() -> None:
    with pytest.raises(
        ConfigError, match=r"dead_man_s is 0.2, which must be at least 0.28 at 30 Hz"
    ) as error:
        chosen(0.2, 1 / 30)
    assert error.value.field == "dead_man_s"


def test_a_time_that_suffices_and_none_at_all_are_taken() -> None:
    assert chosen(0.29, 1 / 30) == 0.29
    assert chosen(0.0, 1 / 30) == 0.0


def test_what_nobody_chose_suits_the_rate() -> None:
    assert chosen(None, 1 / 30) == chosen(None, 1 / 100) == USUAL
    assert chosen(None, 0.1) == pytest.approx(0.3 + SETTLING)
