"""Faults of real processes: a daemon and clients that are killed or stopped, on servos behind a serial port.

The servos are simulated in this process, so that their shafts can be looked at.
"""

import asyncio
import io
from collections.abc import AsyncIterator, Coroutine, Sequence
from contextlib import AsyncExitStack, asynccontextmanager, redirect_stdout, suppress
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from bentod.client import Client
from bentod.endpoint import Disconnected, RpcError
from bentod.frames import Value
from sim import bus_config
from sim.bus_process import BusProcess
from tests.rig import CONFIGS
from tests.system.campaign.operator import Operator, operating
from tests.system.campaign.outcome import Moved
from tests.system.campaign.truth import TrueArm, true_arms
from tests.system.processes import BENTOD, environment

JOINT, SPEED = "shoulder_rotation", 0.6
"""The worst damped joint, and rad/s."""

CONFIG, PORT, SOCKET, LOG = "bento.toml", "port", "bentod.sock", "log"

PATIENCE = 40.0
"""s that a daemon may take to start and to arm five servos, on a machine that has much else to do."""

PATIENT_BUS = "baud = 1_000_000", "baud = 1_000_000\nreply_margin_s = 0.05"
"""On a machine that has much else to do, simulated servos may reply late; elsewhere it changes nothing."""

TRIES = 3
"""Moves that are asked for, for the same reason."""

LOOKED = 0.005
"""s between two looks at the shafts."""

CLIENT = f"""
import time
from contextlib import suppress
from bentod.blocking import BlockingClient
from bentod.endpoint import RpcError
with BlockingClient(__import__("sys").argv[1]) as arm:
    while True:
        with suppress(RpcError):  # on a busy machine the daemon may have been held up
            arm.call("move", joint="{JOINT}", velocity={SPEED})
        time.sleep(0.1)
"""
"""A client that renews its lease, for a process of its own."""


@dataclass(slots=True)
class Real:
    """A daemon's process, its port's other end, and where everything is."""

    arm: TrueArm
    folder: Path
    stack: AsyncExitStack
    process: asyncio.subprocess.Process

    @property
    def socket(self) -> Path:
        """Where the daemon serves."""
        return self.folder / SOCKET

    @property
    def now(self) -> float:
        """Monotonic s."""
        return asyncio.get_running_loop().time()

    async def moved(self, since: float, seconds: float) -> Moved:
        """What the shafts do from `since` (monotonic s) until `seconds` from now."""
        until = self.now + seconds
        await asyncio.sleep(seconds)
        return self.arm.moved(since, until, range(len(self.arm.servos)))

    async def operate(self) -> Operator:
        """A client in this process that moves the joint."""
        operator = await self.stack.enter_async_context(operating(self.socket, {JOINT: SPEED}))
        operator.begin()
        await self.until_it_moves()
        return operator

    async def until_it_moves(self) -> None:
        """The joint is in motion, and watched."""
        async with asyncio.timeout(PATIENCE):
            while abs(self.arm.speed(0)) < SPEED / 2:  # noqa: ASYNC110 -- there is no event for a shaft
                await asyncio.sleep(LOOKED)
        await asyncio.sleep(0.2)
        self.arm.watch()

    async def call(self, method: str, **named: Value) -> Value:
        """Ask something over a connection of its own."""
        async with Client.connect(self.socket) as arm:
            return await arm.call(method, **named)

    async def obeys(self) -> bool:
        """Whether the joint can be moved back."""
        async with Client.connect(self.socket) as arm:
            for _ in range(TRIES):
                since = self.now
                with suppress(RpcError, Disconnected):
                    await arm.call("move", joint=JOINT, velocity=-0.4, lease_s=0.5)
                if (await self.moved(since, 0.7)).degrees > 2:
                    return True
        return False

    async def released(self) -> None:
        """Return once the daemon serves, and the arm may move."""
        async with asyncio.timeout(PATIENCE):
            while not await self._released():  # noqa: ASYNC110 -- nor for a daemon
                await asyncio.sleep(0.05)

    async def restart(self) -> None:
        """Another daemon on the same arm, in the place of one that is gone."""
        self.process = await spawn(self.folder, *daemon(self.folder))
        self.stack.push_async_callback(ended, self.process)
        await self.released()

    async def _released(self) -> bool:
        with suppress(RpcError, Disconnected):  # a bus on a busy machine is slow, and that is a fault
            await self.call("clear_fault")
        with suppress(RpcError, Disconnected):
            await self.call("torque", on=True)
            await self.call("pause", on=False)
            return True
        return False

    def log(self) -> str:
        """What the daemon has said."""
        return (self.folder / LOG).read_text()


async def spawn(folder: Path, *words: str, output: Path | None = None) -> asyncio.subprocess.Process:
    """A process; what it says goes to `output`, or to the log."""
    nothing = asyncio.subprocess.DEVNULL
    with (output or folder / LOG).open("ab") as log:
        return await asyncio.create_subprocess_exec(
            *words, stdin=nothing, stdout=log, stderr=log, env=environment(folder)
        )


def daemon(folder: Path) -> Sequence[str]:
    """The words that start the daemon on the arm of `folder`."""
    files = {"--config": CONFIG, "--port": PORT, "--socket": SOCKET}
    return (*BENTOD, "run", "--no-view", *(word for o, f in files.items() for word in (o, str(folder / f))))


@asynccontextmanager
async def real_arm(output: Path | None = None) -> AsyncIterator[Real]:
    """A daemon on a serial port, its arm released to move; what it says goes to `output`, or to its log."""
    async with AsyncExitStack() as stack:
        folder = Path(stack.enter_context(TemporaryDirectory()))
        (folder / CONFIG).write_text((CONFIGS / CONFIG).read_text().replace(*PATIENT_BUS))
        arms = stack.enter_context(true_arms("sim.bus_process"))
        bus = BusProcess(bus_config.load(folder / CONFIG, 1), folder / PORT, timing=True)
        _background(stack, bus.run())
        with redirect_stdout(io.StringIO()):  # it tells its port
            await asyncio.sleep(LOOKED)
        real = Real(arms[0], folder, stack, await spawn(folder, *daemon(folder), output=output))
        stack.push_async_callback(ended, real.process)
        await real.released()
        yield real


def _background(stack: AsyncExitStack, work: Coroutine[object, object, None]) -> None:
    task = asyncio.create_task(work)

    async def end() -> None:
        task.cancel()
        with suppress(asyncio.CancelledError):
            await task

    stack.push_async_callback(end)


async def ended(process: asyncio.subprocess.Process) -> None:
    """Kill a process that the fault has left, stopped or not."""
    if process.returncode is None:
        process.kill()
    await process.wait()
