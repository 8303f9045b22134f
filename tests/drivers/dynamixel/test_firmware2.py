"""Servos of protocol 2.0 on the wire: audit, torque, rounds, the watchdog, alarms."""

import logging
import math
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import replace

import pytest

from bentod.contracts import ArmConfig
from bentod.errors import BusError
from bentod.frames import Freshness, Stop, Velocity
from drivers.dynamixel.joints import DynamixelJoints, open_over
from drivers.dynamixel.tables import HARDWARE_ALERT, WATCHDOG
from sim.clock import VirtualClock
from tests.drivers.dynamixel.arm2 import (
    ELBOW_2,
    ONE_2,
    RUNS,
    WRIST_2,
    Found2,
    config2,
    elbow2,
    expect_audit2,
    expect_read2,
    expect_write2,
    read2,
    sync_read2,
    window2,
    wrist2,
    write2,
)
from tests.drivers.dynamixel.wire import Wire, framed, status, word
from tests.drivers.dynamixel.wire2 import framed2, long, status2
from tests.fakes import cleared

BOTH = config2(ELBOW_2, WRIST_2)
USUAL, NEXT = (126, 21), (124, 23)
ALERT = 0x80


@asynccontextmanager
async def opened2(
    wire: Wire, clock: VirtualClock, *found: Found2, config: ArmConfig = ONE_2
) -> AsyncIterator[DynamixelJoints]:
    for servo in found:
        expect_audit2(wire, servo)
    if len(found) > 1:
        replies = (status2(servo.id, *window2(servo.position)) for servo in found)
        wire.expect(sync_read2(USUAL, *(servo.id for servo in found)), *replies)
    async with open_over(lambda: wire, config, clock) as joints:
        yield joints


async def refusal(wire: Wire, clock: VirtualClock, found: Found2) -> str:
    with pytest.raises(BusError) as caught:
        async with opened2(wire, clock, found):
            pass
    return str(caught.value)


def expect_torque_on(wire: Wire, id_: int, watchdog: int = 0) -> None:
    wire.expect(read2(id_, *USUAL), status2(id_, *window2()))
    expect_write2(wire, id_, 98, b"\x00")
    expect_write2(wire, id_, 84, bytes(word(850)))
    expect_write2(wire, id_, 108, long(0))
    expect_write2(wire, id_, 112, long(5) + long(2048))
    expect_write2(wire, id_, 98, bytes((watchdog,)))
    expect_write2(wire, id_, 64, b"\x01")
    wire.expect(read2(id_, 64, 1), status2(id_, 1))


async def test_a_good_servo_is_opened_and_nothing_is_written_to_it(wire: Wire, clock: VirtualClock) -> None:
    async with opened2(wire, clock, wrist2()) as joints:
        assert joints.torque() == (False,)
    assert wire.finished()


@pytest.mark.parametrize(
    ("changed", "complaint"),
    [
        ({11: b"\x01"}, "has an Operating Mode of 1; set it to 3"),
        ({10: b"\x01"}, "has a Drive Mode of 1 and turns the wrong way"),
        ({10: b"\x04"}, "takes speeds for times"),
        ({20: long(-5)}, "has a Homing Offset of -5"),
        ({44: long(40)}, "has a Velocity Limit of 40 (0.96 rad/s), less than the config's maximum of 1.08"),
        ({48: long(3000)}, "has a Max Position Limit of 3000"),
        ({52: long(1100)}, "has a Min Position Limit of 1100"),
        (
            {63: b"\x10"},
            "would not protect itself after an Overheating Error and Overload Error; set",
        ),
        ({68: b"\x01"}, "has a Status Return Level of 1"),
    ],
)
async def test_a_servo_that_is_set_up_otherwise_is_refused_and_left_as_it_is(
    changed: dict[int, bytes], complaint: str, wire: Wire, clock: VirtualClock
) -> None:
    assert complaint in await refusal(wire, clock, replace(wrist2(), changed=changed))


async def test_firmware_for_the_other_protocol_is_named_on_both_sides(
    wire: Wire, clock: VirtualClock
) -> None:
    wire.expect(framed2(3, 1), times=2)
    wire.expect(framed(3, 4, 2, 0, 2), status(3, *word(29)))
    with pytest.raises(BusError, match=r"speaks protocol 1\.0, as model number 29 \(an MX-28\)") as caught:
        async with open_over(lambda: wire, ONE_2, clock):
            pass
    assert "the config expects an MX-28(2.0), which speaks 2.0" in str(caught.value)


