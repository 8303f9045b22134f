"""A browser's own connection to the daemon, made when it first acts: what it holds dies with it."""

import asyncio
from collections.abc import Callable
from contextlib import AbstractAsyncContextManager, AsyncExitStack

from bentod.client import Client
from bentod.endpoint import Disconnected
from bentod.errors import Refused
from bentod.frames import Value

Connect = Callable[[], AbstractAsyncContextManager[Client]]
"""Makes a connection to the daemon; raises as `Client.connect` does."""


class Actor:
    """One client of the daemon that is connected while it is needed; `name`: what others see."""

    def __init__(self, connect: Connect, name: str) -> None:
        self.name = name
        self._connect = connect
        self._opening = asyncio.Lock()
        self._stack = AsyncExitStack()
        self._arm: Client | None = None
        self._over = False

    @property
    def connected(self) -> bool:
        """Whether there is a connection, so that something may be on its way on it."""
        return self._arm is not None

    async def call(
        self, method: str, params: dict[str, Value], still: Callable[[], bool] = lambda: True
    ) -> Value:
        """Ask the daemon, if that is `still` wanted once there is a connection.

        Raises:
            BentodError: it cannot be reached, or refuses, or it is not wanted any more.
        """
        arm = await self._open()
        if not still():
            raise Refused("somebody pressed STOP meanwhile")
        try:
            return await arm.call(method, **params)
        except Disconnected:
            if arm is self._arm:
                await self._leave()
            raise

    async def close(self) -> None:
        """Leave for good, and with it whatever was asked for."""
        self._over = True
        await self._leave()

    async def _open(self) -> Client:
        async with self._opening:
            if self._over:
                raise Refused("the page is gone")
            if self._arm is None:
                arm = await self._stack.enter_async_context(self._connect())
                await arm.call("hello", name=self.name)
                self._arm = arm
            return self._arm

    async def _leave(self) -> None:
        self._arm = None
        stack, self._stack = self._stack, AsyncExitStack()
        await stack.aclose()
