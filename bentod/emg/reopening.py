"""A source of muscle signals that is opened again when it broke, as if it had only lost samples meanwhile."""

import logging
import math
from collections.abc import AsyncGenerator, AsyncIterator, Callable
from contextlib import AbstractAsyncContextManager, AsyncExitStack, asynccontextmanager
from dataclasses import replace
from typing import TypeAlias

from bentod.contracts import Clock, EmgSource, Promptable
from bentod.errors import BentodError, InputFileError
from bentod.frames import EmgBlock

WAITS_S = (0.5, 10.0)
"""s before the first attempt, and at most before any: each wait is twice the one before. A source that has
lasted for longer than the longest wait begins with the shortest again."""

SAME_RATE = 0.01
"""Share by which the rate may be another one after the source was opened again."""

Open: TypeAlias = Callable[[], AbstractAsyncContextManager[EmgSource]]

_logger = logging.getLogger(__name__)


class Reopening:
    """The source, each time it is opened; it has broken when it raises, and is over when it ends.

    Indices go on over what is missing, reckoned from the times of the blocks, so nothing shifts.
    """

    def __init__(self, opens: Open, stack: AsyncExitStack, source: EmgSource, clock: Clock) -> None:
        """`stack` holds the source that `opens` opened first, and nothing else."""
        self.rate_hz = source.rate_hz
        self.channels = source.channels
        self.lost: Callable[[str], None] = lambda _: None
        """Told why the source is not there, as a sentence, when it broke and whenever the reason changes."""
        self.back: Callable[[], None] = lambda: None
        """Told just before the first block after that."""
        self._open = opens
        self._stack = stack
        self._source = source
        self._clock = clock
        self._next = 0  # index after the newest sample
        self._base = 0  # index of sample 0 of the source as it is open now
        self._ends = math.nan  # monotonic s at which the next sample was due
        self._since: float | None = None  # monotonic s, when it broke
        self._why = ""
        self._wait = WAITS_S[0]

    async def __aiter__(self) -> AsyncIterator[EmgBlock]:
        """Blocks, whatever happens to the source, until it ends by itself."""
        while True:
            opened = self._clock.now()
            blocks = aiter(self._source)
            try:
                async for block in blocks:
                    yield self._placed(block)
                return
            except Exception as error:  # noqa: BLE001 -- of a driver that may be a stranger's
                self._broke(f"The EMG source broke: {_sentence(error)}", error)
            if isinstance(blocks, AsyncGenerator):  # it may not know yet that what it gave was wrong
                await blocks.aclose()
            if self._clock.now() - opened > WAITS_S[1]:
                self._wait = WAITS_S[0]
            await self._again()

    def prompt(self, label: str) -> None:
        """Ask a movement of a simulated wearer; nothing happens with any other source."""
        if isinstance(self._source, Promptable):
            self._source.prompt(label)

    def _placed(self, block: EmgBlock) -> EmgBlock:
        """The block where it belongs among all that came before.

        Raises:
            InputFileError: it does not follow the block before, or has another number of channels.
        """
        if not len(block.samples):
            return block
        if block.samples.shape[1] != self.channels:
            raise InputFileError(
                f"a block of {block.samples.shape[1]} channels came from {self.channels} channels."
            )
        if self._since is not None:
            self._begin(block, self._since)
        first = self._base + block.first_index
        if first < self._next:
            raise InputFileError(f"sample {first} came after sample {self._next - 1}.")
        missing = max(block.dropped, first - self._next)
        self._next = first + len(block.samples)
        self._ends = block.time + len(block.samples) / self.rate_hz
        return replace(block, first_index=first, dropped=missing)

    def _begin(self, block: EmgBlock, since: float) -> None:
        """Go on with a source that gives its first block again."""
        late = (block.time - self._ends) * self.rate_hz
        missing = max(round(late), 0) if math.isfinite(late) else 0
        self._base = self._next + missing - block.first_index
        _logger.info("The EMG source is back after %.1f s.", self._clock.now() - since)
        self._since, self._why = None, ""
        self.back()

    def _broke(self, why: str, error: Exception) -> None:
        """Say why the source is not there, each reason once."""
        if self._since is None:
            self._since = self._clock.now()
        if why == self._why:
            return
        self._why = why
        self.lost(why)
        _logger.warning(why, exc_info=None if isinstance(error, BentodError | OSError) else error)

    async def _again(self) -> None:
        """Close the source and open it anew, however often that takes."""
        broke = self._why
        while True:
            try:
                await self._stack.aclose()
            except Exception:
                _logger.exception("The EMG source broke, and could not be closed")
            await self._clock.sleep_until(self._clock.now() + self._wait)
            self._wait = min(2 * self._wait, WAITS_S[1])
            try:
                self._source = await self._stack.enter_async_context(self._open())
                self._check(self._source)
            except Exception as error:  # noqa: BLE001 -- of a driver that may be a stranger's
                self._broke(f"{broke} It cannot be opened again: {_sentence(error)}", error)
            else:
                return

    def _check(self, source: EmgSource) -> None:
        same = math.isclose(source.rate_hz, self.rate_hz, rel_tol=SAME_RATE)
        if not same or source.channels != self.channels:
            raise InputFileError(
                f"it has {source.channels} channels at {source.rate_hz:g} Hz now; "
                f"it had {self.channels} at {self.rate_hz:g} Hz."
            )


def _sentence(error: Exception) -> str:
    return str(error) if isinstance(error, BentodError) else f"{type(error).__name__}: {error}."


@asynccontextmanager
async def reopening(opens: Open, clock: Clock) -> AsyncIterator[Reopening]:
    """The source that `opens` opens, opened again whenever it broke.

    Raises:
        ConfigError, InputFileError: it cannot be opened now, as `opens` says.
    """
    async with AsyncExitStack() as stack:
        source = await stack.enter_async_context(opens())
        yield Reopening(opens, stack, source, clock)
