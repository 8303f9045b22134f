"""Simulated joints: the Dynamixel driver over a simulated bus, or servo models without any bytes."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import replace
from itertools import count

from bentod.contracts import ArmConfig, Clock, Joints
from bentod.errors import BusError
from drivers.dynamixel.joints import open_over
from sim.arm import GONE, Arm
from sim.bento import build_arm, build_bus
from sim.breakable import Breakable
from sim.line import Line
from sim.options import bus_options, parse_options
from sim.plain import PlainJoints


class SimulatedJoints(Breakable):
    """Joints on simulated servos, which can be looked at from outside (`arm`)."""

    def __init__(self, joints: Joints, arm: Arm) -> None:
        super().__init__(joints, arm)
        self.arm = arm


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
