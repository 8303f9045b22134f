import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivers.dynamixel.motion import Goal
from drivers.dynamixel.tables import ALARM_SHUTDOWN, MODELS, MX_28, SPEED_STEP
from drivers.dynamixel.units import (
    acceleration,
    angle,
    error_names,
    from_raw,
    goal_bytes,
    moving_speed,
    reading,
    ticks,
)  # fmt: skip

ANY_FLOAT = st.floats(allow_nan=True, allow_infinity=True)


@given(st.integers(0, 4095))
def test_a_position_survives_the_way_to_radians_and_back(raw: int) -> None:
    assert ticks(angle(raw)) == raw


@given(st.floats(-10, 10))
def test_no_angle_leaves_the_turn(value: float) -> None:
    assert 0 <= ticks(value) <= 4095


def test_the_centre_is_zero_and_counter_clockwise_is_positive() -> None:
    assert angle(2048) == 0
    assert angle(3072) == pytest.approx(math.pi / 2)
    assert angle(1024) == pytest.approx(-math.pi / 2)


@given(ANY_FLOAT)
def test_no_speed_becomes_zero_which_means_as_fast_as_possible(speed: float) -> None:
    assert 1 <= moving_speed(speed) <= 1023


@given(ANY_FLOAT, st.floats(-4, 4))
def test_no_goal_is_written_with_speed_zero(speed: float, position: float) -> None:
    data = goal_bytes(Goal(position, speed))
    assert 0 <= int.from_bytes(data[:2], "little") <= 4095
    assert 1 <= int.from_bytes(data[2:], "little") <= 1023


@given(st.integers(1, 1023))
def test_a_speed_survives_the_way_to_radians_and_back(raw: int) -> None:
    assert moving_speed(from_raw(MX_28["Moving Speed"], raw)) == raw


def test_the_bento_arms_speeds_are_those_of_its_profiles() -> None:
    assert moving_speed(math.radians(45.8)) == 67
    assert moving_speed(math.radians(30.8)) == 45
    assert goal_bytes(Goal(0.0, math.radians(45.8))) == bytes.fromhex("00 08 43 00")


@given(st.integers(0, 1023))
def test_speed_and_load_are_sign_and_magnitude(magnitude: int) -> None:
    for name in ("Present Speed", "Present Load"):
        step = MX_28[name].per_lsb
        assert from_raw(MX_28[name], magnitude) == pytest.approx(magnitude * step)
        assert from_raw(MX_28[name], magnitude + 1024) == pytest.approx(-magnitude * step)


def test_currents_and_offsets_have_signs_of_their_own() -> None:
    current = MODELS["MX-64"].table["Current"]
    assert from_raw(current, 2148) == pytest.approx(0.45)  # the manual's example
    assert from_raw(MX_28["Multi Turn Offset"], 0xFFFF) == pytest.approx(-MX_28["Multi Turn Offset"].per_lsb)


def test_only_no_acceleration_limit_is_written_as_zero() -> None:
    assert acceleration(0.0) == 0
    assert acceleration(1e-6) == 1
    assert acceleration(math.radians(8.583 * 30)) == 30
    assert acceleration(1e6) == 254


def test_a_window_is_understood() -> None:
    # Torque Limit 1023, position 2560, 100 clockwise, load 512 clockwise, 12.1 V, 41 degrees.
    found = reading(0, bytes.fromhex("FF 03 00 0A 64 04 00 06 79 29"))
    assert found.position == pytest.approx(math.radians(45))
    assert found.velocity == pytest.approx(-100 * SPEED_STEP)
    assert found.load == pytest.approx(-512 / 1023)
    assert found.voltage == pytest.approx(12.1)
    assert found.temperature == 41
    assert found.errors == ()


def test_complaints_come_in_the_manuals_words() -> None:
    assert error_names(0b100101) == ("Input Voltage Error", "Overheating Error", "Overload Error")


def test_a_torque_limit_of_zero_is_reported_as_the_shutdown_that_it_is() -> None:
    found = reading(0b100000, bytes.fromhex("00 00 00 08 00 00 00 00 78 1E"))
    assert found.errors == ("Overload Error", ALARM_SHUTDOWN)
