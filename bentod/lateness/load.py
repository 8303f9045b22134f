"""A load to tick under: a thousand requests a second from another process, and work that allocates."""

import asyncio
import subprocess
import sys
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager, contextmanager
from pathlib import Path

from bentod.frames import Value
from bentod.serve.server import Server
from bentod.serve.session import Session
from bentod.serve.spec import table

REQUESTS_HZ = 1000.0

PIECES, EVERY = 400, 0.005
"""Pieces of garbage that are made at once, and how often (s): about a tenth of a core, a third of a
millisecond at a time."""


@contextmanager
def requests(socket: Path) -> Iterator[None]:
    """Another process asks `get_info` at `REQUESTS_HZ` of whoever serves `socket`, also if it comes later."""
    command = [sys.executable, "-m", "bentod.lateness.requester", str(socket), str(REQUESTS_HZ)]
    with subprocess.Popen(command) as process:  # noqa: S603 -- our own program
        try:
            yield
        finally:
            process.kill()


@asynccontextmanager
async def churn() -> AsyncIterator[None]:
    """Work in this loop that allocates, and leaves what only a garbage collection can free."""
    task = asyncio.create_task(_churn(), name="churn")
    try:
        yield
    finally:
        task.cancel()
        await asyncio.wait([task])


async def _churn() -> None:
    while True:
        for number in range(PIECES):
            piece: dict[str, object] = {"number": number, "name": str(number), "list": [number]}
            piece["itself"] = piece
        await asyncio.sleep(EVERY)


@asynccontextmanager
async def answering(socket: Path) -> AsyncIterator[None]:
    """Somebody in this loop who serves `get_info`, where there is no daemon to do so."""

    async def get_info(session: Session) -> Value:
        """As long an answer as an arm's."""
        joint: Value = {"name": "elbow_flexion", "min_rad": -0.405, "max_rad": 0.8, "home_rad": 0.0}
        return {"version": "0", "arm": "none", "rate_hz": 30.0, "joints": [joint] * 5}

    async with Server(table(observer=(get_info,)), socket):
        yield
