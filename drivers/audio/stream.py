"""A sound without end: samples into the pipe of one program that plays them, a little at a time."""

import asyncio
import fcntl
import logging
import os
from collections.abc import Callable, Sequence

from drivers.audio.child import Child, dropped, started
from drivers.audio.commands import Command
from drivers.audio.complaints import Complaints

log = logging.getLogger(__name__)

PIPE = 8192
"""Bytes that may wait for the program: at 22,050 samples a second 186 ms, so that a change is soon heard. Two
pages are the least: a pipe of one takes nothing until it is empty, and then the sound has gaps."""

LEAD = 0.1
"""s of sound that are made at once where there is none, so that the program has some to begin with."""

AHEAD = 1.02
"""How much faster samples are made than they are played: what the full pipe holds back makes up for it, and a
sound card whose clock runs a little fast never starves."""

HANGS = 2.0
"""s for which a program may take nothing before it is ended."""

IDLE = 3.0
"""s of silence after which the program ends."""

LOOK = 0.05
"""s between two looks at a source that has been silent for long."""

FULL = 0.02
"""s until the next try to write to a pipe that was full, or to get sound from a source that is silent."""

RETRY = (0.5, 30.0)
"""s until the next try after a program died, doubled each time, and at most."""


class Hangs(Exception):
    """The program takes nothing any more."""


class Stream:
    """Plays what its source gives, through the first of `commands` that can; starts again what ends."""

    def __init__(self, commands: Sequence[Command]) -> None:
        self._commands = list(commands)
        self._source: Callable[[], bytes] | None = None
        self._rate_hz = 0
        self._changed = asyncio.Event()
        self._complaints = Complaints(log, "the quiet tones")

    def source(self, source: Callable[[], bytes] | None, rate_hz: int) -> None:
        """Where samples come from, from now on."""
        self._source, self._rate_hz = source, rate_hz
        self._changed.set()

    async def run(self) -> None:
        """Play until cancelled."""
        wait = RETRY[0]
        while True:
            chunk = await self._sound()
            started_at = _now()
            why = await self._play(chunk)
            if not why:
                self._complaints.settled()
                wait = RETRY[0]
                continue
            self._complaints.add(f"{self._commands[0].name} does not play: {why}")
            self._commands.append(self._commands.pop(0))
            if _now() - started_at > RETRY[1]:
                wait = RETRY[0]
            await asyncio.sleep(wait)
            wait = min(2 * wait, RETRY[1])

    async def _sound(self) -> bytes:
        """The first samples after silence."""
        while True:
            if self._source is None or not self._commands:
                self._changed.clear()
                await self._changed.wait()
            elif chunk := self._source():
                return chunk
            else:
                await asyncio.sleep(LOOK)

    async def _play(self, chunk: bytes) -> str:
        """From `chunk` on, until there is silence for a while; why the program ended before, if it did."""
        out, into = os.pipe()
        try:
            fcntl.fcntl(into, fcntl.F_SETPIPE_SZ, PIPE)
            os.set_blocking(into, False)
            words = self._commands[0].to_stream(self._rate_hz)
            async with started(words, out) as child:
                return await self._until_ended(child, into, chunk)
        except OSError as error:
            return error.strerror or str(error)
        finally:
            os.close(out)
            os.close(into)

    async def _until_ended(self, child: Child, into: int, chunk: bytes) -> str:
        ended = asyncio.ensure_future(child.end())
        pouring = asyncio.ensure_future(self._pour(into, chunk))
        try:
            await asyncio.wait({ended, pouring}, return_when="FIRST_COMPLETED")
            if ended.done():
                return child.complaint
            pouring.result()
        except Hangs:
            return f"it took nothing for {HANGS:g} s, and was ended"
        finally:
            await dropped(ended, pouring)
        return ""

    async def _pour(self, into: int, chunk: bytes) -> None:
        """Write until there has been silence for `IDLE`. Raises Hangs: nothing is taken."""
        due = taken = heard = _now()
        while _now() - heard < IDLE:
            count = _write(into, chunk)
            if count or not chunk:
                taken, chunk = _now(), chunk[count:]
                due = max(due, taken - LEAD) + count / (2 * self._rate_hz * AHEAD)
            elif _now() - taken > HANGS:
                raise Hangs
            if not chunk and (chunk := self._source() if self._source else b""):
                heard = _now()
            await asyncio.sleep(max(due - _now(), 0.0) if count and chunk else FULL)


def _now() -> float:
    return asyncio.get_running_loop().time()


def _write(into: int, chunk: bytes) -> int:
    """How many bytes there was room for; none, too, once nobody reads: that is told by the program's end."""
    try:
        return os.write(into, chunk)
    except (BlockingIOError, BrokenPipeError):
        return 0
