"""Sounds through pw-play, paplay or aplay: the newest wins, and a program that dies or hangs is dropped."""

import asyncio
import logging
import tempfile
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from typing import BinaryIO

from bentod.contracts import AudioPlayer
from drivers.audio.child import Child, dropped, started
from drivers.audio.commands import Command, installed
from drivers.audio.complaints import Complaints
from drivers.audio.stream import Stream

log = logging.getLogger(__name__)

LONGEST = 15.0
"""s after which a program that still plays one sound hangs: no sound lasts as long."""


@asynccontextmanager
async def open_player() -> AsyncIterator[AudioPlayer]:
    """A player for as long as it is entered."""
    commands = installed()
    if not commands:
        log.warning("There is no pw-play, paplay or aplay on the path: nothing will be heard.")
    player = CommandPlayer(commands)
    tasks = [
        asyncio.create_task(player.run(), name="sounds"),
        asyncio.create_task(player.stream.run(), name="hum"),
    ]
    try:
        yield player
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)


class CommandPlayer:
    """Plays by whatever of `commands` works; the one that did is tried first the next time."""

    def __init__(self, commands: tuple[Command, ...]) -> None:
        self._commands = [command for command in commands if command.file]
        self._waiting: bytes | None = None
        self._wake = asyncio.Event()
        self._complaints = Complaints(log, "sounds")
        self.stream = Stream([command for command in commands if command.stream])

    def play(self, wav: bytes) -> None:
        """Play a whole WAV file at once; one that still sounds ends."""
        if self._commands:
            self._waiting = wav
            self._wake.set()

    def hum(self, source: Callable[[], bytes] | None, rate_hz: int = 0) -> None:
        """From now on play, besides, what `source` gives: None for nothing."""
        self.stream.source(source, rate_hz)

    async def run(self) -> None:
        """Play what comes, until cancelled."""
        while True:
            await self._wake.wait()
            self._wake.clear()
            wav, self._waiting = self._waiting, None
            if wav is not None:
                await self._play(wav)

    async def _play(self, wav: bytes) -> None:
        """Until it has been heard, or there is something newer."""
        for command in tuple(self._commands):
            if self._wake.is_set():
                return
            with tempfile.TemporaryFile() as file:
                file.write(wav)
                file.seek(0)
                why = await self._why_not(command, file)
            if not why:
                self._commands.sort(key=lambda other: other is not command)
                self._complaints.settled()
                return
            self._complaints.add(f"{command.name} does not play: {why}")

    async def _why_not(self, command: Command, file: BinaryIO) -> str:
        """Play `file`; why it was not heard, empty if it was, or something newer has come."""
        try:
            async with started(command.to_play(), file) as child:
                return await self._heard(child)
        except OSError as error:
            return error.strerror or str(error)

    async def _heard(self, child: Child) -> str:
        """As `_why_not`."""
        ended, newer = asyncio.ensure_future(child.end()), asyncio.ensure_future(self._newer())
        try:
            await asyncio.wait({ended, newer}, timeout=LONGEST, return_when="FIRST_COMPLETED")
            if newer.done():
                return ""
            if not ended.done():
                return f"it hangs, and was ended after {LONGEST:g} s"
            return child.complaint if ended.result() else ""
        finally:
            await dropped(ended, newer)

    async def _newer(self) -> None:
        await self._wake.wait()
