"""Proportional EMG control (thesis A.1.2, 5.5): samples in, efforts out, no clock but the sample index."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from bentod.errors import ConfigError
from bentod.frames import Samples

WINDOW = 10
"""Samples in a window (thesis 5.5), 50 ms at 200 Hz."""

Levels: TypeAlias = NDArray[np.float64]
"""How loud a signal is at each sample (V before gain), NaN where nobody knows."""


@dataclass(frozen=True, slots=True)
class Site:
    """One electrode site and how its signal becomes an effort (thesis A.1.2).

    Raises:
        ConfigError: a value is out of bounds, or `maximum` is not above `threshold`.
    """

    name: str
    channel: int
    gain: float  # above 0
    threshold: float  # V after gain, an effort begins above
    maximum: float  # V after gain, effort 1 at and above
    release: float = 1.0  # share of the threshold where effort is 0, and below which it ends

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
        if not 0 < self.release <= 1:
            raise ConfigError(
                f"Site {self.name!r}: the release is {self.release:g}; it must be above 0, up to 1.",
                "release",
            )

    @property
    def floor(self) -> float:
        """V after gain below which an effort ends."""
        return self.release * self.threshold


def difference(positive: float, negative: float) -> float:
    """What a pair of sites asks of a group, -1..1, from the effort of each, 0..1 (thesis 5.5)."""
    return positive - negative


class Loudness(Protocol):
    """How loud each channel is at each sample, computed sample by sample in the order of the index."""

    def step(self, samples: Samples | Levels) -> Levels:
        """V at each of `samples` (V, shape (n, channels)), in the same shape."""
        ...

    def reset(self) -> None:
        """Forget every sample, as at the start."""
        ...


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

    def step(self, samples: Samples | Levels) -> Levels:
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


class _Effort:
    """The effort of one site, which begins above the threshold and ends below the release (hysteresis)."""

    def __init__(self) -> None:
        self._on = False

    def step(self, site: Site, levels: Levels) -> Levels:
        """Effort, 0..1, at each of `levels` (V, shape (n,)); where that is not a number it is over."""
        volts = levels * site.gain
        turns = np.where(volts > site.threshold, 1, np.where(volts >= site.floor, 0, -1))
        newest = np.maximum.accumulate(np.where(turns, np.arange(1, len(turns) + 1), 0))
        on = np.where(newest, turns[newest - 1] > 0, self._on)
        if len(on):
            self._on = bool(on[-1])
        share = (volts - site.floor) / (site.maximum - site.floor)
        return np.where(on, np.clip(share, 0.0, 1.0), 0.0)


class Proportional:
    """Efforts of several sites. `sites` may be replaced between two steps; levels and efforts go on."""

    def __init__(self, sites: Sequence[Site]) -> None:
        self.sites = tuple(sites)
        self._efforts: dict[str, _Effort] = {}
        self._newest: Levels | None = None

    def step(self, levels: Levels) -> dict[str, Levels]:
        """Effort by site, 0..1, at each of `levels`: all since the last step (V, shape (n, channels))."""
        if len(levels):
            self._newest = levels[-1:]
        return {site.name: self._effort(site).step(site, levels[:, site.channel]) for site in self.sites}

    def newest(self) -> dict[str, float]:
        """Effort by site, 0..1, at the newest sample, by the sites as they are now; 0 before the first."""
        level = self._newest
        if level is None:
            return {site.name: 0.0 for site in self.sites}
        return {
            site.name: float(self._effort(site).step(site, level[:, site.channel])[0]) for site in self.sites
        }

    def loudness(self) -> dict[str, float]:
        """How loud each site is (V after gain) at the newest sample; NaN where nobody knows."""
        level = self._newest
        return {
            site.name: float(level[0, site.channel]) * site.gain if level is not None else math.nan
            for site in self.sites
        }

    def _effort(self, site: Site) -> _Effort:
        return self._efforts.setdefault(site.name, _Effort())

    def reset(self) -> None:
        """Forget every sample, so that effort starts from 0."""
        self._efforts.clear()
        self._newest = None