async def test_one_sync_read_is_all_that_a_round_needs(wire: Wire, clock: VirtualClock) -> None:
    async with opened2(wire, clock, elbow2(), wrist2(), config=BOTH) as joints:
        await clock.sleep_until(clock.now() + 0.1)
        replies = status2(2, *window2(2304, 155, -40)), status2(3, *window2(2100, -500, 10))
        wire.expect(sync_read2(USUAL, 2, 3), *replies)
        state = await joints.read()
    elbow, wrist = state.joints
    assert elbow.position == pytest.approx(math.radians(22.5))
    assert elbow.velocity == pytest.approx(-40 * 0.229 * math.tau / 60)
    assert elbow.load == pytest.approx(155 * 3.36e-3 / 5.2)
    assert wrist.load == pytest.approx(-0.5)
    assert (wrist.voltage, wrist.temperature, wrist.errors) == (12.0, 31.0, ())
    assert {joint.freshness for joint in state.joints} == {Freshness.FRESH}


async def test_a_reply_to_the_last_round_is_no_reply_to_this_one(wire: Wire, clock: VirtualClock) -> None:
    async with opened2(wire, clock, wrist2()) as joints:
        wire.expect(read2(3, *USUAL))
        await joints.read()
        await clock.sleep_until(clock.now() + 0.02)
        wire.expect(read2(3, *NEXT), status2(3, *window2(1900)), status2(3, 0, 0, *window2(2060)))
        wire.expect(read2(3, 64, 1), status2(3, 0))
        state = await joints.read()
    assert state.joints[0].position == pytest.approx(12 * math.tau / 4096)


async def test_servos_that_cannot_be_read_together_are_read_one_by_one_for_good(
    wire: Wire, clock: VirtualClock, caplog: pytest.LogCaptureFixture
) -> None:
    expect_audit2(wire, elbow2())
    expect_audit2(wire, wrist2())
    wire.expect(sync_read2(USUAL, 2, 3))
    wire.expect(sync_read2(NEXT, 2, 3), status2(3, 0, 0, *window2()))
    with caplog.at_level(logging.WARNING):
        async with open_over(lambda: wire, BOTH, clock) as joints:
            assert "Servo 2 (elbow_flexion), Servo 3 (wrist_rotation) do not all answer" in caplog.text
            for _ in range(2):
                wire.expect(read2(2, 123, 24), status2(2, 0, 0, 0, *window2()))
                wire.expect(read2(3, 123, 24), status2(3, 0, 0, 0, *window2()))
                state = await joints.read()
    assert wire.finished()
    assert {joint.freshness for joint in state.joints} == {Freshness.FRESH}


async def test_torque_on_sets_gain_profile_goal_and_watchdog_before_it_enables(
    wire: Wire, clock: VirtualClock
) -> None:
    config = replace(ONE_2, options={**ONE_2.options, "dead_man_s": 0.31})
    async with opened2(wire, clock, wrist2(), config=config) as joints:
        expect_torque_on(wire, 3, watchdog=16)  # 0.32 s
        await joints.set_torque([True])
        assert joints.torque() == (True,)
    assert wire.finished()


async def test_one_sync_write_gives_speed_and_goal(wire: Wire, clock: VirtualClock) -> None:
    on = {64: b"\x01"}
    async with opened2(
        wire, clock, replace(elbow2(), changed=on), replace(wrist2(), changed=on), config=BOTH
    ) as joints:
        elbow, wrist = long(10) + long(2570), long(5) + long(2048)
        wire.expect(framed2(0xFE, 0x83, 112, 0, 8, 0, 2, *elbow, 3, *wrist))
        await joints.write([Velocity(10 * 0.229 * math.tau / 60), Stop()])
    assert wire.finished()


async def test_an_alert_is_asked_for_its_cause_and_for_the_torque_that_is_gone(
    wire: Wire, clock: VirtualClock
) -> None:
    async with opened2(wire, clock, replace(wrist2(), changed={64: b"\x01"})) as joints:
        wire.expect(read2(3, *USUAL), status2(3, *window2(), error=ALERT))
        wire.expect(read2(3, 64, 1), status2(3, 0, error=ALERT), times=2)
        wire.expect(read2(3, 70, 1), status2(3, 0x20, error=ALERT))
        state = await joints.read()
        assert joints.torque() == (False,)
    assert state.joints[0].errors == ("Overload Error",)
    assert state.joints[0].shut_down
    assert wire.finished()


async def test_an_alert_whose_cause_is_not_known_yet_is_one_too(wire: Wire, clock: VirtualClock) -> None:
    async with opened2(wire, clock, wrist2()) as joints:
        wire.expect(read2(3, *USUAL), status2(3, *window2(), error=ALERT))
        wire.expect(read2(3, 64, 1), status2(3, 0, error=ALERT))
        wire.expect(read2(3, 70, 1))
        state = await joints.read()
    assert state.joints[0].errors == (HARDWARE_ALERT,)


