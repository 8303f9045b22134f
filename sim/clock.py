"""Virtual time: an event loop that jumps to its next timer, so that a minute of arm costs milliseconds."""

import asyncio
import selectors
from collections.abc import Coroutine
from typing import TypeVar

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


def run(main: Coroutine[object, object, T]) -> T:
    """Run `main` in virtual time and return its result."""
    with asyncio.Runner(loop_factory=VirtualLoop) as runner:
        return runner.run(main)
