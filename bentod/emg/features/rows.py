"""What features of one window share, each computed once, as a list of operations prepared for a shape.

One window is so little work that calls of NumPy cost more than the numbers. So buffers, and looks at them,
are made once for a shape, and what is left to do for a window is a list of calls with all arguments bound.

Every sum is taken along the samples of one row, which are contiguous; so it is the same sum, to the bit,
whatever other rows are there.
"""

from collections.abc import Callable
from functools import partial
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from bentod.emg.features.marks import Marks
from bentod.emg.recognition import Windows

Floats: TypeAlias = NDArray[np.float64]

LIMIT_V = 1e100
"""V; the sum of magnitudes stays below it, or squares would not be finite."""


class Rows:
    """Segments of windows: all arrays have shape (windows, channels, segments), and some the samples last."""

    def __init__(self, windows: int, channels: int, segments: int, length: int) -> None:
        """`length`: samples of a segment."""
        self.shape = windows, channels, segments
        self.length = length
        self.padded = self.zeros()
        """V, with zeros after the samples."""
        self.x = self.padded[..., :length]
        """V."""
        self.steps: list[Callable[[], object]] = []
        self.marks = Marks(self.padded.shape, length)
        self._made: dict[str, Floats] = {}

    def zeros(self) -> Floats:
        """A buffer like `padded`: whole bytes of bits, with a sample of padding at least to stop carries."""
        return np.zeros((*self.shape, (self.length // 8 + 1) * 8))

    def do(self, operation: Callable[..., object], *arguments: object) -> None:
        """Have it done for every window, after what has been asked for before."""
        # NumPy takes a number faster as an array.
        bound = (np.array(each) if isinstance(each, float) else each for each in arguments)
        self.steps.append(partial(operation, *bound))

    def load(self, windows: Windows) -> None:
        """Take other windows."""
        np.copyto(self.x, windows.reshape(self.x.shape))

    def run(self) -> None:
        """Do it all."""
        for step in self.steps:
            step()

    def once(self, name: str, make: Callable[[], Floats]) -> Floats:
        """What `make` makes, for all that ask for it by this name."""
        if name not in self._made:
            self._made[name] = make()
        return self._made[name]

    def sums(self, values: Floats, others: Floats | None = None) -> Floats:
        """Σ of `values` times `others` (ones), along the samples."""
        found = np.empty(self.shape)
        self.do(np.vecdot, values, np.ones(values.shape[-1]) if others is None else others, found)
        return found

    def magnitude(self) -> Floats:
        """|x|, padded."""
        return self.once("magnitude", lambda: self._abs(self.padded))

    def change(self) -> Floats:
        """x_{i+1} − x_i at i, padded."""
        return self.once("change", self._change)

    def steepness(self) -> Floats:
        """|x_{i+1} − x_i| at i, padded."""
        return self.once("steepness", lambda: self._abs(self.change()))

    def total(self) -> Floats:
        """Σ |x|."""
        return self.once("total", lambda: self.sums(self.magnitude()))

    def mav(self) -> Floats:
        """Mean of |x|."""
        return self.once("mav", self._mav)

    def power(self) -> Floats:
        """Σ x²."""
        return self.once("power", lambda: self.sums(self.padded, self.padded))

    def _abs(self, values: Floats) -> Floats:
        found = self.zeros()
        self.do(np.abs, values, found)
        return found

    def _change(self) -> Floats:
        found = self.zeros()
        flat, change = self.padded.reshape(-1), found.reshape(-1)
        # All rows as one are faster than row by row. From the last sample to the padding is no change.
        self.do(np.subtract, flat[1:], flat[:-1], change[:-1])
        self.do(found[..., self.length - 1 :].fill, 0.0)
        return found

    def _mav(self) -> Floats:
        found = np.empty(self.shape)
        self.do(np.multiply, self.total(), 1 / self.length, found)
        return found
