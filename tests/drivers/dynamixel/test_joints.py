import asyncio
import logging
import math
from dataclasses import replace

import pytest

from bentod.frames import Freshness, Position, Stop, Velocity
from drivers.dynamixel.firmware1 import SPEED_STEP
from drivers.dynamixel.tables import ALARM_SHUTDOWN
from sim.clock import VirtualClock
from tests.drivers.dynamixel.arm import BULK, elbow, longer, opened, read, window, wrist
from tests.drivers.dynamixel.wire import Wire, status

HOLDING = (replace(elbow(), torque=1), replace(wrist(), torque=1))

# The elbow to its maximum (2570) at raw 20, the wrist to its minimum (1028) at raw 5.
BOTH_MOVE = "FF FF FE 0E 83 1E 04 02 0A 0A 14 00 03 04 04 05 00 14"
WRIST_STAYS = "FF FF FE 09 83 1E 04 03 00 08 05 00 43"


async def test_one_bulk_read_is_all_that_a_round_needs(wire: Wire, clock: VirtualClock) -> None:
    async with opened(wire, clock) as joints:
        await clock.sleep_until(clock.now() + 0.1)
        wire.expect(BULK, window(2, position=2304, speed=1024 + 40, load=200), window(3))
        began = clock.now()
        state = await joints.read()
    assert state.time == clock.now() == pytest.approx(began + 0.002)
    assert state.problem == ""
    found = state.joints[0]
    assert found.position == pytest.approx(math.radians(22.5))
    assert found.velocity == pytest.approx(-40 * SPEED_STEP)
    assert found.load == pytest.approx(200 / 1023)
    assert (found.voltage, found.temperature, found.errors) == (12.0, 31.0, ())
    assert found.age == pytest.approx(0.001)
    assert [joint.freshness for joint in state.joints] == [Freshness.FRESH, Freshness.FRESH]


async def test_what_a_servo_complains_of_is_in_its_state(wire: Wire, clock: VirtualClock) -> None:
    async with opened(wire, clock) as joints:
        wire.expect(BULK, window(2, limit=0, error=0x20), window(3, error=0x01))
        wire.expect(read(2, 24, 1), status(2, 0, error=0x20))
        state = await joints.read()
    assert state.joints[0].errors == ("Overload Error", ALARM_SHUTDOWN)
    assert state.joints[1].errors == ("Input Voltage Error",)
    assert [joint.shut_down for joint in state.joints] == [True, False]
    assert state.joints[0].freshness is Freshness.FRESH


async def test_a_silent_servo_keeps_its_value_and_silences_nobody(wire: Wire, clock: VirtualClock) -> None:
    async with opened(wire, clock) as joints:
        wire.expect(BULK, window(2, position=2060), window(3))
        before = await joints.read()
        wire.expect(BULK)  # the chain breaks at its first link
        wire.expect(read(3, 34, 11), longer(window(3, position=2070), 0))
        state = await joints.read()
    assert wire.finished()
    assert state.joints[0].position == before.joints[0].position
    assert state.joints[0].age == pytest.approx(before.joints[0].age + state.time - before.time)
    assert state.joints[0].freshness is Freshness.STALE
    assert state.joints[1].freshness is Freshness.FRESH


async def test_a_servo_that_is_back_is_asked_for_its_torque(
    wire: Wire, clock: VirtualClock, caplog: pytest.LogCaptureFixture
) -> None:
    async with opened(wire, clock, *HOLDING) as joints:
        wire.expect(BULK)
        wire.expect(read(3, 34, 11), longer(window(3), 0))
        await joints.read()
        await clock.sleep_until(clock.now() + 0.02)
        wire.expect(read(3, 34, 11), longer(window(3), 0))
        wire.expect(read(2, 34, 11), longer(window(2), 0))
        wire.expect(read(2, 24, 1), status(2, 0), times=2)
        with caplog.at_level(logging.WARNING):
            await joints.read()
        assert joints.torque() == (False, True)
        assert "Servo 2 (elbow_flexion) was silent or in alarm; its torque is now off" in caplog.text
        wire.expect(WRIST_STAYS)
        await joints.write([Velocity(0.3), Stop()])
    assert wire.finished()


