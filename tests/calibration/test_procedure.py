import asyncio
from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager
from dataclasses import replace
from math import degrees, radians

import pytest

from bentod.calibration.procedure import Plan, record_steps
from bentod.calibration.summary import Summary, summarise
from bentod.contracts import ArmConfig
from bentod.errors import BusError, Refused
from bentod.frames import Command, State, Value
from sim.bento import bento_joints
from sim.clock import VirtualClock
from sim.joints import SimulatedJoints, open_joints

ELBOW, WRIST = 1, 2
WRIST_SPEC = bento_joints()[WRIST]
PLAN = Plan(WRIST, radians(5), 2, 1 / 30, 0.1, limp_after=True, limp_after_fault=False)


@asynccontextmanager
async def arm(clock: VirtualClock, model: str = "", **options: Value) -> AsyncIterator[SimulatedJoints]:
    hardware: dict[str, Value] = {"model": model} if model else {}
    joints = tuple(replace(spec, hardware={**spec.hardware, **hardware}) for spec in bento_joints())
    async with open_joints(ArmConfig(joints, 1 / 30, options), clock) as opened:
        yield opened


async def calibrated(joints: SimulatedJoints, clock: VirtualClock, plan: Plan = PLAN) -> Summary:
    spec = bento_joints()[plan.joint]
    records = await record_steps(joints, spec, plan, clock, _silent)
    return summarise(records, spec.name, 0.0)


def _silent(line: str) -> None:
    pass


class Watched:
    """An arm, and what was asked of it."""

    def __init__(self, joints: SimulatedJoints) -> None:
        self.joints = joints
        self.commands: list[Sequence[Command | None]] = []
        self.torques: list[tuple[bool, ...]] = []

    async def read(self) -> State:
        return await self.joints.read()

    async def write(self, commands: Sequence[Command | None]) -> None:
        self.commands.append(commands)
        await self.joints.write(commands)

    async def set_torque(self, on: Sequence[bool]) -> None:
        self.torques.append(tuple(on))
        await self.joints.set_torque(on)

    def torque(self) -> tuple[bool, ...]:
        return self.joints.torque()

    async def clear_errors(self, joints: Sequence[int]) -> tuple[str, ...]:
        raise AssertionError("a calibration clears no errors")


@pytest.mark.parametrize("dead_time", [0.005, 0.01, 0.017, 0.03, 0.05])
async def test_the_dead_time_of_a_simulated_joint_is_found_within_a_fifth(
    dead_time: float, clock: VirtualClock
) -> None:
    async with arm(clock, servo_dead_time_s=dead_time) as joints:
        found = await calibrated(joints, clock)
        assert found.whole.dead_time == pytest.approx(joints.arm.servos[WRIST].dead_time, rel=0.2)
        assert found.trusted
        assert not found.differs


@pytest.mark.parametrize(
    ("model", "joint", "step"), [("", ELBOW, 5), ("MX-28(2.0)", WRIST, 5), ("AX-12A", WRIST, 10)]
)
async def test_neither_gravity_nor_firmware_nor_a_coarse_sensor_hides_it(
    model: str, joint: int, step: float, clock: VirtualClock
) -> None:
    async with arm(clock, model) as joints:
        found = await calibrated(joints, clock, replace(PLAN, joint=joint, step=radians(step), pairs=3))
        assert found.whole.dead_time == pytest.approx(joints.arm.servos[joint].dead_time, rel=0.25)


async def test_a_deceleration_is_found_whether_the_config_says_it_or_not(clock: VirtualClock) -> None:
    spec = replace(WRIST_SPEC, hardware={**WRIST_SPEC.hardware, "goal_acceleration_rad_s2": 3.0})
    joints = tuple(spec if i == WRIST else other for i, other in enumerate(bento_joints()))
    async with open_joints(ArmConfig(joints, 1 / 30, {}), clock) as opened:
        records = await record_steps(opened, spec, PLAN, clock, _silent)
    assert summarise(records, "wrist", 3.0).whole.deceleration == pytest.approx(3.0, rel=0.1)
    unknown = summarise(records, "wrist", 0.0)
    assert unknown.differs
    written = unknown.values({"dead_time_s", "goal_acceleration_rad_s2"})
    assert written["goal_acceleration_rad_s2"] == pytest.approx(3.0, rel=0.1)


async def test_only_the_chosen_joint_is_told_anything_and_it_is_limp_afterwards(clock: VirtualClock) -> None:
    async with arm(clock) as joints:
        watched = Watched(joints)
        await record_steps(watched, bento_joints()[WRIST], PLAN, clock, _silent)
        for commands in watched.commands:
            assert [index for index, command in enumerate(commands) if command is not None] == [WRIST]
        assert watched.torques == [(False, False, True, False, False), (False,) * 5]


async def test_the_steps_stay_within_the_limits_and_end_where_they_began(clock: VirtualClock) -> None:
    spec = bento_joints()[WRIST]
    async with arm(clock, start_rad={"wrist_rotation": spec.maximum}) as joints:
        servo = joints.arm.servos[WRIST]
        records = await record_steps(joints, spec, PLAN, clock, _silent)
        seen = [float(position) for record in records for position in record.positions]
        assert max(seen) <= spec.maximum
        assert min(seen) > spec.maximum - radians(8)
        assert degrees(servo.position) == pytest.approx(degrees(spec.maximum) - 1, abs=0.5)


async def test_a_joint_without_room_is_not_moved_and_stays_limp(clock: VirtualClock) -> None:
    async with arm(clock) as joints:
        watched = Watched(joints)
        plan = replace(PLAN, joint=ELBOW, step=radians(60))
        with pytest.raises(Refused, match="degrees of room"):
            await record_steps(watched, bento_joints()[ELBOW], plan, clock, _silent)
        assert not any(joints.torque())


@pytest.mark.parametrize(("fault", "joint"), [("cable", None), ("silent", WRIST), ("overload", WRIST)])
async def test_a_calibration_that_loses_its_joint_ends_with_the_reason(
    fault: str, joint: int | None, clock: VirtualClock
) -> None:
    async with arm(clock) as joints:
        task = asyncio.ensure_future(record_steps(joints, bento_joints()[WRIST], PLAN, clock, _silent))
        await clock.sleep_until(clock.now() + 1.0)
        joints.inject(fault, joint, True)
        with pytest.raises(BusError):
            await task


async def test_a_joint_that_is_stuck_cannot_be_calibrated(clock: VirtualClock) -> None:
    async with arm(clock) as joints:
        joints.inject("stuck", WRIST, True)
        with pytest.raises(Refused, match="is it blocked"):
            await calibrated(joints, clock)
        assert not joints.torque()[WRIST]


async def test_an_interrupt_stops_the_joint_and_leaves_it_as_the_plan_says(clock: VirtualClock) -> None:
    for limp in (True, False):
        async with arm(clock) as joints:
            plan = replace(PLAN, limp_after=limp)
            task = asyncio.ensure_future(record_steps(joints, bento_joints()[WRIST], plan, clock, _silent))
            await clock.sleep_until(clock.now() + 1.05)
            task.cancel()
            with pytest.raises(asyncio.CancelledError):
                await task
            servo = joints.arm.servos[WRIST]
            before = servo.position
            await clock.sleep_until(clock.now() + 1.0)
            await joints.read()
            assert abs(servo.position - before) < radians(0.3)
            assert joints.torque()[WRIST] is not limp
