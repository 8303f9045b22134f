"""An arm that does as it is told, and what stands between its reading and its writing."""

import asyncio
from collections.abc import Sequence

from bentod.arm_state import Rules
from bentod.contracts import Joints
from bentod.control.groups import Groups
from bentod.control.health import Ladder
from bentod.control.leases import Holder
from bentod.control.modes import Modes
from bentod.desk import Desk
from bentod.frames import Command, Event, Frame, Freshness, JointSpec, JointState, State, Stop, Velocity
from bentod.inbox import Inbox
from bentod.mind import Mind
from bentod.muscles import Muscles
from bentod.tick import Controller
from sim.clock import VirtualClock

PERIOD = 1 / 30
SPECS = tuple(JointSpec(name, -1.0, 1.0, 0.5, 0.0, {}) for name in ("shoulder", "elbow"))
LADDER = Ladder(hold=0.1, fault=0.5)


def at(*positions: float, velocity: float = 0.0, stale: Sequence[int] = (), time: float = 0.0) -> State:
    """Joints read at `positions` (rad); those of `stale` a quarter of a second ago."""
    seen = [
        (Freshness.STALE, 0.25) if joint in stale else (Freshness.FRESH, 0.0)
        for joint in range(len(positions))
    ]
    joints = [
        JointState(position, velocity, 0.0, 12.0, 30.0, age, freshness)
        for position, (freshness, age) in zip(positions, seen, strict=True)
    ]
    return State(time, tuple(joints))


def desk_of(torque: Sequence[bool] = (True, True), mind: Mind | None = None) -> Desk:
    """A desk for two joints, a group of both, and nobody's muscles; what has torque is holding."""
    groups = Groups(SPECS, {"arm": ["shoulder", "elbow"]})
    modes = Modes([spec.name for spec in SPECS], torque)
    rules = Rules(LADDER, limp_on_fault=False, home_speed=0.35, lease_max=2.0)
    return Desk(SPECS, groups, modes, rules, Muscles(), mind or Mind(SPECS, 1 / PERIOD, groups))


async def cleared(joints: Joints, which: Sequence[int]) -> tuple[str, ...]:
    """What is needed besides, asked for in one tick after the other until all are done."""
    while (needs := await joints.clear_errors(which)) is None:  # noqa: ASYNC110 -- so the tick asks, too
        await asyncio.sleep(PERIOD)
    return needs


class FakeArm:
    """Two joints that do as they are told; told to stop they coast, half as fast with each reading."""

    def __init__(self) -> None:
        self.speeds = [0.0, 0.0]
        self.on = [True, True]
        self.reads: list[float] = []
        self.sent: list[tuple[Command | None, ...]] = []
        self.let_go_at: list[float] = []  # rad/s of the shoulder when its torque went
        self.slow: dict[int, float] = {}  # s that a reading takes, by its number
        self.broken = ""  # the next call of this name raises
        self.brakes = 0.5

    async def read(self) -> State:
        clock = asyncio.get_running_loop()
        self.reads.append(clock.time())
        self._raise_if_broken("read")
        await asyncio.sleep(self.slow.get(len(self.reads) - 1, 0.0))
        if self.sent and self.sent[-1][0] == Stop():
            self.speeds = [speed * self.brakes for speed in self.speeds]
        joints = tuple(JointState(0.0, v, 0.0, 12.0, 30.0, 0.0, Freshness.FRESH) for v in self.speeds)
        return State(clock.time(), joints)

    async def write(self, commands: Sequence[Command | None]) -> None:
        self._raise_if_broken("write")
        self.sent.append(tuple(commands))
        for joint, command in enumerate(commands):
            if isinstance(command, Velocity):
                self.speeds[joint] = command.velocity

    async def set_torque(self, on: Sequence[bool]) -> None:
        self._raise_if_broken("set_torque")
        self.let_go_at += [self.speeds[0]] * (self.on[0] and not on[0])
        self.on = list(on)

    def torque(self) -> tuple[bool, ...]:
        return tuple(self.on)

    async def clear_errors(self, joints: Sequence[int]) -> tuple[str, ...]:
        self._raise_if_broken("clear_errors")
        return ()

    def _raise_if_broken(self, call: str) -> None:
        if self.broken == call:
            self.broken = ""
            raise ZeroDivisionError("oops")


class Bench:
    """A controller over the fake arm, released to move, and everything that it published."""

    def __init__(self, mind: Mind | None = None) -> None:
        self.arm = FakeArm()
        self.inbox = Inbox()
        self.frames: list[Frame] = []
        self.events: list[Event] = []
        self.desk = desk_of(self.arm.torque(), mind)
        self.desk.pause((0, 1), False)
        self.controller = Controller(
            self.arm, self.desk, self.inbox, VirtualClock(), 1 / PERIOD, self._publish
        )

    def _publish(self, frame: Frame, events: Sequence[Event], whole: bool) -> None:
        self.frames.append(frame)
        self.events += events

    async def set_off(self, velocity: float = 0.4) -> None:
        """Have a client move the shoulder for two seconds."""
        holder = Holder(1, "test")
        self.inbox.post(lambda desk: desk.move(0, Velocity(velocity), holder, 2.0))
        await self.controller.run(3)
        assert self.arm.speeds[0] == velocity
