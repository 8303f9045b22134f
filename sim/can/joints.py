"""Simulated joints on CAN: the driver of real controllers over simulated axes, in the loop's own time."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import replace

from bentod.contracts import ArmConfig, Clock, Joints
from bentod.frames import JointSpec
from drivers.can.joints import open_over
from drivers.can.options import parse_hardware
from sim.bento import BURDENS, DOWN, NOTHING, STOP_MARGIN
from sim.breakable import Breakable
from sim.can.axis import SimAxis
from sim.can.motor import Motor
from sim.can.network import Network, Wire
from sim.can.options import Options, bus_options, parse_options
from sim.shaft import Link


class SimulatedCanJoints(Breakable):
    """Joints on simulated controllers, which can be looked at from outside (`network`)."""

    def __init__(self, joints: Joints, network: Network) -> None:
        super().__init__(joints, network)
        self.network = network


@asynccontextmanager
async def open_joints(config: ArmConfig, clock: Clock) -> AsyncIterator[SimulatedCanJoints]:
    """The driver of real controllers, over simulated ones that speak its protocol frame by frame."""
    options = parse_options(config)
    wire = Wire(build_axes(config, options), options.seed, options.bitrate)
    try:
        async with open_over(wire, replace(config, options=bus_options(options)), clock) as joints:
            yield SimulatedCanJoints(joints, wire.network)
    finally:
        wire.close()


def build_axes(config: ArmConfig, options: Options) -> list[SimAxis]:
    """The axes of `config` at rest and limp. Raises ConfigError: a joint's hardware is not valid."""
    return [_axis(spec, options) for spec in config.joints]


def _axis(spec: JointSpec, options: Options) -> SimAxis:
    hardware = parse_hardware(spec)
    burden = BURDENS.get(spec.name, NOTHING)
    start = options.start_rad.get(spec.name, spec.home)
    link = Link(
        gravity=options.gravity_nm.get(spec.name, burden.gravity),
        rest=DOWN,
        inertia=burden.inertia,
        low=min(spec.minimum - STOP_MARGIN, start),
        high=max(spec.maximum + STOP_MARGIN, start),
    )
    return SimAxis(
        node=hardware.node,
        ratio=hardware.gear_ratio,
        offset=hardware.offset_rad,
        motor=Motor(link, start),
        watchdog=options.watchdog_s,
        celsius=options.temperature,
    )
