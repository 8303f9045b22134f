"""Virtual time: an event loop that jumps to its next timer, so that a minute of arm costs milliseconds."""

import asyncio
import selectors
from collections.abc import Coroutine
from typing import TypeVar

from bentod.contracts import Clock

T = TypeVar("T")

EPOCH = 1_700_000_000.0
"""Wall time at virtual second 0."""


class _JumpingSelector(selectors.DefaultSelector):
    """Instead of waiting for a timer, moves the clock to it. Input that is already there comes first."""

    def __init__(self) -> None:
        super().__init__()
        self.now = 0.0

    def select(self, timeout: float | None = None) -> list[tuple[selectors.SelectorKey, int]]:
        """Events that are ready; with none and a timer pending, time passes and the list is empty."""
        if timeout is None:
            return super().select(None)
        ready = super().select(0)
        if not ready and timeout > 0:
            self.now += timeout
        return ready


class VirtualLoop(asyncio.SelectorEventLoop):
    """An event loop whose `time()` starts at 0 and passes only while nothing is left to do."""

    def __init__(self) -> None:
        self._jumping = _JumpingSelector()
        super().__init__(self._jumping)
        self._clock_resolution = 1e-9  # timers fire at their own time, not with their neighbours

    def time(self) -> float:
        """Virtual seconds."""
        return self._jumping.now

    def block(self, seconds: float) -> None:
        """Let time pass in which nobody gets a turn, as a callback does that computes for so long."""
        self._jumping.now += seconds


class VirtualClock:
    """The clock of a VirtualLoop; also tells a plain loop's time, for tests that need real sockets."""

    def now(self) -> float:
        """Seconds of the running loop."""
        return asyncio.get_running_loop().time()

    def wall(self) -> float:
        """Virtual seconds since the epoch."""
        return EPOCH + self.now()

    async def sleep_until(self, deadline: float) -> None:
        """Return once the loop has reached `deadline` (s)."""
        loop = asyncio.get_running_loop()
        if deadline <= loop.time():
            await asyncio.sleep(0)
            return
        reached = loop.create_future()
        timer = loop.call_at(deadline, reached.set_result, None)
        try:
            await reached
        finally:
            timer.cancel()


class DriftingClock:
    """A clock of a device's own: right at first, and fast from then on by a share that may change."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._drift = 0.0
        self._then = self._shown = clock.now()

    @property
    def drift(self) -> float:
        """Share by which it is fast, negative if it is slow. It never jumps."""
        return self._drift

    @drift.setter
    def drift(self, share: float) -> None:
        self._shown, self._then = self.now(), self._clock.now()
        self._drift = share

    def now(self) -> float:
        """Seconds as this clock counts them."""
        return self._shown + (self._clock.now() - self._then) * (1 + self._drift)

    def wall(self) -> float:
        """Seconds since the epoch, of the true clock."""
        return self._clock.wall()

    async def sleep_until(self, deadline: float) -> None:
        """Return once this clock shows `deadline` (s)."""
        await self._clock.sleep_until(self._then + (deadline - self._shown) / (1 + self._drift))


def run(main: Coroutine[object, object, T]) -> T:
    """Run `main` in virtual time and return its result."""
    with asyncio.Runner(loop_factory=VirtualLoop) as runner:
        return runner.run(main)
