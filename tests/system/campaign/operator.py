"""Who asks the arm to move: a client that renews its leases ten times a second."""

import asyncio
from collections.abc import AsyncIterator, Mapping
from contextlib import AsyncExitStack, asynccontextmanager
from pathlib import Path

from bentod.client import Client
from bentod.endpoint import Disconnected, RpcError

RENEWAL = 0.1
"""s between two renewals; the lease is twice as long."""


class Operator:
    """A client, what it asks for (rad/s, by joint), and what it was told."""

    def __init__(self, arm: Client, leave: AsyncExitStack, velocities: Mapping[str, float]) -> None:
        self.arm = arm
        self.velocities = dict(velocities)
        self.last = 0.0
        """Monotonic s of its last word."""
        self.refusals: list[str] = []
        self._leave = leave
        self._task: asyncio.Task[None] | None = None

    def begin(self) -> None:
        """Ask until told otherwise."""
        self._task = self._task or asyncio.create_task(self._renew())

    def let_go(self) -> float:
        """Ask no more; the monotonic s of the last word."""
        if self._task:
            self._task.cancel()
            self._task = None
        return self.last

    async def vanish(self) -> None:
        """Be gone, with whatever was asked."""
        self.let_go()
        await self._leave.aclose()

    async def _renew(self) -> None:
        loop = asyncio.get_running_loop()
        due = loop.time()
        while True:
            self.last = loop.time()
            await asyncio.gather(*(self._ask(joint, speed) for joint, speed in self.velocities.items()))
            due = max(due + RENEWAL, loop.time())
            await asyncio.sleep(due - loop.time())

    async def _ask(self, joint: str, velocity: float) -> None:
        try:
            async with asyncio.timeout(RENEWAL):
                await self.arm.call("move", joint=joint, velocity=velocity)
        except (RpcError, Disconnected, TimeoutError) as error:
            self.refusals.append(str(error))


@asynccontextmanager
async def operating(socket: Path, velocities: Mapping[str, float]) -> AsyncIterator[Operator]:
    """An operator that has not begun yet."""
    async with AsyncExitStack() as leave:
        arm = await leave.enter_async_context(Client.connect(socket))
        operator = Operator(arm, leave, velocities)
        try:
            await arm.call("hello", "ann")
            yield operator
        finally:
            operator.let_go()
