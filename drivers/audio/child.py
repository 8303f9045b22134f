"""A program that plays sound, as a child of ours: it never holds up the loop, and is never left behind."""

import asyncio
import os
import signal
from asyncio.subprocess import DEVNULL, PIPE, Process
from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager, suppress
from typing import BinaryIO

MOST_STDERR = 300
"""Bytes of what a program complains of that are told."""


class Child:
    """One program under way."""

    def __init__(self, process: Process) -> None:
        self._process = process
        self._said = b""
        self._listening = asyncio.create_task(self._listen())

    async def end(self) -> int:
        """Its exit code, once it has ended, and all is heard that it said."""
        code = await self._process.wait()
        await asyncio.wait({self._listening}, timeout=0.1)  # what it has started may not let go of the pipe
        return code

    @property
    def complaint(self) -> str:
        """What it said first, in one line."""
        said = " ".join(self._said.decode(errors="replace").split())
        return said or f"it ended with {self._process.returncode}"

    async def gone(self) -> None:
        """End it, and wait until it has."""
        self.kill()
        self._listening.cancel()
        await asyncio.gather(self._listening, return_exceptions=True)
        await self._process.wait()

    async def _listen(self) -> None:
        """Take whatever it complains of, so that it never waits for somebody to."""
        stream = self._process.stderr
        while stream and (piece := await stream.read(4096)):
            self._said = (self._said + piece)[:MOST_STDERR]

    def kill(self) -> None:
        """End it, and what it has started, whatever it is at."""
        with suppress(ProcessLookupError):
            os.killpg(self._process.pid, signal.SIGKILL)


async def dropped(*tasks: "asyncio.Future[int] | asyncio.Future[bool] | asyncio.Future[None]") -> None:
    """Cancel what nobody waits for any more, and wait until it is over."""
    for task in tasks:
        task.cancel()
    await asyncio.gather(*tasks, return_exceptions=True)


@asynccontextmanager
async def started(words: Sequence[str], stdin: BinaryIO | int) -> AsyncIterator[Child]:
    """A program that reads `stdin`; gone at the end. Raises OSError: it cannot be started."""
    # In a group of its own, so that Ctrl-C is ours alone to answer.
    process = await asyncio.create_subprocess_exec(
        *words, stdin=stdin, stdout=DEVNULL, stderr=PIPE, start_new_session=True
    )
    child = Child(process)
    try:
        yield child
    finally:
        await asyncio.shield(child.gone())
