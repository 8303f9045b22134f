"""An arm of all kinds of servos on one line: who is asked how, and what happens when one does not answer."""

import math
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import replace

import pytest

from bentod.frames import Freshness, JointSpec, State, Velocity
from drivers.dynamixel.firmware1 import AX_SPEED_STEP, SPEED_STEP
from drivers.dynamixel.joints import DynamixelJoints, open_over
from sim.clock import VirtualClock
from tests.drivers.dynamixel.arm import (
    BULK,
    CONFIG,
    ELBOW,
    WRIST,
    Found,
    elbow,
    expect_audit,
    expect_torque_off,
    longer,
    read,
    window,
    wrist,
    write,
)
from tests.drivers.dynamixel.arm2 import Found2, expect_audit2, read2, sync_read2, window2
from tests.drivers.dynamixel.wire import Wire, framed, status, word
from tests.drivers.dynamixel.wire2 import framed2, long, status2

HAND = JointSpec("hand", -0.9, 0.9, 1.0, 0.0, {"id": 4, "model": "AX-12A"})
FINGER = JointSpec("finger", -0.5, 0.5, 1.0, 0.0, {"id": 5, "model": "AX-12A"})
SHOULDER = JointSpec("shoulder", -1.0, 1.0, 0.5, 0.0, {"id": 6, "model": "MX-64(2.0)"})
TURN = JointSpec("turn", -1.0, 1.0, 0.5, 0.0, {"id": 7, "model": "MX-28(2.0)"})
MIXED = replace(CONFIG, joints=(ELBOW, HAND, SHOULDER, WRIST, FINGER, TURN))
ONE_AX = replace(CONFIG, joints=(HAND,))


def ax(id_: int, torque: int = 0) -> Found:
    return Found(id_, 12, special=False, cw=200, ccw=823, torque=torque, position=512)


@asynccontextmanager
async def opened_mixed(wire: Wire, clock: VirtualClock, torque: int = 0) -> AsyncIterator[DynamixelJoints]:
    on = {64: bytes((torque,))}
    expect_audit(wire, replace(elbow(), torque=torque))
    expect_audit(wire, ax(4, torque))
    expect_audit2(wire, Found2(6, 311, on))
    expect_audit(wire, replace(wrist(), torque=torque))
    expect_audit(wire, ax(5, torque))
    expect_audit2(wire, Found2(7, 30, on))
    wire.expect(BULK, window(2), window(3))
    wire.expect(sync_read2((126, 21), 6, 7), status2(6, *window2()), status2(7, *window2()))
    async with open_over(lambda: wire, MIXED, clock) as joints:
        yield joints


def freshness(state: State) -> str:
    letters = {Freshness.FRESH: "f", Freshness.STALE: "s", Freshness.LOST: "l"}
    return "".join(letters[joint.freshness] for joint in state.joints)


async def test_each_kind_is_asked_in_its_own_way(wire: Wire, clock: VirtualClock) -> None:
    async with opened_mixed(wire, clock) as joints:
        wire.expect(BULK, window(2), window(3))
        wire.expect(read(4, 34, 10), window(4, position=522))
        wire.expect(read(5, 34, 10), window(5, position=512))
        wire.expect(sync_read2((126, 21), 6, 7), status2(6, *window2(2060)), status2(7, *window2()))
        state = await joints.read()
    assert wire.finished()
    assert freshness(state) == "ffffff"
    assert state.joints[1].position == pytest.approx(math.radians(10 * 300 / 1024))
    assert state.joints[2].position == pytest.approx(math.radians(12 * 360 / 4096))


async def test_one_sync_write_a_protocol_moves_all(wire: Wire, clock: VirtualClock) -> None:
    async with opened_mixed(wire, clock, torque=1) as joints:
        up, fast = word(512 + 176), word(50)  # an AX's steps: 0.9 rad, 0.111 rpm
        wire.expect(framed(0xFE, 14, 0x83, 30, 4, 2, *word(2570), *word(20), 4, *up, *fast))
        wire.expect(framed2(0xFE, 0x83, 112, 0, 8, 0, 6, *long(15), *long(1396)))
        moves = Velocity(20 * SPEED_STEP), Velocity(50 * AX_SPEED_STEP), Velocity(-15 * 0.229 * math.tau / 60)
        await joints.write([*moves, None, None, None])
    assert wire.finished()


async def test_one_that_is_silent_delays_the_others_and_makes_nobody_else_stale(
    wire: Wire, clock: VirtualClock
) -> None:
    async with opened_mixed(wire, clock) as joints:
        wire.expect(BULK, window(2), window(3))
        wire.expect(read(4, 34, 10))
        wire.expect(read(5, 34, 11), longer(window(5, position=512), 0))
        wire.expect(sync_read2((126, 21), 6, 7), status2(6, *window2()), status2(7, *window2()))
        began = clock.now()
        state = await joints.read()
    assert freshness(state) == "fsffff"
    assert state.time - began < 0.5 / 30


async def test_who_was_left_out_for_lack_of_time_is_asked_first_in_the_next_round(
    wire: Wire, clock: VirtualClock
) -> None:
    async with opened_mixed(wire, clock) as joints:
        wire.expect(BULK)
        wire.expect(read(3, 34, 11))
        wire.expect(read(4, 34, 10))
        state = await joints.read()
        assert freshness(state) == "ssssss"
        await clock.sleep_until(clock.now() + 0.005)
        wire.expect(read(5, 34, 11), longer(window(5, position=512), 0))
        wire.expect(sync_read2((126, 21), 6, 7), status2(6, *window2()), status2(7, *window2()))
        wire.expect(read(2, 32, 12), status(2, 0, 0, *window(2)[5:-1]))
        wire.expect(read(3, 32, 12), status(3, 0, 0, *window(3)[5:-1]))
        wire.expect(read(4, 34, 11), longer(window(4, position=512), 0))
        wire.expect(read(4, 24, 1), status(4, 0))
        wire.expect(read2(6, 64, 1), status2(6, 0))
        wire.expect(read(3, 24, 1), status(3, 0))
        wire.expect(read(5, 24, 1), status(5, 0))
        wire.expect(read2(7, 64, 1), status2(7, 0))
        wire.expect(read(2, 24, 1), status(2, 0))
        assert freshness(await joints.read()) == "ffffff"
    assert wire.finished()


async def test_an_ax_is_pinned_without_gains_that_it_does_not_have(wire: Wire, clock: VirtualClock) -> None:
    expect_audit(wire, ax(4))
    async with open_over(lambda: wire, ONE_AX, clock) as joints:
        wire.expect(read(4, 34, 10), window(4, position=514))
        wire.expect(write(4, 30, *word(514), 5, 0), status(4))
        wire.expect(write(4, 24, 1), status(4))
        wire.expect(read(4, 24, 1), status(4, 1))
        await joints.set_torque([True])
        expect_torque_off(wire, 4)
        await joints.set_torque([False])
    assert wire.finished()
