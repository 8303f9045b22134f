"""A daemon in virtual time on servos that can be looked at, with somebody who moves it."""

import asyncio
import logging
from collections.abc import AsyncIterator, Collection, Iterator
from contextlib import AsyncExitStack, asynccontextmanager, contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory

from bentod.client import Client
from bentod.endpoint import RpcError
from sim.clock import VirtualLoop
from sim.emg import Synthetic
from tests.rig import Table, number, opened_sources, quiet_config, running, sim_config, table, tables
from tests.system.campaign.operator import Operator, operating
from tests.system.campaign.outcome import Moved
from tests.system.campaign.truth import TrueArm, true_arms

JOINTS = ("shoulder_rotation", "elbow_flexion", "wrist_rotation", "wrist_flexion", "gripper")

DRIVEN = (0, 2)
"""What the operator moves: the worst damped joint and a quick one; gravity pulls at neither. A wearer moves
the first."""

SPEEDS = (0.4, 0.7)
"""rad/s, from and to."""

PROGRAM = "program = [[0, 0.0, 0.4], [0, 1.0, 0.9], [1, 1.0, 0.9]]"
"""To and fro, with the rest that whoever is to move a released arm must be seen at."""

BY_ITSELF, RELEASED, ARMED, RESTARTED = (
    "by itself",
    "`clear_fault`, release",
    "`clear_fault`, torque, release",
    "restart",
)
"""What it takes to move again."""

REMEDIES = {
    BY_ITSELF: (),
    RELEASED: (("clear_fault", {}), ("pause", {"on": False})),
    ARMED: (("clear_fault", {}), ("torque", {"on": True}), ("pause", {"on": False})),
}


class Said(logging.Handler):
    """What the daemon logs as a warning or worse."""

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self.texts: list[str] = []

    def emit(self, record: logging.LogRecord) -> None:
        self.texts.append(record.getMessage())


@dataclass(slots=True)
class Rig:
    """The arm, who moves it, and what is seen and said."""

    arm: TrueArm
    socket: Path
    watcher: Client
    operator: Operator | None
    source: Synthetic | None
    said: Said
    stack: AsyncExitStack
    """What a fault enters is left with the rig."""
    frames: list[Table] = field(default_factory=list)
    lifted: AsyncExitStack = field(default_factory=AsyncExitStack)
    """What a fault enters and its end leaves."""

    @property
    def loop(self) -> VirtualLoop:
        """Of this virtual time."""
        loop = asyncio.get_running_loop()
        assert isinstance(loop, VirtualLoop)
        return loop

    @property
    def now(self) -> float:
        """Monotonic s."""
        return self.loop.time()

    @property
    def driven(self) -> tuple[int, ...]:
        """Joints that somebody asks to move."""
        return DRIVEN if self.operator else DRIVEN[:1]

    def let_go(self) -> float:
        """Whoever moves the arm asks for nothing more from the moment that is returned (monotonic s)."""
        if self.operator:
            return self.operator.let_go()
        assert self.source
        self.source.relaxed = True
        return self.now

    async def set_off(self, random: Random) -> None:
        """Have whoever moves the arm move it towards its middle, and be in the midst of that."""
        if self.operator:
            speeds = self.operator.velocities
            for joint in self.driven:
                if speeds[JOINTS[joint]] * self.arm.servos[joint].position > 0:
                    speeds[JOINTS[joint]] *= -1
            self.operator.begin()
        if self.source:  # muscles drive only after they were seen at rest
            self.source.relaxed = True
            await asyncio.sleep(0.2)
            self.source.relaxed = False
        while not all(abs(self.arm.speed(j)) > 0.3 for j in self.driven):  # noqa: ASYNC110 -- no event for it
            await asyncio.sleep(0.005)
        await asyncio.sleep(random.uniform(0.1, 0.4))

    def observe(self) -> None:
        """From here on everything counts."""
        self.arm.advance(self.now)
        self.arm.watch()
        self.frames.clear()
        self.said.texts.clear()
        if self.operator:
            self.operator.refusals.clear()

    def moved(self, since: float, joints: Collection[int] = range(len(JOINTS))) -> Moved:
        """What the shafts did from a moment (monotonic s) until now."""
        return self.arm.moved(since, self.now, joints)

    def told(self) -> str:
        """What the daemon says of the fault: in its state, to whoever asks, or in its log."""
        faults = (str(frame["fault"]) for frame in self.frames)
        problems = (str(table(frame["emg"])["problem"]) for frame in self.frames) if self.source else ()
        refusals = self.operator.refusals if self.operator else ()
        missed = self.missed() - number(self.frames[0], "missed")
        stale = sum(
            joint["freshness"] != "fresh" for frame in self.frames for joint in tables(frame, "joints")
        )
        counted = [f"{missed:.0f} ticks missed"] if missed else [f"{stale} readings stale"] if stale else []
        found = (*faults, *problems, *refusals, *self.said.texts, *counted)
        return next(filter(None, found), "")

    def missed(self) -> float:
        """Ticks that were missed since the start."""
        return number(self.frames[-1], "missed")

    async def keep_frames(self) -> None:
        """Keep every frame, for ever."""
        async for frame in self.watcher.subscribe_state(rate_hz=500):
            self.frames.append(frame)

    async def recover(self) -> str:
        """Move again by the mildest of the remedies that works; which it was."""
        if self.source:
            return BY_ITSELF if await self._moves_within(3.0) else RESTARTED
        for remedy, calls in REMEDIES.items():
            for method, named in calls:
                with suppress(RpcError):
                    await self.watcher.call(method, **named)
            if await self._obeys():
                return remedy
        return RESTARTED

    async def _obeys(self) -> bool:
        """Whether every joint that was moved can be moved back."""
        for joint in self.driven:
            towards = -0.4 if self.arm.servos[joint].position > 0 else 0.4
            with suppress(RpcError):
                await self.watcher.call("move", joint=JOINTS[joint], velocity=towards, lease_s=0.4)
        since = self.now
        await asyncio.sleep(0.7)
        return all(self.moved(since, (joint,)).degrees > 2 for joint in self.driven)

    async def _moves_within(self, seconds: float) -> bool:
        since = self.now
        await asyncio.sleep(seconds)
        return self.moved(since, self.driven).degrees > 2


