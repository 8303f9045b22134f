import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivers.dynamixel.firmware1 import MX_28, MX_64, SPEED_STEP
from drivers.dynamixel.motion import Goal
from drivers.dynamixel.registers import from_raw
from drivers.dynamixel.tables import ALARM_SHUTDOWN, MODELS, ServoModel
from drivers.dynamixel.units import (
    acceleration,
    angle,
    error_names,
    goal_bytes,
    hardware_errors,
    moving_speed,
    reading,
    ticks,
)

ANY_FLOAT = st.floats(allow_nan=True, allow_infinity=True)
ANY_MODEL = st.sampled_from(list(MODELS.values()))
AX = MODELS["AX-12A"]
MX = MODELS["MX-28"]
MX2 = MODELS["MX-28(2.0)"]
MX2_64 = MODELS["MX-64(2.0)"]


@given(ANY_MODEL, st.integers(0, 4095))
def test_a_position_survives_the_way_to_radians_and_back(model: ServoModel, raw: int) -> None:
    raw = min(raw, model.last_tick)
    assert ticks(model, angle(model, raw)) == raw


@given(ANY_MODEL, st.floats(-10, 10))
def test_no_angle_leaves_the_range_of_the_model(model: ServoModel, value: float) -> None:
    assert 0 <= ticks(model, value) <= model.last_tick


@pytest.mark.parametrize(
    ("model", "centre", "quarter"), [(AX, 512, 307.2), (MX, 2048, 1024), (MX2, 2048, 1024)]
)
def test_the_centre_is_zero_and_counter_clockwise_is_positive(
    model: ServoModel, centre: int, quarter: float
) -> None:
    assert angle(model, centre) == 0
    assert ticks(model, math.pi / 2) == round(centre + quarter)
    assert ticks(model, -math.pi / 2) == round(centre - quarter)


def test_an_ax_reaches_300_degrees_and_not_a_turn() -> None:
    assert math.degrees(angle(AX, 0)) == pytest.approx(-150)
    assert math.degrees(angle(AX, 1023)) == pytest.approx(150, abs=0.3)


@given(ANY_MODEL, ANY_FLOAT)
def test_no_speed_becomes_zero_which_means_as_fast_as_possible(model: ServoModel, speed: float) -> None:
    assert 1 <= moving_speed(model, speed) <= model.layout.fastest


@given(ANY_MODEL, ANY_FLOAT, st.floats(-4, 4))
def test_no_goal_is_written_with_speed_zero(model: ServoModel, speed: float, position: float) -> None:
    data = goal_bytes(model, Goal(position, speed))
    half = len(data) // 2
    first, second = int.from_bytes(data[:half], "little"), int.from_bytes(data[half:], "little")
    place, raw = (first, second) if model.layout.protocol == 1 else (second, first)
    assert 0 <= place <= model.last_tick
    assert 1 <= raw <= model.layout.fastest


@given(ANY_MODEL, st.integers(1, 32767))
def test_a_speed_survives_the_way_to_radians_and_back(model: ServoModel, raw: int) -> None:
    raw = min(raw, model.layout.fastest)
    assert moving_speed(model, from_raw(model.table[model.layout.speed], raw)) == raw


@pytest.mark.parametrize(
    ("model", "rpm"), [("AX-12A", 0.111), ("MX-64", 0.114), ("MX-64(2.0)", 0.229), ("MX-106(2.0)", 0.229)]
)
def test_a_step_of_speed_is_that_of_the_manual(model: str, rpm: float) -> None:
    assert MODELS[model].speed_step == pytest.approx(rpm * 2 * math.pi / 60)


def test_the_bento_arms_speeds_are_those_of_its_profiles() -> None:
    assert moving_speed(MX, math.radians(45.8)) == 67
    assert moving_speed(MX, math.radians(30.8)) == 45
    assert goal_bytes(MX, Goal(0.0, math.radians(45.8))) == bytes.fromhex("00 08 43 00")


def test_firmware_2_is_told_its_speed_before_its_goal() -> None:
    goal = Goal(0.0, 45 * MX2.speed_step)
    assert goal_bytes(MX2, goal) == bytes.fromhex("2D 00 00 00 00 08 00 00")


@given(st.integers(0, 1023))
def test_speed_and_load_are_sign_and_magnitude(magnitude: int) -> None:
    for name in ("Present Speed", "Present Load"):
        step = MX_28[name].per_lsb
        assert from_raw(MX_28[name], magnitude) == pytest.approx(magnitude * step)
        assert from_raw(MX_28[name], magnitude + 1024) == pytest.approx(-magnitude * step)