async def test_a_servo_that_is_back_gets_no_goal_before_its_torque_is_known(
    wire: Wire, clock: VirtualClock
) -> None:
    async with opened(wire, clock, *HOLDING) as joints:
        wire.expect(BULK)
        wire.expect(read(3, 34, 11), longer(window(3), 0))
        await joints.read()
        await clock.sleep_until(clock.now() + 0.02)
        wire.expect(read(3, 34, 11), longer(window(3), 0))
        wire.expect(read(2, 34, 11), longer(window(2), 0))
        wire.expect(read(2, 24, 1))
        await joints.read()
        wire.expect(WRIST_STAYS)
        await joints.write([Velocity(0.3), Stop()])
    assert wire.finished()


async def test_a_dead_bus_makes_all_stale_then_lost_within_half_a_tick_a_round(
    wire: Wire, clock: VirtualClock
) -> None:
    async with opened(wire, clock) as joints:
        wire.dead = True
        for tick in range(1, 25):
            await clock.sleep_until(tick / 30)
            began = clock.now()
            state = await joints.read()
            assert state.time - began < 0.5 / 30
            lost = state.joints[0].age > 0.5
            assert state.joints[0].freshness is (Freshness.LOST if lost else Freshness.STALE)
            assert bool(state.problem) is lost
        assert state.joints[0].freshness is Freshness.LOST
        assert state.problem.endswith("check its power, its cable, its id and the baud rate. Reconnecting.")


async def test_a_port_that_is_gone_is_told_and_nothing_raises(wire: Wire, clock: VirtualClock) -> None:
    async with opened(wire, clock, *HOLDING) as joints:
        wire.expect(BULK)
        asyncio.get_running_loop().call_later(0.001, wire.lose, "The adapter was unplugged.")
        state = await joints.read()
        assert state.problem == "The adapter was unplugged. Reconnecting."
        await joints.write([Stop(), Stop()])
        assert (await joints.read()).joints[0].freshness is Freshness.STALE
    assert wire.finished()


async def test_one_sync_write_moves_all(wire: Wire, clock: VirtualClock) -> None:
    async with opened(wire, clock, *HOLDING) as joints:
        wire.expect(BOTH_MOVE)
        await joints.write([Velocity(20 * SPEED_STEP), Velocity(-5 * SPEED_STEP)])
    assert wire.finished()


async def test_a_limp_joint_is_never_written_to(wire: Wire, clock: VirtualClock) -> None:
    async with opened(wire, clock, elbow(), replace(wrist(), torque=1)) as joints:
        wire.expect(WRIST_STAYS)
        await joints.write([Velocity(0.3), Stop()])
    assert wire.finished()


async def test_a_joint_without_a_command_is_left_alone(wire: Wire, clock: VirtualClock) -> None:
    async with opened(wire, clock, *HOLDING) as joints:
        await joints.write([None, None])
        wire.expect(WRIST_STAYS)
        await joints.write([None, Stop()])
    assert wire.finished()


async def test_the_slowest_wish_is_raw_1_and_the_greatest_the_joints_maximum(
    wire: Wire, clock: VirtualClock
) -> None:
    async with opened(wire, clock, *HOLDING) as joints:
        # 2570 at raw 1; 2048 at raw 90, which is 1.08 rad/s.
        wire.expect("FF FF FE 0E 83 1E 04 02 0A 0A 01 00 03 00 08 5A 00 D2")
        await joints.write([Velocity(1e-9), Position(0.0, 50.0)])
    assert wire.finished()


async def test_a_stop_counts_the_age_of_the_reading_up_to_the_write(wire: Wire, clock: VirtualClock) -> None:
    async with opened(wire, clock, *HOLDING) as joints:
        wire.expect(BOTH_MOVE)
        await joints.write([Velocity(20 * SPEED_STEP), Velocity(-5 * SPEED_STEP)])
        await clock.sleep_until(clock.now() + 0.1)
        wire.expect(BULK, window(2, position=2100, speed=80), window(3))
        state = await joints.read()
        await clock.sleep_until(state.time + 0.01)
        # The servo obeys raw 20 for another 11 + 2 + 17 ms: 20 * 7.78 * 0.030 = 5 ticks ahead of 2100.
        wire.expect("FF FF FE 09 83 1E 04 02 39 08 14 00 FC")
        await joints.write([Stop(), None])
        wire.expect("FF FF FE 09 83 1E 04 02 39 08 14 00 FC")
        await joints.write([Stop(), None])
    assert wire.finished()


async def test_commands_for_another_number_of_joints_are_a_mistake_of_the_caller(
    wire: Wire, clock: VirtualClock
) -> None:
    async with opened(wire, clock) as joints:
        with pytest.raises(ValueError, match="zip"):
            await joints.write([Stop()])
