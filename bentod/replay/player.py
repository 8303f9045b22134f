"""A recording played at any speed: pause, seek, loop. What it plays goes where live frames would go."""

import asyncio
import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Protocol

from bentod.contracts import Clock
from bentod.errors import BadRequest
from bentod.frames import Frame

FASTEST = math.inf
"""The speed at which nothing is waited for."""


class Source(Protocol):
    """What can be played: entries in the order in which they were recorded."""

    def entries(self, start: float | None = None) -> Iterator[object]:
        """From `start` (monotonic s of the recording) on, or from its beginning."""
        ...


@dataclass(frozen=True, slots=True)
class Span:
    """When a recording begins and ends (monotonic s of the recording)."""

    begin: float
    end: float


class Player:
    """Hands entries to `publish` when they are due. Frames keep the time, the rest goes along with them."""

    def __init__(
        self,
        source: Source,
        span: Span,
        clock: Clock,
        publish: Callable[[object], None],
        speed: float = 1.0,
        loop: bool = False,
        stay: bool = False,
    ) -> None:
        """`speed`: times real time, above 0, or `FASTEST`."""
        self.loop = loop
        self.stay = stay
        self.paused = False
        self.position = 0.0
        """s since the beginning, of the newest frame that was played."""
        self.duration = span.end - span.begin
        self._source = source
        self._span = span
        self._clock = clock
        self._publish = publish
        self._speed = _checked(speed)
        self._changed = asyncio.Event()
        self._sought: float | None = None
        self._arrived = False
        self._anchor: tuple[float, float] | None = None  # clock and recording at the same moment

    @property
    def speed(self) -> float:
        """Times real time."""
        return self._speed

    def set_speed(self, speed: float) -> None:
        """Play at `speed` times real time from now on. Raises BadRequest: it is not above 0."""
        self._speed = _checked(speed)
        self._wake()

    def pause(self, on: bool) -> None:
        """Stand still, or go on."""
        self.paused = on
        self._wake()

    def seek(self, position: float) -> None:
        """Go on from `position` (s since the beginning). Raises BadRequest: beyond the recording."""
        if not 0 <= position <= self.duration:
            raise BadRequest(
                f"position_s = {position:g} is outside the recording, 0 to {self.duration:.3f} s",
                "position_s",
            )
        self._sought = self._span.begin + position
        self._wake()

    async def run(self) -> None:
        """Play to the end; with `loop` again and again, with `stay` until another place is sought."""
        start: float | None = None
        playing = True
        while playing:
            start = await self._play(self._source.entries(start))
            self._anchor = None
            while start is None and self.stay and not self.loop:
                await self._rest(None)
                start = self._go()
            playing = start is not None or self.loop
            await asyncio.sleep(0)

    async def _play(self, entries: Iterable[object]) -> float | None:
        """Play until the end (None), or until another place is sought (s of the recording)."""
        for entry in entries:
            if isinstance(entry, Frame):
                if (sought := await self._wait(entry.time)) is not None:
                    return sought
                self.position = max(0.0, entry.time - self._span.begin)
            self._publish(entry)
        return None

    async def _wait(self, time: float) -> float | None:
        """Until the frame of `time` is due (None), or another place is sought (that)."""
        while self._sought is None:
            due = self._due(time)
            if self._arrived or (not self.paused and due <= self._clock.now()):
                self._arrived = False
                await asyncio.sleep(0)  # however fast, clients get their turn
                return None
            await self._rest(None if self.paused else due)
        return self._go()

    def _go(self) -> float | None:
        """Take what is sought, if anything is; its first frame is shown even while paused."""
        sought, self._sought = self._sought, None
        self._arrived = sought is not None
        return sought

    def _due(self, time: float) -> float:
        """When the frame of `time` is due (s of the clock)."""
        if self._anchor is None:
            self._anchor = (self._clock.now(), time)
        now, then = self._anchor
        return now + (time - then) / self._speed

    async def _rest(self, until: float | None) -> None:
        """Sleep until then, or for as long as nobody changes anything."""
        self._changed.clear()
        if until is None:
            await self._changed.wait()
            return
        waits = [asyncio.ensure_future(self._changed.wait()), asyncio.ensure_future(self._sleep(until))]
        try:
            await asyncio.wait(waits, return_when=asyncio.FIRST_COMPLETED)
        finally:
            for wait in waits:
                wait.cancel()
            await asyncio.gather(*waits, return_exceptions=True)

    async def _sleep(self, until: float) -> None:
        await self._clock.sleep_until(until)

    def _wake(self) -> None:
        self._anchor = None  # time is counted from the next frame on
        self._changed.set()


def _checked(speed: float) -> float:
    if not speed > 0:
        raise BadRequest(f"speed = {speed:g} must be above 0 (times real time)", "speed")
    return speed
