"""What a TD error is measured by: the range of the signal, as given or as far as it has been seen."""

import numpy as np
from numpy.typing import NDArray

from bentod.learn.confidence.columns import Column, Columns, extended


class Spans(Columns):
    """Ranges of the cumulants of some GVFs, `ranges`, shape (m,); NaN: the span that was seen so far."""

    def __init__(
        self,
        ranges: NDArray[np.float64],
        own: dict[str, Column],
        shared: dict[str, NDArray[np.float64]],
    ) -> None:
        super().__init__(len(ranges), {"low": ((), np.inf), "high": ((), -np.inf)} | own, shared)
        self._ranges = np.array(ranges, dtype=np.float64)

    def take(self, columns: NDArray[np.intp]) -> None:
        """Go on with these GVFs only, in this order."""
        super().take(columns)
        self._ranges = self._ranges[columns].copy()

    def grow(self, count: int, ranges: NDArray[np.float64] | float = np.nan) -> None:
        """Take on `count` more GVFs with these ranges, behind the others."""
        super().grow(count)
        self._ranges = extended(self._ranges, count, np.nan)
        self._ranges[self.count - count :] = ranges

    def widen(self, cumulants: NDArray[np.float64]) -> None:
        """See these values, shape (m,). One that is not finite was not observed."""
        seen = np.isfinite(cumulants)
        low, high = self._own["low"], self._own["high"]
        np.minimum(low, np.where(seen, cumulants, low), out=low)
        np.maximum(high, np.where(seen, cumulants, high), out=high)

    def share(self, delta: NDArray[np.float64]) -> NDArray[np.float64]:
        """|δ|/Range, 1 at most, shape (m,); NaN where there is no δ, or the signal has never moved."""
        span = np.where(np.isnan(self._ranges), self._own["high"] - self._own["low"], self._ranges)
        share: NDArray[np.float64] = np.minimum(np.abs(delta) / np.where(span > 0, span, np.nan), 1)
        return share
