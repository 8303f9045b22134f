"""Proportional EMG control (thesis A.1.2, 5.5): samples in, efforts out, no clock but the sample index."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bentod.errors import ConfigError
from bentod.frames import Samples

WINDOW = 10
"""Samples in a window (thesis 5.5), 50 ms at 200 Hz."""


@dataclass(frozen=True, slots=True)
class Site:
    """One electrode site and how its signal becomes an effort (thesis A.1.2).

    Raises:
        ConfigError: a value is out of bounds, or `maximum` is not above `threshold`.
    """

    name: str
    channel: int
    gain: float  # above 0
    threshold: float  # V after gain, effort 0 at and below
    maximum: float  # V after gain, effort 1 at and above

    def __post_init__(self) -> None:
        if self.channel < 0:
            raise ConfigError(
                f"Site {self.name!r}: the channel is {self.channel}; it must be 0 or more.", "channel"
            )
        if not 0 < self.gain < math.inf:
            raise ConfigError(f"Site {self.name!r}: the gain is {self.gain:g}; it must be above 0.", "gain")
        if not 0 <= self.threshold < self.maximum < math.inf:
            raise ConfigError(
                f"Site {self.name!r}: the maximum of {self.maximum:g} V must be above the threshold of "
                f"{self.threshold:g} V, and that at least 0 V.",
                "maximum",
            )

    def effort(self, mav: float) -> float:
        """Effort, 0..1, at a mean absolute value of `mav` (V before gain); 0 when that is not a number."""
        share = (mav * self.gain - self.threshold) / (self.maximum - self.threshold)
        return min(max(share, 0.0), 1.0) if not math.isnan(share) else 0.0


def difference(positive: float, negative: float) -> float:
    """What a pair of sites asks of a group, -1..1, from the effort of each, 0..1 (thesis 5.5)."""
    return positive - negative


class Envelope:
    """Mean absolute value over the newest `window` samples, at every sample.

    Sums are formed sample by sample in the order of the index, so the result is the same to the last bit
    however the samples are cut into steps. Samples that are not finite count as missing: the mean is
    that of the others while they are at least half of the window, and NaN otherwise. Before the first
    sample, and after a reset, everything is missing.
    """

    def __init__(self, window: int = WINDOW) -> None:
        self._window = window
        self._carried: NDArray[np.float64] | None = None

    def step(self, samples: Samples) -> NDArray[np.float64]:
        """Mean absolute value (V) at each of `samples` (V, shape (n, channels)), in the same shape."""
        if self._carried is None:
            self._carried = np.full((self._window - 1, samples.shape[1]), np.nan)
        joined = np.concatenate((self._carried, np.abs(samples.astype(np.float64))))
        count = len(samples)
        self._carried = joined[count:]
        known = np.isfinite(joined)
        terms = np.stack((np.where(known, joined, 0.0), known))
        sums = np.zeros((2, *samples.shape))
        for start in range(self._window):
            sums += terms[:, start : start + count]
        total, present = sums
        enough = 2 * present >= self._window
        mean = np.full(samples.shape, np.nan)
        np.divide(total, present, out=mean, where=enough)
        return mean

    def reset(self) -> None:
        """Forget every sample, as at the start."""
        self._carried = None


class Proportional:
    """Efforts of several sites. `sites` may be replaced between two steps; the samples are kept."""

    def __init__(self, sites: Sequence[Site], window: int = WINDOW) -> None:
        self.sites = tuple(sites)
        self._envelope = Envelope(window)
        self._newest: NDArray[np.float64] | None = None

    def step(self, samples: Samples) -> dict[str, float]:
        """Effort by site, 0..1, at the newest sample.

        `samples`: all that came since the last step (V, shape (n, channels), every channel of a site
        among them), n may be 0: then the efforts stand, unless a site was replaced.
        """
        levels = self._envelope.step(samples)
        if len(levels):
            self._newest = levels[-1]
        if self._newest is None:
            return {site.name: 0.0 for site in self.sites}
        return {site.name: site.effort(float(self._newest[site.channel])) for site in self.sites}

    def reset(self) -> None:
        """Forget every sample, so that effort starts from 0."""
        self._envelope.reset()
        self._newest = None
