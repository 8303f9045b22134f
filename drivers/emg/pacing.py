"""When the blocks of a source without hardware are due: absolute deadlines, true indices, counted losses."""

from dataclasses import dataclass

from bentod.contracts import Clock
from bentod.errors import ConfigError

SLOWEST_HZ = 20.0
"""Below this, the samples lie further apart (50 ms) than a stall may last."""

BLOCK_S = 0.01
"""Usual length of a block: the period at which acquisition devices are read, 2 samples at 200 Hz."""

BUFFER_S = 1.0
"""Usual length of the queue between a source and a consumer that is late."""


@dataclass(frozen=True, slots=True)
class Slot:
    """The place of one block in time."""

    first: int  # index of its first sample
    size: int  # samples
    time: float  # monotonic s of its first sample
    dropped: int  # samples lost just before it, because the consumer was too late


class Pacer:
    """Blocks of a constant rate. Sample 0 is taken when the first block is asked for.

    A block is due when its last sample has been taken. A consumer that is late gets the waiting blocks
    at once, with the times at which they were due; one later than `buffer_s` finds that the queue has
    overflowed: everything but the newest whole block is lost, and counted.
    """

    def __init__(self, clock: Clock, rate_hz: float, block_s: float, buffer_s: float) -> None:
        """`rate_hz`: samples a second; `block_s`: s, at least one sample; `buffer_s`: s.

        Raises:
            ConfigError: the rate is below 20 Hz.
        """
        if rate_hz < SLOWEST_HZ:
            raise ConfigError(
                f"EMG would arrive at {rate_hz:g} Hz; the bound is {SLOWEST_HZ:g} Hz.", "rate_hz"
            )
        self._clock = clock
        self._rate_hz = rate_hz
        self._size = max(1, round(block_s * rate_hz))
        self._buffer_s = buffer_s
        self._start: float | None = None
        self._first = 0

    async def next(self) -> Slot:
        """Wait until the next block is due."""
        if self._start is None:
            self._start = self._clock.now()
        due = self._start + (self._first + self._size - 1) / self._rate_hz
        await self._clock.sleep_until(due)
        dropped = self._overflow(self._clock.now() - due)
        first = self._first + dropped
        self._first = first + self._size
        return Slot(first, self._size, self._start + first / self._rate_hz, dropped)

    def _overflow(self, late: float) -> int:
        """Samples that did not fit into the queue, in whole blocks, when the next block is `late` (s)."""
        if late <= self._buffer_s:
            return 0
        return int(late * self._rate_hz) // self._size * self._size
