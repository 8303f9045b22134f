"""A ring of the newest samples, in which any stretch can be looked at without copying."""

import math

import numpy as np

from bentod.frames import EmgBlock, Samples


class Ring:
    """The newest `seconds` of a source, by sample index.

    Samples that never arrived are NaN, so whoever reads a stretch sees what is missing, and indices never
    shift; values that are not finite stay as they came. The rows are twice the capacity: the newest half
    moves to the front when the end is reached, so that every stretch lies in one piece.
    """

    def __init__(self, rate_hz: float, channels: int, seconds: float = 2.0) -> None:
        self.rate_hz = rate_hz
        self.channels = channels
        self.capacity = math.ceil(rate_hz * seconds)
        self.next_index = 0
        """Index after the newest sample."""
        self.newest = -math.inf
        """Monotonic s of the newest sample; -inf when there has been none."""
        self._rows = np.full((2 * self.capacity, channels), np.nan, np.float32)
        self._end = 0
        self._view = self._rows.view()
        self._view.flags.writeable = False

    @property
    def oldest_index(self) -> int:
        """Index of the oldest sample that is still held."""
        return max(0, self.next_index - self.capacity)

    def append(self, block: EmgBlock) -> int:
        """Add a block and return how many samples are missing before it.

        Raises:
            ValueError: the block does not follow what is held, or has another number of channels.
        """
        gap = block.first_index - self.next_index
        if gap < 0:
            raise ValueError(f"sample {block.first_index} came after sample {self.next_index - 1}")
        count, channels = block.samples.shape
        if channels != self._rows.shape[1]:
            raise ValueError(f"a block of {channels} channels came from {self._rows.shape[1]} channels")
        if gap:
            self._put(np.full((min(gap, self.capacity), channels), np.nan, np.float32))
        self._put(block.samples[-self.capacity :])
        self.next_index = block.first_index + count
        self.newest = block.time + (count - 1) / self.rate_hz
        return gap

    def _put(self, samples: Samples) -> None:
        """Store at most one capacity of `samples` after those that are held."""
        if self._end + len(samples) > len(self._rows):
            self._rows[: self.capacity] = self._rows[self._end - self.capacity : self._end]
            self._end = self.capacity
        self._rows[self._end : self._end + len(samples)] = samples
        self._end += len(samples)

    def since(self, index: int) -> Samples:
        """Samples from `index` on (V, shape (n, channels), NaN where missing), in order of index.

        What is older than one capacity is left out: the answer then begins at `oldest_index`. The array
        cannot be written to and is a look into the ring: use or copy it before the next await.
        """
        first = min(max(index, self.oldest_index), self.next_index)
        return self._view[self._end - (self.next_index - first) : self._end]

    def time_of(self, index: int) -> float:
        """Monotonic s at which sample `index` was taken, reckoned back from the newest at an even rate."""
        return self.newest - (self.next_index - 1 - index) / self.rate_hz
