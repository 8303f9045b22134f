"""A client that tells what the daemon does: it listens and plays, reconnects by itself, and moves nothing."""

import asyncio
import logging
from collections.abc import AsyncIterator, Callable, Coroutine
from contextlib import AbstractAsyncContextManager

from bentod.client import Client
from bentod.config_voice import Voice
from bentod.contracts import AudioPlayer
from bentod.endpoint import Disconnected, RpcError
from bentod.frames import Value
from bentod.voice.cues import Cues
from bentod.voice.glance import glance, told
from bentod.voice.hum import Hum
from bentod.voice.render import Renderer
from bentod.voice.settings import joints_of, table_of
from bentod.voice.tones import RATE_HZ

_log = logging.getLogger(__name__)

RETRY = (0.2, 5.0)
"""s until the first try to reach the daemon again, doubled each time, and at most."""

PASSING = (Disconnected, RpcError)
"""What ends a connection, but not for ever."""


class Narrator:
    """Says through `player` what the daemon tells."""

    def __init__(
        self,
        connect: Callable[[], AbstractAsyncContextManager[Client]],
        player: AudioPlayer,
        table: Voice | None = None,
    ) -> None:
        """`table`: how; None: as the daemon's config says."""
        self._connect = connect
        self._player = player
        self._given = table
        self._cues = Cues()
        self._told_of: tuple[Voice, tuple[str, ...]] = (Voice(enabled=False), ())
        self._renderer = Renderer(*self._told_of)
        self._waiting: list[str] = []  # events to be heard next
        self._wake = asyncio.Event()
        self._said = ""

    async def run(self) -> None:
        """Go on until cancelled.

        Raises:
            BentodError: trying again is of no use, e.g. another could be listening in the daemon's place.
        """
        try:
            await first_of(self._speak(), self._listen_on())
        finally:
            self._player.hum(None)

    async def _listen_on(self) -> None:
        wait = RETRY[0]
        while True:
            began = _now()
            try:
                await self._session()
            except PASSING as error:
                self._say(str(error))
            self._cues.lost()
            wait = RETRY[0] if _now() - began > RETRY[1] else min(2 * wait, RETRY[1])
            await asyncio.sleep(wait)

    async def _session(self) -> None:
        """Listen until the connection ends. Raises BentodError: it did."""
        async with self._connect() as arm:
            await arm.call("hello", name="voice")
            self._prepare(await arm.call("get_info"))
            self._say("telling what the daemon does")
            async with arm.listen("events") as events, arm.listen("state") as frames:
                await first_of(self._watch(frames), self._hear(events))

    async def _watch(self, frames: AsyncIterator[dict[str, Value]]) -> None:
        """Raises Disconnected: the connection is lost."""
        async for frame in frames:
            self._cues.frame(_now(), glance(frame))
            self._tell()

    async def _hear(self, events: AsyncIterator[dict[str, Value]]) -> None:
        """Raises Disconnected: the connection is lost."""
        async for event in events:
            self._cues.event(_now(), told(event))
            self._tell()

    def _prepare(self, info: Value) -> None:
        """Speak of this arm, as it wants."""
        table, joints = self._given or table_of(info), joints_of(info)
        if (table, joints) == self._told_of:
            return
        self._told_of = (table, joints)
        self._renderer = Renderer(table, joints)
        self._waiting = []
        self._wake.set()
        hum = Hum(table.cue_volume, self._renderer.pitches(), lambda: self._cues.selected(_now()))
        loud = table.enabled and table.cue == "tone" and table.cue_volume > 0
        self._player.hum(hum.chunk if loud else None, RATE_HZ)

    def _tell(self) -> None:
        events = self._cues.due(_now())
        if events and self._told_of[0].enabled:
            self._waiting = events
            self._wake.set()

    async def _speak(self) -> None:
        """Play what is to be heard; what is known beforehand is made beforehand."""
        while True:
            await self._wake.wait()
            self._wake.clear()
            events, self._waiting, renderer = self._waiting, [], self._renderer
            wav = await asyncio.to_thread(renderer.wav, events) if events else None
            if wav and not self._waiting:
                self._player.play(wav)
            if not events and self._told_of[0].enabled:
                await self._rehearse(renderer)

    async def _rehearse(self, renderer: Renderer) -> None:
        """Make sounds until one is wanted: to be spoken for the first time takes a word some 30 ms."""
        for event in renderer.events():
            if self._wake.is_set():
                return
            await asyncio.to_thread(renderer.wav, (event,))

    def _say(self, sentence: str) -> None:
        """Log, but not the same again and again."""
        if sentence != self._said:
            _log.info("%s", sentence)
        self._said = sentence


async def first_of(*works: Coroutine[None, None, None]) -> None:
    """All of `works` at once, until the first of them ends. Raises what that does."""
    tasks = [asyncio.create_task(work) for work in works]
    try:
        done, _ = await asyncio.wait(tasks, return_when="FIRST_COMPLETED")
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
    for task in done:
        task.result()


def _now() -> float:
    return asyncio.get_running_loop().time()