async def test_causes_are_asked_for_in_turn_one_a_round(wire: Wire, clock: VirtualClock) -> None:
    asked = []
    async with opened2(wire, clock, elbow2(), wrist2(), config=BOTH) as joints:
        for tick in range(4):
            await clock.sleep_until(clock.now() + 0.02)
            both = (status2(id_, *window2(), error=ALERT) for id_ in (2, 3))
            wire.expect(sync_read2(USUAL, 2, 3), *both)
            if tick == 0:
                wire.expect(read2(2, 64, 1), status2(2, 0, error=ALERT))
                wire.expect(read2(3, 64, 1), status2(3, 0, error=ALERT))
            asked.append(3 - tick % 2)
            wire.expect(read2(asked[-1], 70, 1), status2(asked[-1], 0x04, error=ALERT))
            await joints.read()
    assert wire.finished()


async def test_a_watchdog_that_may_have_tripped_is_asked_and_ends_in_a_new_pin(
    wire: Wire, clock: VirtualClock
) -> None:
    config = replace(ONE_2, options={**ONE_2.options, "dead_man_s": 0.3})
    async with opened2(wire, clock, wrist2(), config=config) as joints:
        expect_torque_on(wire, 3, watchdog=15)
        await joints.set_torque([True])
        await clock.sleep_until(clock.now() + 0.4)
        wire.expect(read2(3, *USUAL), status2(3, *window2()))
        wire.expect(read2(3, 98, 1), status2(3, 0xFF))
        state = await joints.read()
        assert state.joints[0].errors == (WATCHDOG,)
        assert state.joints[0].shut_down
        expect_torque_on(wire, 3, watchdog=15)
        await joints.set_torque([True])
        wire.expect(read2(3, *USUAL), status2(3, *window2()))
        assert (await joints.read()).joints[0].errors == ()
    assert wire.finished()


async def test_clearing_a_tripped_watchdog_leaves_the_joint_where_it_is(
    wire: Wire, clock: VirtualClock
) -> None:
    tripped = replace(wrist2(), changed={64: b"\x01", 98: b"\xff"}, position=2060)
    async with opened2(wire, clock, tripped) as joints:
        wire.expect(read2(3, *USUAL), status2(3, *window2(2060)))
        expect_write2(wire, 3, 98, b"\x00")
        expect_write2(wire, 3, 112, long(5) + long(2060))
        expect_write2(wire, 3, 98, b"\x00")  # the dead-man is off in this config
        assert await cleared(joints, [0]) == ()
        assert joints.torque() == (True,)
    assert wire.finished()


async def test_a_hardware_error_is_cleared_by_a_reboot_which_leaves_the_joint_limp(
    wire: Wire, clock: VirtualClock
) -> None:
    overloaded = replace(wrist2(), changed={64: b"\x01", 70: b"\x20"})
    async with opened2(wire, clock, overloaded) as joints:
        wire.expect(read2(3, *USUAL), status2(3, *window2(), error=ALERT))
        wire.expect(framed2(3, 8), status2(3))
        wire.expect(framed2(3, 1), times=2)
        wire.expect(framed2(3, 1), status2(3, *word(30), 45))
        for address, size in ((64, 1), USUAL, (70, 1), (98, 1)):
            expect_read2(wire, wrist2(), address, size)
        assert await cleared(joints, [0]) == ()
        assert joints.torque() == (False,)
    assert wire.finished()


async def test_a_servo_that_does_not_come_back_needs_a_power_cycle(wire: Wire, clock: VirtualClock) -> None:
    overloaded = replace(wrist2(), changed={70: b"\x20"})
    async with opened2(wire, clock, overloaded) as joints:
        wire.expect(read2(3, *USUAL), status2(3, *window2(), error=ALERT))
        wire.expect(framed2(3, 8), status2(3))
        wire.expect(framed2(3, 1), times=100)
        began = clock.now()
        (need,) = await cleared(joints, [0])
    assert "has not come back from its reboot; it needs a power cycle" in need
    assert clock.now() - began < 1.2


async def test_a_refusal_is_told_in_the_manuals_words(wire: Wire, clock: VirtualClock) -> None:
    async with opened2(wire, clock, wrist2()) as joints:
        wire.expect(read2(3, *USUAL), status2(3, *window2()))
        wire.expect(write2(3, 98, b"\x00"), status2(3, error=7))
        with pytest.raises(BusError, match="refused to have BUS Watchdog set to 00: Access Error"):
            await joints.set_torque([True])


def test_an_audit_reads_no_undefined_address() -> None:
    defined = {*range(0, 14), *range(20, 28), *range(31, 38), *range(40, 56), *range(63, 66), *range(68, 71)}
    defined |= {98, *range(120, 147)}
    assert all(set(range(address, address + size)) <= defined for address, size in RUNS)
