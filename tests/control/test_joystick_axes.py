"""From axes to efforts, and what must be seen before anything moves."""

import math
from collections.abc import Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bentod.config_joystick import Axis
from bentod.contracts import Pad
from bentod.control.joystick_axes import Sticks, at_rest, shaped

PLAIN = Axis(axis=0, group="arm", dead_zone=0.2)
HOLD = 1
"""The dead man's button."""

# value, dead zone, expo, invert, one-sided, share of the speed: effort. The page's own are held to the same.
LITERAL = [
    (0.0, 0.2, 0.0, False, False, 1.0, 0.0),
    (0.2, 0.2, 0.0, False, False, 1.0, 0.0),
    (0.6, 0.2, 0.0, False, False, 1.0, 0.5),
    (-0.6, 0.2, 0.0, False, False, 1.0, -0.5),
    (1.0, 0.2, 0.0, False, False, 1.0, 1.0),
    (0.6, 0.2, 1.0, False, False, 1.0, 0.125),
    (0.6, 0.2, 0.4, False, False, 1.0, 0.35),
    (0.6, 0.2, 0.0, True, False, 1.0, -0.5),
    (-1.0, 0.2, 0.4, True, False, 0.3, 0.3),
    (-1.0, 0.0, 0.0, False, True, 1.0, 0.0),
    (0.0, 0.0, 0.0, False, True, 1.0, 0.5),
    (1.0, 0.1, 0.5, True, True, 0.8, -0.8),
    (7.0, 0.0, 0.0, False, False, 1.0, 1.0),
    (math.nan, 0.0, 0.0, False, False, 1.0, 0.0),
    (math.inf, 0.0, 0.0, False, False, 1.0, 0.0),
]


@pytest.mark.parametrize(("value", "zone", "expo", "invert", "one_sided", "share", "effort"), LITERAL)
def test_an_axis_is_shaped_as_the_formula_says(
    value: float, zone: float, expo: float, invert: bool, one_sided: bool, share: float, effort: float
) -> None:
    axis = Axis(axis=0, group="arm", dead_zone=zone, expo=expo, invert=invert, one_sided=one_sided, max=share)
    assert shaped(value, axis) == pytest.approx(effort, abs=1e-12)


@given(
    st.floats(-1, 1),
    st.floats(-1, 1),
    st.floats(0, 0.9),
    st.floats(0, 1),
    st.floats(0.01, 1),
)
def test_more_push_is_never_less_effort_and_never_beyond_the_share(
    one: float, other: float, zone: float, expo: float, share: float
) -> None:
    axis = Axis(axis=0, group="arm", dead_zone=zone, expo=expo, max=share)
    low, high = sorted((one, other))
    assert -share - 1e-9 <= shaped(low, axis) <= shaped(high, axis) + 1e-12 <= share + 1e-9
    assert shaped(-one, axis) == -shaped(one, axis)


def test_what_is_no_number_is_not_at_rest() -> None:
    assert at_rest(0.1, PLAIN)
    assert not any(at_rest(value, PLAIN) for value in (0.5, math.nan, math.inf))


def pad(*axes: float, held: bool = False) -> Pad:
    return Pad(connected=True, axes=axes, buttons=(False, held))


def asked(sticks: Sticks, pads: Sequence[Pad]) -> list[float]:
    return [sticks.step(one).asked[0] for one in pads]


def test_nothing_moves_before_the_stick_was_at_rest_and_the_dead_man_let_go() -> None:
    sticks = Sticks([PLAIN], HOLD)
    assert asked(sticks, [pad(1.0, held=True), pad(0.0, held=True), pad(1.0, held=True)]) == [0, 0, 0]
    assert asked(sticks, [pad(1.0), pad(1.0, held=True)]) == [0, 0]
    assert asked(sticks, [pad(0.0), pad(0.0, held=True), pad(1.0, held=True)]) == [0, 0, 1]


def test_letting_the_dead_man_go_ends_it_in_the_same_look() -> None:
    sticks = Sticks([PLAIN], HOLD)
    assert asked(sticks, [pad(0.0), pad(0.0, held=True), pad(1.0, held=True), pad(1.0)]) == [0, 0, 1, 0]


def test_a_stick_that_is_wedged_when_the_dead_man_is_pressed_moves_nothing() -> None:
    sticks = Sticks([PLAIN], HOLD)
    asked(sticks, [pad(0.0)])
    assert asked(sticks, [pad(0.6), pad(0.6, held=True), pad(0.9, held=True)]) == [0, 0, 0]
    assert asked(sticks, [pad(0.0, held=True), pad(0.6, held=True)]) == [0, pytest.approx(0.5)]


def test_without_a_dead_man_the_stick_moves_as_soon_as_it_was_at_rest() -> None:
    assert asked(Sticks([PLAIN], None), [pad(1.0), pad(0.0), pad(1.0)]) == [0, 0, 1]


def test_an_axis_that_is_no_number_must_be_seen_at_rest_again() -> None:
    sticks = Sticks([PLAIN], None)
    assert asked(sticks, [pad(0.0), pad(1.0), pad(math.nan), pad(1.0)]) == [0, 1, 0, 0]


def test_all_axes_must_be_at_rest_at_the_same_time() -> None:
    sticks = Sticks([PLAIN, Axis(axis=1, joint="wrist")], HOLD)
    for one in (pad(0.0, 1.0), pad(1.0, 0.0)):
        sticks.step(one)
    assert sticks.waiting
    sticks.step(pad(0.0, 0.0))
    assert not sticks.waiting


def test_what_the_pad_does_not_have_is_named() -> None:
    sticks = Sticks([Axis(axis=4, group="arm")], HOLD)
    assert sticks.missing(pad(0.0)) == "The joystick has no axis 4, which the config names."
    assert "no button 1" in Sticks([PLAIN], HOLD).missing(Pad(connected=True, axes=(0.0,)))
    assert sticks.missing(pad(0, 0, 0, 0, 0)) == ""