def test_currents_and_offsets_have_signs_of_their_own() -> None:
    assert from_raw(MX_64["Current"], 2148) == pytest.approx(0.45)  # the manual's example
    assert from_raw(MX_28["Multi Turn Offset"], 0xFFFF) == pytest.approx(-MX_28["Multi Turn Offset"].per_lsb)


def test_only_no_acceleration_limit_is_written_as_zero() -> None:
    assert acceleration(MX, 0.0) == 0
    assert acceleration(MX, 1e-6) == 1
    assert acceleration(MX, math.radians(8.583 * 30)) == 30
    assert acceleration(MX, 1e6) == 254
    assert acceleration(MX2, math.radians(21.4577 * 30)) == 30
    assert acceleration(MX2, 1e9) == 32767


def test_a_window_is_understood() -> None:
    # Torque Limit 1023, position 2560, 100 clockwise, load 512 clockwise, 12.1 V, 41 degrees.
    found = reading(MX, 0, bytes.fromhex("FF 03 00 0A 64 04 00 06 79 29"))
    assert found
    assert found.position == pytest.approx(math.radians(45))
    assert found.velocity == pytest.approx(-100 * SPEED_STEP)
    assert found.load == pytest.approx(-512 / 1023)
    assert found.voltage == pytest.approx(12.1)
    assert found.temperature == 41
    assert found.errors == ()
    assert found.trajectory is None


def test_the_window_of_an_ax_is_the_same_in_its_own_units() -> None:
    found = reading(AX, 0, bytes.fromhex("FF 03 9A 02 64 00 00 02 79 29"))
    assert found
    assert found.position == pytest.approx(math.radians((666 - 512) * 300 / 1024))
    assert found.velocity == pytest.approx(100 * 0.111 * math.tau / 60)


FIRMWARE_2 = "9C FF  F6 FF FF FF  00 0C 00 00  F5 FF FF FF  F0 0B 00 00  7A 00  2A"
"""Load or current -100, velocity -10, position 3072, trajectory -11 and 3056, 12.2 V, 42 degrees."""


def test_a_window_of_firmware_2_is_understood_with_its_trajectory() -> None:
    found = reading(MX2, 0, bytes.fromhex(FIRMWARE_2))
    assert found
    assert found.position == pytest.approx(math.pi / 2)
    assert found.velocity == pytest.approx(-10 * 0.229 * math.tau / 60)
    assert found.load == pytest.approx(-0.1)
    assert found.voltage == pytest.approx(12.2)
    assert found.temperature == 42
    assert found.trajectory == pytest.approx((1008 * math.tau / 4096, -11 * 0.229 * math.tau / 60))


def test_an_mx_64_shows_current_which_is_a_share_of_its_stall_current() -> None:
    found = reading(MX2_64, 0, bytes.fromhex(FIRMWARE_2))
    assert found
    assert found.load == pytest.approx(-100 * 3.36e-3 / 4.1)


@given(ANY_MODEL, st.binary(min_size=21, max_size=21), st.integers(0, 255))
def test_whatever_a_window_says_no_reading_is_outside_the_sensors(
    model: ServoModel, data: bytes, error: int
) -> None:
    found = reading(model, error, data[: model.layout.windows[0].size])
    if found is not None:
        assert -1 <= found.load <= 1
        assert model.layout.protocol == 2 or 0 <= ticks(model, found.position) <= model.last_tick


@pytest.mark.parametrize(
    "impossible",
    ["00 04 00 08 00 00 00 00 78 1E", "FF 03 00 10 00 00 00 00 78 1E", "FF 03 00 08 00 08 00 00 78 1E"],
)
def test_what_no_servo_can_say_is_no_reading(impossible: str) -> None:
    assert reading(MX, 0, bytes.fromhex(impossible)) is None


def test_complaints_come_in_the_manuals_words() -> None:
    assert error_names(0b100101) == ("Input Voltage Error", "Overheating Error", "Overload Error")
    assert hardware_errors(0b111011) == (
        "Input Voltage Error", "Motor Encoder Error", "Electrical Shock Error", "Overload Error",
    )  # fmt: skip


def test_a_torque_limit_of_zero_is_reported_as_the_shutdown_that_it_is() -> None:
    found = reading(MX, 0b100000, bytes.fromhex("00 00 00 08 00 00 00 00 78 1E"))
    assert found
    assert found.errors == ("Overload Error", ALARM_SHUTDOWN)
