"""Frames of CANSimple as the protocol page has them: identifier = node << 5 | command, little-endian."""

import math
import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivers.can.cansimple import POLLS, CanSimple, names
from drivers.can.codec import (
    Bounds,
    Current,
    Disarmed,
    Estimate,
    Go,
    Heartbeat,
    Heat,
    Motion,
    Rest,
    Spin,
    Supply,
)
from drivers.can.link import Frame
from sim.can import frames

CODEC = CanSimple()
NODES = st.integers(0, 63)
FLOATS = st.floats(width=32, allow_nan=False, allow_infinity=False)


def told(*sent: Frame) -> list[tuple[int, str]]:
    """Identifiers, and data as it is printed."""
    return [(frame.id, frame.data.hex(" ")) for frame in sent]


def test_a_heartbeat_says_whether_the_motor_is_driven() -> None:
    idle = Frame(0x061, bytes.fromhex("00 00 00 00 01 00 00 00"))
    driven = Frame(0x061, bytes.fromhex("00 00 00 00 08 00 01 00"))
    assert CODEC.decode(idle) == (3, Heartbeat(False, ()))
    assert CODEC.decode(driven) == (3, Heartbeat(True, ()))


def test_a_heartbeat_names_its_errors() -> None:
    frame = Frame(0x001, bytes.fromhex("00 02 00 01 01 00 00 00"))
    assert CODEC.decode(frame) == (0, Heartbeat(False, ("DC_BUS_UNDER_VOLTAGE", "WATCHDOG_TIMER_EXPIRED")))


def test_a_disarm_reason_is_the_second_word_of_get_error() -> None:
    frame = Frame(0x7C3, bytes.fromhex("00 00 00 00 00 00 00 02"))
    assert CODEC.decode(frame) == (62, Disarmed(("ESTOP_REQUESTED",)))


@pytest.mark.parametrize(
    ("command", "data", "report"),
    [
        (0x09, "00 00 80 3f 00 00 00 c0", Estimate(1.0, -2.0)),
        (0x14, "00 00 00 00 00 00 c0 3f", Current(1.5)),
        (0x15, "00 00 f0 41 00 00 20 42", Heat(40.0)),
        (0x15, "00 00 f0 41 00 00 c0 7f", Heat(30.0)),
        (0x17, "00 00 40 41 00 00 00 3f", Supply(12.0)),
    ],
)
def test_numbers_are_read_as_the_manual_writes_them(command: int, data: str, report: object) -> None:
    assert CODEC.decode(Frame(1 << 5 | command, bytes.fromhex(data))) == (1, report)


def test_a_motor_without_a_sensor_of_its_own_is_as_hot_as_its_power_stage() -> None:
    assert CODEC.decode(Frame(0x15, struct.pack("<ff", 31.0, math.nan))) == (0, Heat(31.0))


def test_bits_that_the_manual_does_not_know_are_named_by_their_value() -> None:
    assert names(0x80000080) == ("ERROR_0x80", "ERROR_0x80000000")


def test_a_motor_is_pinned_with_its_limits_before_it_is_armed() -> None:
    bounds = Bounds(velocity=2.0, acceleration=4.0, current=10.0)
    assert told(*CODEC.prepare(3, bounds, 0.5), CODEC.arm(3, True)) == [
        (0x06F, "00 00 00 40 00 00 20 41"),
        (0x072, "00 00 80 40 00 00 80 40"),
        (0x06C, "00 00 00 3f 00 00 00 00"),
        (0x06B, "03 00 00 00 01 00 00 00"),
        (0x06C, "00 00 00 3f 00 00 00 00"),
        (0x067, "08 00 00 00"),
    ]


def test_a_velocity_begins_with_its_mode_and_goes_on_without() -> None:
    assert told(*CODEC.move(1, Spin(-1.0), Rest(0.0))) == [
        (0x02D, "00 00 00 00 00 00 00 00"),
        (0x02B, "02 00 00 00 01 00 00 00"),
        (0x02D, "00 00 80 bf 00 00 00 00"),
    ]
    assert told(*CODEC.move(1, Spin(0.0), Spin(-1.0))) == [(0x02D, "00 00 00 00 00 00 00 00")]


def test_a_position_is_a_trapezoid_at_its_speed() -> None:
    assert told(*CODEC.move(0, Go(1.0, 0.5), Spin(0.0))) == [
        (0x011, "00 00 00 3f"),
        (0x00B, "03 00 00 00 05 00 00 00"),
        (0x00C, "00 00 80 3f 00 00 00 00"),
    ]
    assert [id_ for id_, _ in told(*CODEC.move(0, Go(2.0, 0.5), Go(1.0, 0.5)))] == [0x011, 0x00C]


def test_what_was_told_last_being_unknown_all_of_it_is_told() -> None:
    motions: tuple[Motion, ...] = (Spin(1.0), Go(1.0, 1.0), Rest(1.0))
    for motion in motions:
        assert any(frame.id & 31 == 0x0B for frame in CODEC.move(5, motion, None))


def test_the_rest_is_short() -> None:
    assert told(CODEC.arm(3, False), CODEC.clear_errors(3), CODEC.estop(3)) == [
        (0x067, "01 00 00 00"),
        (0x078, "00"),
        (0x062, ""),
    ]
    assert CODEC.poll(3, 1) == Frame(0x063, b"", remote=True)


@given(st.integers(0, 0x7FF), st.binary(max_size=8), st.booleans())
def test_no_frame_is_too_strange(id_: int, data: bytes, remote: bool) -> None:
    found = CODEC.decode(Frame(id_, data, remote))
    if found is not None:
        assert len(data) == 8
        assert not remote
        assert found[0] == id_ >> 5


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_a_number_that_is_none_makes_the_frame_garbage(value: float) -> None:
    assert CODEC.decode(Frame(0x09, struct.pack("<ff", value, 0.0))) is None
    assert CODEC.decode(Frame(0x09, struct.pack("<ff", 0.0, value))) is None


@given(NODES, FLOATS, FLOATS)
def test_driver_and_simulator_agree_on_estimates(node: int, position: float, velocity: float) -> None:
    data = frames.ENCODER_ESTIMATES.pack(Pos_Estimate=position, Vel_Estimate=velocity)
    assert CODEC.decode(Frame(node << 5 | 9, data)) == (node, Estimate(position, velocity))


@given(NODES, FLOATS)
def test_driver_and_simulator_agree_on_inputs(node: int, value: float) -> None:
    spin, rest = CODEC.move(node, Spin(value), Spin(0)), CODEC.move(node, Rest(value), Rest(0))
    velocity = frames.INPUT_VEL.unpack(spin[-1].data)
    position = frames.INPUT_POS.unpack(rest[-1].data)
    assert velocity == {"Input_Vel": value, "Input_Torque_FF": 0.0}
    assert position == {"Input_Pos": value, "Vel_FF": 0.0, "Torque_FF": 0.0}
    assert {frame.id >> 5 for frame in (*spin, *rest)} == {node}


@given(st.integers(0, 2**32 - 1), st.integers(0, 2**32 - 1))
def test_driver_and_simulator_agree_on_errors(active: int, reason: int) -> None:
    data = frames.GET_ERROR.pack(Active_Errors=active, Disarm_Reason=reason)
    found = CODEC.decode(Frame(3, data))
    assert found == (0, Disarmed(names(reason)))
    assert len(names(reason)) == reason.bit_count()


def test_every_question_has_an_answer_that_is_understood() -> None:
    assert all(CODEC.decode(Frame(command, bytes(8))) is not None for command in POLLS)