@asynccontextmanager
async def rigged(
    by_muscles: bool, assisted: bool, seed: int, *changes: tuple[str, str], random: Random
) -> AsyncIterator[Rig]:
    """An arm in motion: by the muscles of a wearer, or by a client."""
    seeded = ("seed = 1\n\n[safety]", f"seed = {seed}\n\n[safety]")
    worn = ("again and again\nseed = 1", f"again and again\nseed = {seed}\n{PROGRAM}")
    worn_or_not = sim_config(seeded, worn, *changes) if by_muscles else quiet_config(seeded, *changes)
    alone = {} if assisted else {"learn": None, "assist": None}
    config = worn_or_not.model_copy(update=alone)
    velocities = {JOINTS[j]: random.choice((-1, 1)) * random.uniform(*SPEEDS) for j in DRIVEN}
    async with AsyncExitStack() as stack:
        socket = Path(stack.enter_context(TemporaryDirectory()), "bentod.sock")
        arms = stack.enter_context(true_arms("sim.joints"))
        sources = stack.enter_context(opened_sources())
        said = stack.enter_context(_listening())
        watcher = await stack.enter_async_context(running(config, socket))
        operator = None
        if not by_muscles:
            operator = await stack.enter_async_context(operating(socket, velocities))
        rig = Rig(arms[0], socket, watcher, operator, sources[0] if by_muscles else None, said, stack)
        await stack.enter_async_context(rig.lifted)
        keeper = asyncio.create_task(rig.keep_frames())
        stack.push_async_callback(_ended, keeper)
        yield rig


async def _ended(task: asyncio.Task[None]) -> None:
    task.cancel()
    with suppress(asyncio.CancelledError):
        await task


@contextmanager
def _listening() -> Iterator[Said]:
    said = Said()
    root = logging.getLogger()
    root.addHandler(said)
    try:
        yield said
    finally:
        root.removeHandler(said)
