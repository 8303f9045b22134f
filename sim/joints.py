"""Simulated joints: the Dynamixel driver over a simulated bus, or servo models without any bytes."""

from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager
from dataclasses import replace
from itertools import count

from bentod.contracts import ArmConfig, Clock, Joints
from bentod.errors import BusError
from bentod.frames import Command, State
from drivers.dynamixel.joints import open_over
from sim.arm import GONE, Arm
from sim.bento import build_arm, build_bus
from sim.line import Line
from sim.options import bus_options, parse_options
from sim.plain import PlainJoints


class SimulatedJoints:
    """Joints that can be broken on purpose (FaultInjector) and looked at from outside (`arm`)."""

    def __init__(self, joints: Joints, arm: Arm) -> None:
        self.arm = arm
        self._joints = joints

    async def read(self) -> State:
        """See `bentod.contracts.Joints`."""
        return await self._joints.read()

    async def write(self, commands: Sequence[Command | None]) -> None:
        """See `bentod.contracts.Joints`."""
        await self._joints.write(commands)

    async def set_torque(self, on: Sequence[bool]) -> None:
        """See `bentod.contracts.Joints`."""
        await self._joints.set_torque(on)

    def torque(self) -> tuple[bool, ...]:
        """See `bentod.contracts.Joints`."""
        return self._joints.torque()

    async def clear_errors(self, joints: Sequence[int]) -> tuple[str, ...]:
        """See `bentod.contracts.Joints`."""
        return await self._joints.clear_errors(joints)

    def faults(self) -> tuple[str, ...]:
        """See `bentod.contracts.FaultInjector`."""
        return self.arm.faults()

    def inject(self, fault: str, joint: int | None, on: bool) -> None:
        """See `bentod.contracts.FaultInjector`."""
        self.arm.inject(fault, joint, on)


@asynccontextmanager
async def open_joints(config: ArmConfig, clock: Clock) -> AsyncIterator[SimulatedJoints]:
    """The driver of the real arm, over simulated servos that speak its protocol byte by byte."""
    options = parse_options(config)
    arm = build_arm(config, options, clock.now())
    bus = build_bus(arm, config, options)
    openings = count()

    def connect() -> Line:
        if not arm.plugged:
            raise BusError(GONE)
        return Line(bus, arm, f"{options.seed}/line/{next(openings)}", options.usb_latency_s)

    driven = replace(config, options=bus_options(options))
    async with open_over(connect, driven, clock) as joints:
        yield SimulatedJoints(joints, arm)


@asynccontextmanager
async def open_plain_joints(config: ArmConfig, clock: Clock) -> AsyncIterator[SimulatedJoints]:
    """Servo models driven directly: the same motion without a bus, for studies and fast tests."""
    options = parse_options(config)
    arm = build_arm(config, options, clock.now())
    yield SimulatedJoints(PlainJoints(arm, config, options, clock), arm)
