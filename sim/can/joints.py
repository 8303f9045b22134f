"""Simulated joints on CAN: the driver of real controllers over simulated axes, in the loop's own time."""

from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager
from dataclasses import replace

from bentod.contracts import ArmConfig, Clock
from bentod.frames import Command, JointSpec, State
from drivers.can.joints import CanJoints, open_over
from drivers.can.options import parse_hardware
from sim.bento import BURDENS, DOWN, NOTHING, STOP_MARGIN
from sim.can.axis import SimAxis
from sim.can.motor import Motor
from sim.can.network import Network, Wire
from sim.can.options import Options, bus_options, parse_options
from sim.shaft import Link


class SimulatedCanJoints:
    """Joints that can be broken on purpose (FaultInjector) and looked at from outside (`network`)."""

    def __init__(self, joints: CanJoints, network: Network) -> None:
        self.network = network
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

    def estop(self) -> None:
        """See `drivers.can.joints.CanJoints`."""
        self._joints.estop()

    def faults(self) -> tuple[str, ...]:
        """See `bentod.contracts.FaultInjector`."""
        return self.network.faults()

    def inject(self, fault: str, joint: int | None, on: bool) -> None:
        """See `bentod.contracts.FaultInjector`."""
        self.network.inject(fault, joint, on)


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
