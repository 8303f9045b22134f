import logging
from dataclasses import replace

import pytest

from bentod.errors import BusError, ConfigError
from bentod.frames import JointSpec
from drivers.dynamixel import protocol2
from drivers.dynamixel.joints import open_joints, open_over
from sim.clock import VirtualClock
from tests.drivers.dynamixel.arm import CONFIG, ELBOW, WRIST, Found, elbow, expect_audit, opened, read, wrist
from tests.drivers.dynamixel.wire import Wire, framed, status

ONE = replace(CONFIG, joints=(WRIST,))


async def refusal(wire: Wire, clock: VirtualClock, found: Found) -> str:
    """Why an arm with `found` as its wrist cannot be opened; what is not sent after it is not missed."""
    with pytest.raises(BusError) as caught:
        async with opened(wire, clock, found, config=ONE):
            pass
    return str(caught.value)


def expect_nobody(wire: Wire, id_: int) -> None:
    """A servo that answers in neither protocol, asked twice in each."""
    wire.expect(framed(id_, 2, 1), times=2)
    wire.expect(protocol2.read(id_, 0, 2), times=2)


async def test_a_good_arm_is_opened_and_nothing_is_written_to_it(wire: Wire, clock: VirtualClock) -> None:
    async with opened(wire, clock) as joints:
        assert wire.finished()
        assert joints.torque() == (False, False)
    assert wire.finished()


async def test_torque_is_reported_as_it_was_found(wire: Wire, clock: VirtualClock) -> None:
    async with opened(wire, clock, replace(elbow(), torque=1), wrist()) as joints:
        assert joints.torque() == (True, False)


async def test_a_servo_that_misses_one_question_is_asked_again(wire: Wire, clock: VirtualClock) -> None:
    wire.expect(framed(3, 2, 1))
    async with opened(wire, clock, wrist(), config=ONE):
        assert wire.finished()


async def test_every_absent_servo_is_named(wire: Wire, clock: VirtualClock) -> None:
    expect_nobody(wire, 2)
    expect_nobody(wire, 3)
    with pytest.raises(BusError) as caught:
        async with open_over(lambda: wire, CONFIG, clock):
            pass
    assert "Servo 2 (elbow_flexion) does not answer a ping" in str(caught.value)
    assert "Servo 3 (wrist_rotation) does not answer a ping" in str(caught.value)


async def test_another_model_is_refused_with_both_numbers(wire: Wire, clock: VirtualClock) -> None:
    text = await refusal(wire, clock, replace(wrist(), number=310))
    assert text.startswith("Servo 3 (wrist_rotation) has model number 310 (an MX-64)")
    assert "expects 29 (an MX-28)" in text


async def test_firmware_for_protocol_2_is_recognised(wire: Wire, clock: VirtualClock) -> None:
    assert "firmware for protocol 2.0" in await refusal(wire, clock, replace(wrist(), number=30))


async def test_wheel_mode_is_refused(wire: Wire, clock: VirtualClock) -> None:
    text = await refusal(wire, clock, replace(wrist(), cw=0, ccw=0))
    assert "Servo 3 (wrist_rotation) is in wheel mode" in text
    assert "set them to 1028 and 3073" in text


async def test_multi_turn_mode_is_refused(wire: Wire, clock: VirtualClock) -> None:
    assert "multi-turn mode" in await refusal(wire, clock, replace(wrist(), cw=4095, ccw=4095))


@pytest.mark.parametrize(("limit", "name", "needed"), [(1100, "CW", 1028), (3000, "CCW", 3073)])
async def test_limits_inside_the_configs_are_refused(
    limit: int, name: str, needed: int, wire: Wire, clock: VirtualClock
) -> None:
    found = replace(wrist(), cw=limit) if name == "CW" else replace(wrist(), ccw=limit)
    text = await refusal(wire, clock, found)
    assert f"has a {name} Angle Limit of {limit}" in text
    assert f"set it to {needed}" in text


async def test_a_servo_that_confirms_nothing_is_refused(wire: Wire, clock: VirtualClock) -> None:
    assert "Status Return Level of 1" in await refusal(wire, clock, replace(wrist(), level=1))


async def test_a_servo_that_only_answers_pings_is_refused(wire: Wire, clock: VirtualClock) -> None:
    wire.expect(framed(3, 2, 1), status(3))
    wire.expect(read(3, 0, 2), times=2)
    with pytest.raises(BusError, match="check its cable, and that its Status Return Level is not 0"):
        async with open_over(lambda: wire, ONE, clock):
            pass


@pytest.mark.parametrize(
    ("found", "complaint"),
    [
        (replace(elbow(), drive_mode=1), "Drive Mode of 1 and turns the wrong way"),
        (replace(elbow(), torque_mode=1), "Torque Ctrl Mode Enable set"),
    ],
)
async def test_an_mx_106_that_would_not_obey_goals_is_refused(
    found: Found, complaint: str, wire: Wire, clock: VirtualClock
) -> None:
    with pytest.raises(BusError, match=complaint):
        async with opened(wire, clock, found, config=replace(CONFIG, joints=(ELBOW,))):
            pass


async def test_a_servo_that_waits_before_replying_is_told_of_and_waited_for(
    wire: Wire, clock: VirtualClock, caplog: pytest.LogCaptureFixture
) -> None:
    with caplog.at_level(logging.WARNING):
        async with opened(wire, clock, replace(wrist(), delay=250), config=ONE) as joints:
            began = clock.now()
            wire.expect(read(3, 34, 10))
            await joints.read()
    assert clock.now() - began == pytest.approx(24 * 10e-6 + 500e-6 + 0.005)
    assert "Servo 3 (wrist_rotation) waits 500 µs" in caplog.text


async def test_a_line_that_goes_while_opening_is_what_the_error_says(wire: Wire, clock: VirtualClock) -> None:
    wire.gone = "The adapter was unplugged."
    with pytest.raises(BusError, match=r"^The adapter was unplugged\.$"):
        async with open_over(lambda: wire, CONFIG, clock):
            pass


@pytest.mark.parametrize(
    ("joints", "complaint"),
    [
        ((ELBOW, replace(WRIST, hardware={"id": 2, "model": "MX-28"})), "have the same servo id 2"),
        ((replace(WRIST, maximum=3.2),), "wrist_rotation is to move -89.6 to 183.3 degrees"),
        ((replace(WRIST, max_velocity=0.001),), "slowest an MX-28 moves is 0.0119 rad/s"),
        ((replace(WRIST, hardware={"id": 3}),), "model is missing"),
    ],
)
async def test_joints_that_cannot_be_are_refused_before_anything_is_sent(
    joints: tuple[JointSpec, ...], complaint: str, wire: Wire, clock: VirtualClock
) -> None:
    with pytest.raises(ConfigError, match=complaint):
        async with open_over(lambda: wire, replace(CONFIG, joints=joints), clock):
            pass


async def test_closing_sends_nothing_and_gives_the_line_back(wire: Wire, clock: VirtualClock) -> None:
    expect_audit(wire, replace(wrist(), torque=1))
    async with open_over(lambda: wire, ONE, clock):
        pass
    assert wire.finished()
    assert wire.closed


async def test_a_port_that_is_not_there_is_a_bus_error(clock: VirtualClock) -> None:
    with pytest.raises(BusError, match="no such port"):
        async with open_joints(replace(CONFIG, options={"port": "/nowhere/ttyUSB0"}), clock):
            pass
