"""What the contract does not say: pins, watchdogs, full buffers, and what is left behind."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import replace
from math import degrees

import pytest

from bentod.contracts import ArmConfig
from bentod.errors import BusError
from bentod.frames import Command, Freshness, Position, Stop, Value, Velocity
from drivers.can.joints import CanJoints, open_over
from drivers.can.link import Frame
from sim.bento import bento_joints
from sim.can.joints import build_axes
from sim.can.network import Wire
from sim.can.options import bus_options, parse_options
from sim.clock import VirtualClock

PERIOD = 1 / 30
WRIST, GRIPPER = 0, 1


class Bus(Wire):
    """A wire that shows what passes and can be made to take nothing."""

    sent: list[Frame]
    full = False

    def send(self, frame: Frame) -> None:
        if self.full:
            raise BusError("The bus is full.")
        self.sent.append(frame)
        super().send(frame)

    def commands(self, node: int) -> list[int]:
        """What was sent to a node since the last call, questions left out."""
        found = [frame.id & 31 for frame in self.sent if frame.id >> 5 == node and not frame.remote]
        self.sent.clear()
        return found


class Rig:
    """Two joints on CAN, ticked."""

    def __init__(self, bus: Bus, joints: CanJoints, clock: VirtualClock) -> None:
        self.bus, self.joints, self.clock = bus, joints, clock

    async def run(self, seconds: float, *commands: Command | None) -> None:
        for _ in range(round(seconds / PERIOD)):
            await self.joints.read()
            await self.joints.write(commands)
            await self.clock.sleep_until(self.clock.now() + PERIOD)

    def angle(self, joint: int) -> float:
        """Degrees, by the truth."""
        self.bus.network.advance()
        return degrees(self.bus.network.axes[joint].motor.position)


@asynccontextmanager
async def opened(clock: VirtualClock, bounded: bool = False, **options: Value) -> AsyncIterator[Rig]:
    specs = bento_joints()
    joints = tuple(
        replace(specs[i], hardware={"node": node, "gear_ratio": 8.0, "bounded": bounded})
        for node, i in ((5, 2), (6, 4))
    )
    config = ArmConfig(joints, PERIOD, options)
    parsed = parse_options(config)
    bus = Bus(build_axes(config, parsed), 0, parsed.bitrate)
    bus.sent = []
    try:
        async with open_over(bus, replace(config, options=bus_options(parsed)), clock) as driven:
            yield Rig(bus, driven, clock)
    finally:
        bus.close()


async def test_torque_comes_after_the_pin_and_not_before(clock: VirtualClock) -> None:
    async with opened(clock) as rig:
        rig.bus.commands(5)
        await rig.joints.set_torque([True, False])
        commands = rig.bus.commands(5)
        assert commands[:6] == [0x0F, 0x12, 0x0C, 0x0B, 0x0C, 0x07]


async def test_a_limp_joint_is_told_nothing(clock: VirtualClock) -> None:
    async with opened(clock) as rig:
        await rig.joints.set_torque([True, False])
        rig.bus.commands(6)
        await rig.run(1.0, Velocity(0.1), Velocity(0.1))
        assert rig.bus.commands(6) == []


async def test_an_axis_whose_host_dies_in_a_motion_lets_go_after_its_watchdog(clock: VirtualClock) -> None:
    async with opened(clock, watchdog_s=0.2) as rig:
        await rig.joints.set_torque([True, True])
        await rig.run(2.0, Velocity(0.1), Stop())
        before = rig.angle(WRIST)
        await clock.sleep_until(clock.now() + 5.0)
        assert rig.angle(WRIST) - before < degrees(0.1 * 0.3)
        assert rig.joints.torque() == (False, False)


async def test_without_a_watchdog_a_velocity_goes_on_and_a_bounded_one_ends_at_the_limit(
    clock: VirtualClock,
) -> None:
    reached = []
    for bounded in (False, True):
        async with opened(clock, bounded, watchdog_s=0.0) as rig:
            await rig.joints.set_torque([True, True])
            await rig.run(0.5, Velocity(0.5), Stop())
            await clock.sleep_until(clock.now() + 9.0)
            reached.append(rig.angle(WRIST))
    assert reached == pytest.approx([degrees(1.571 + 0.02), degrees(1.571)], abs=0.1)


async def test_waiting_for_one_axis_does_not_starve_the_watchdog_of_another(clock: VirtualClock) -> None:
    async with opened(clock, watchdog_s=0.1) as rig:
        await rig.joints.set_torque([True, False])
        await rig.run(0.3, Velocity(0.1), None)
        rig.bus.network.inject("silent", GRIPPER, True)
        with pytest.raises(BusError, match=r"gripper \(node 6\) did not confirm .* is on: it is silent"):
            await rig.joints.set_torque([True, True])
        assert rig.joints.torque() == (True, False)


async def test_a_joint_that_was_turned_by_hand_is_pinned_where_it_is(clock: VirtualClock) -> None:
    async with opened(clock) as rig:
        await rig.joints.set_torque([True, True])
        await rig.run(2.0, Position(0.4, 1.0), Position(0.3, 1.0))
        await rig.joints.set_torque([False, False])
        rig.bus.network.axes[WRIST].motor.position = -0.2
        await clock.sleep_until(clock.now() + 0.1)
        await rig.joints.set_torque([True, True])
        await rig.run(1.0, Stop(), Stop())
        assert rig.angle(WRIST) == pytest.approx(degrees(-0.2), abs=0.1)


async def test_a_full_buffer_is_a_problem_and_the_joints_grow_old_by_it(clock: VirtualClock) -> None:
    async with opened(clock) as rig:
        await rig.joints.set_torque([True, True])
        await rig.run(0.2, Stop(), Stop())
        rig.bus.full = True
        await rig.run(0.4, Stop(), Stop())
        state = await rig.joints.read()
        assert state.problem == "The bus is full."
        assert all(0.35 < joint.age < 0.45 for joint in state.joints)
        rig.bus.full = False
        await rig.run(0.2, Stop(), Stop())
        state = await rig.joints.read()
        assert state.problem == ""
        assert {joint.freshness for joint in state.joints} == {Freshness.FRESH}


async def test_a_mode_that_could_not_be_sent_is_sent_again(clock: VirtualClock) -> None:
    async with opened(clock) as rig:
        await rig.joints.set_torque([True, True])
        await rig.run(0.3, Stop(), Stop())
        rig.bus.full = True
        await rig.run(0.1, Velocity(0.3), Stop())
        rig.bus.full = False
        rig.bus.commands(5)
        await rig.run(0.5, Velocity(0.3), Stop())
        assert rig.bus.commands(5)[:3] == [0x0D, 0x0B, 0x0D]
        assert rig.angle(WRIST) > 5


async def test_leaving_stops_a_velocity_and_leaves_torque_as_it_is(clock: VirtualClock) -> None:
    async with opened(clock, watchdog_s=0.0) as rig:
        await rig.joints.set_torque([True, True])
        await rig.run(0.5, Velocity(0.5), Stop())
        rig.joints.halt()
        await clock.sleep_until(clock.now() + 0.1)
        before = rig.angle(WRIST)
        await clock.sleep_until(clock.now() + 1.0)
        assert rig.angle(WRIST) == pytest.approx(before, abs=0.1)
        assert rig.bus.network.axes[WRIST].motor.driven


async def test_an_emergency_stop_lets_go_and_needs_to_be_cleared(clock: VirtualClock) -> None:
    async with opened(clock) as rig:
        await rig.joints.set_torque([True, True])
        await rig.run(0.3, Velocity(0.1), Stop())
        rig.joints.estop()
        await rig.run(0.3, None, None)
        state = await rig.joints.read()
        assert {joint.errors for joint in state.joints} == {("ESTOP_REQUESTED",)}
        assert rig.joints.torque() == (False, False)
        with pytest.raises(BusError, match="ESTOP_REQUESTED: clear its errors first"):
            await rig.joints.set_torque([True, True])
        assert await rig.joints.clear_errors([WRIST, GRIPPER]) == ()
        await rig.joints.set_torque([True, True])


async def test_why_it_let_go_is_told_when_that_is_no_error_any_more(clock: VirtualClock) -> None:
    async with opened(clock) as rig:
        rig.bus.network.axes[WRIST].reason = 0x4000000
        await rig.run(0.5, None, None)
        state = await rig.joints.read()
        assert state.joints[WRIST].errors == ("disarmed by SPINOUT_DETECTED",)


async def test_a_controller_that_is_absent_is_named_with_those_that_are_there(clock: VirtualClock) -> None:
    specs = bento_joints()
    there = ArmConfig((replace(specs[2], hardware={"node": 9}),), PERIOD, {})
    asked = replace(there, joints=(replace(specs[2], hardware={"node": 5}),))
    bus = Wire(build_axes(there, parse_options(there)), 0, 500_000)
    with pytest.raises(
        BusError, match=r"node 5\) sent no heartbeat within 1 s \(heard from others: nodes 9\)"
    ):
        async with open_over(bus, asked, clock):
            pass
    bus.close()


async def test_a_controller_that_sends_no_estimates_is_told_what_to_set(clock: VirtualClock) -> None:
    config = ArmConfig((replace(bento_joints()[2], hardware={"node": 5}),), PERIOD, {})
    with pytest.raises(BusError, match="encoder_msg_rate_ms"):
        async with open_over(_Beating(), config, clock):
            pass


class _Beating:
    """A bus with a heartbeat and nothing else."""

    def listen(self, on_frame: object, on_trouble: object) -> None:
        assert callable(on_frame)
        on_frame(Frame(0x0A1, bytes.fromhex("00 00 00 00 01 00 00 00")))

    def send(self, frame: Frame) -> None:
        """Into the void."""


async def test_a_joint_with_torque_that_nobody_commands_is_stopped_and_held(clock: VirtualClock) -> None:
    async with opened(clock) as rig:
        await rig.joints.set_torque([True, True])
        await rig.run(0.5, Velocity(0.5), Stop())
        await rig.run(0.3, None, None)
        before = rig.angle(WRIST)
        await rig.run(2.0, None, None)
        assert rig.angle(WRIST) == pytest.approx(before, abs=0.1)
        assert rig.joints.torque() == (True, True)
