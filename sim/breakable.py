"""Joints that can be broken on purpose: the driver's or the model's own, and the world that they move in."""

from collections.abc import Sequence

from bentod.contracts import FaultInjector, Joints
from bentod.frames import Command, State


class Breakable:
    """`Joints` and `FaultInjector` in one, as a daemon finds them on a simulated arm."""

    def __init__(self, joints: Joints, world: FaultInjector) -> None:
        self._joints = joints
        self._world = world

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

    async def clear_errors(self, joints: Sequence[int]) -> tuple[str, ...] | None:
        """See `bentod.contracts.Joints`."""
        return await self._joints.clear_errors(joints)

    def faults(self) -> tuple[str, ...]:
        """See `bentod.contracts.FaultInjector`."""
        return self._world.faults()

    def inject(self, fault: str, joint: int | None, on: bool) -> None:
        """See `bentod.contracts.FaultInjector`."""
        self._world.inject(fault, joint, on)
