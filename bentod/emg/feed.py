"""What stands between a source of muscle signals and the tick: a task that pumps, and a judgement of life."""

import asyncio
import logging
import math
from collections.abc import Callable

import numpy as np

from bentod.contracts import EmgSource
from bentod.emg import signs
from bentod.emg.drift import Drift
from bentod.emg.windows import Ring
from bentod.errors import BentodError, ConfigError
from bentod.frames import EmgBlock, Samples

STALL_S = (0.01, 0.1)
"""Bounds of the time without a sample: the arm must be asked to stop within 100 ms."""

_logger = logging.getLogger(__name__)


class Feed:
    """The newest samples of one source, and whether they can be believed.

    A source that stalls, or gives values that are not finite, is alive again by itself as soon as good
    samples have come back. One that is lost is alive again when whoever opened it has opened it again, and
    `openings` tells that it was. One that ends or raises is over, and its sentence stays.
    """

    def __init__(self, source: EmgSource, stall_s: float = 0.06, seconds: float = 2.0) -> None:
        """`stall_s`: s without a sample after which the source is not alive; `seconds`: s to keep.

        Raises:
            ConfigError: `stall_s` is out of bounds.
        """
        low, high = STALL_S
        if not low <= stall_s <= high:
            raise ConfigError(
                f"emg.stall_s is {stall_s:g} s; it must be from {low:g} to {high:g} s.", "stall_s"
            )
        self.ring = Ring(source.rate_hz, source.channels, seconds)
        self.dropped = 0
        """Samples that never arrived, since the source was opened."""
        self.heard: Callable[[EmgBlock], None] = lambda _: None
        """Told of every block with samples, before anybody judges it."""
        self.came: Callable[[], None] = lambda: None
        """Told that a block is in the ring."""
        self.prompt: Callable[[str], None] = lambda _: None
        """Where a simulated wearer hears what movement is asked for."""
        self.openings = 1
        """How often the source was opened; between two openings its electrodes may have been moved."""
        self._source = source
        self._stall_s = stall_s
        self._drift = Drift()
        self._arrived = -math.inf
        self._over = ""
        self._lost = ""
        self._bad = ""
        self._bad_time = -math.inf

    async def pump(self) -> None:
        """Take blocks until the source is over. Raises nothing but its own cancellation."""
        try:
            async for block in self._source:
                self._take(block)
            self._over = f"The EMG source ended after sample {self.ring.next_index - 1}."
            _logger.warning(self._over)
        except BentodError as error:
            self._over = f"The EMG source broke: {error}"
            _logger.warning(self._over)
        except Exception as error:
            self._over = f"The EMG source broke: {type(error).__name__}: {error}."
            _logger.exception("The EMG source broke")

    def lost(self, why: str) -> None:
        """The source is not there for now, for the reason that the sentence tells."""
        self._lost = why

    def back(self) -> None:
        """The source was opened again, and its next block is the first since."""
        self._lost = ""
        self.openings += 1
        self._drift = Drift()  # its clock has been set anew

    def _take(self, block: EmgBlock) -> None:
        if not len(block.samples):
            return
        self.heard(block)
        self.dropped += self.ring.append(block)
        self._arrived = asyncio.get_running_loop().time()
        self._drift.take(self.ring.newest, self._arrived)
        finite = np.isfinite(block.samples)
        if not finite.all():
            row, channel = np.argwhere(~finite)[-1]
            self._bad = f"EMG sample {block.first_index + row} of channel {channel} is not a finite number."
            self._bad_time = self.ring.newest + self._drift.offset
        self.came()

    def since(self, index: int) -> Samples:
        """Samples from `index` on (V, shape (n, channels)); see `Ring.since`."""
        return self.ring.since(index)

    def age(self, now: float) -> float:
        """Seconds from the newest sample to `now`, by our clock; infinite when there has been none."""
        return now - self.ring.newest - self._drift.offset

    def lifeless(self, channel: int, least: float, mean_free: bool = False) -> str:
        """Why a channel's newest samples are no muscle's; see `signs.lifeless`."""
        newest = self.ring.since(self.ring.next_index - signs.stretch(self.ring.rate_hz))
        return signs.lifeless(newest, channel, least, mean_free)

    def problem(self, now: float) -> str:
        """Why the signals cannot be believed at `now` (monotonic s), as a sentence; empty when they can.

        Values that are not finite are held against the source for `stall_s`, so that one bad block
        among good ones does not make it flicker.
        """
        if self._over or self._lost:
            return self._over or self._lost
        if self.ring.next_index == 0:
            return "No EMG sample has arrived yet."
        if math.isnan(self.age(now)):
            return "The time of the newest EMG sample is not a number."
        if self.age(now) < -self._stall_s:
            return f"EMG samples are stamped {-self.age(now):.2f} s ahead of the clock."
        if self.age(now) > self._stall_s >= now - self._arrived:
            return (
                f"EMG samples are {self.age(now):.2f} s old when they come; the bound is {self._stall_s:g} s."
            )
        if self.age(now) > self._stall_s:
            return f"No EMG sample for {self.age(now):.2f} s; the bound is {self._stall_s:g} s."
        return self._bad if now - self._bad_time <= self._stall_s else ""

    def alive(self, now: float) -> bool:
        """Whether the newest samples may move the arm at `now` (monotonic s)."""
        return not self.problem(now)
