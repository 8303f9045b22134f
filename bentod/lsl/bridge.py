"""From the daemon's socket to streams of the lab streaming layer, for as long as anybody wants."""

import asyncio
import logging
from collections.abc import Callable, Iterator
from contextlib import AbstractAsyncContextManager, AsyncExitStack
from types import TracebackType
from typing import Self

from bentod.client import Client
from bentod.endpoint import Disconnected, RpcError
from bentod.errors import BentodError
from bentod.frames import Value
from bentod.lsl.sender import Sender

_log = logging.getLogger(__name__)

RETRY = (0.1, 5.0)
"""s until the first try to reach the daemon again, doubled each time, and at most."""

PASSING = (Disconnected, RpcError)
"""What ends a connection, but not for ever."""

EVERY = 500.0
"""Hz, as often as the socket sends frames at most: every one of them."""


class Bridge:
    """Streams what the daemon tells. They stay on the network while the daemon is away, and say nothing."""

    def __init__(
        self,
        connect: Callable[[], AbstractAsyncContextManager[Client]],
        sender: Sender,
        topics: tuple[str, ...] = ("state", "emg", "events"),
    ) -> None:
        self._connect = connect
        self._sender = sender
        self._topics = topics
        self._said = ""

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._sender.close()

    async def run(self) -> None:
        """Go on until cancelled.

        Raises:
            BentodError: trying again is of no use: the daemon's clock is another machine's, or somebody
                else could be listening in its place.
        """
        wait = RETRY[0]
        while True:
            told = self._sender.told
            end = await self._ended()
            if not isinstance(end, PASSING):
                raise end
            self._say(str(end))
            wait = RETRY[0] if self._sender.told > told else min(2 * wait, RETRY[1])
            await asyncio.sleep(wait)

    async def _ended(self) -> BentodError:
        """Stream until the connection ends; returns why it did."""
        end: BentodError = Disconnected("The daemon has none of these topics.")
        # In a task of its own: a task group that breaks in the moment in which it is cancelled raises its own
        # errors only, and that it was to end would be lost.
        session = asyncio.create_task(self._session(), name="lsl session")
        try:
            await asyncio.wait([session])
        finally:
            session.cancel()
            await asyncio.gather(session, return_exceptions=True)
        try:
            session.result()
        except* BentodError as ended:
            end = _gravest(ended)
        return end

    async def _session(self) -> None:
        """Stream until the connection ends. Raises BentodError, in a group or not: it did."""
        async with self._connect() as arm, asyncio.TaskGroup() as tasks:
            await arm.call("hello", name="lsl")
            self._sender.begin(await arm.call("get_info"), await _sites(arm))
            self._say("streaming what the daemon tells")
            for topic in self._topics:
                tasks.create_task(self._relay(arm, topic), name=topic)

    async def _relay(self, arm: Client, topic: str) -> None:
        """Stream one topic; one that this daemon does not have is left out."""
        async with AsyncExitStack() as stack:
            try:
                entries = await stack.enter_async_context(arm.listen(topic, EVERY))
            except RpcError as error:
                _log.warning("no stream of %s: %s", topic, error)
                return
            async for entry in entries:
                self._sender.take(topic, entry)

    def _say(self, sentence: str) -> None:
        """Log, but not the same again and again."""
        if sentence != self._said:
            _log.info("%s", sentence)
        self._said = sentence


async def _sites(arm: Client) -> Value:
    """What the daemon tells of its muscle signals; nil if it cannot."""
    try:
        return await arm.call("emg_get")
    except RpcError:
        return None


def _gravest(group: ExceptionGroup[BentodError]) -> BentodError:
    """One that trying again does not mend, if there is one."""
    found = sorted(_flat(group), key=lambda error: isinstance(error, PASSING))
    return found[0]


def _flat(group: ExceptionGroup[BentodError]) -> Iterator[BentodError]:
    for error in group.exceptions:
        if isinstance(error, ExceptionGroup):
            yield from _flat(error)
        else:
            yield error
