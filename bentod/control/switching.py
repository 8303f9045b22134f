"""Switching by a toggle site (thesis A.1.2): one toggle a contraction, wherever the tick falls."""

import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bentod.control.proportional import WINDOW, Envelope
from bentod.errors import ConfigError
from bentod.frames import Samples


@dataclass(frozen=True, slots=True)
class ToggleSite:
    """One electrode site whose contraction is a toggle. It has no maximum (thesis A.1.2).

    Raises:
        ConfigError: a value is out of bounds.
    """

    name: str
    channel: int
    gain: float  # above 0
    threshold: float  # V after gain, a toggle above; at 0 the site is never quiet and never toggles
    release: float = 0.7  # a contraction ends when the signal is below this share of the threshold ...
    quiet: int = 60  # ... for so many samples in a row, 0.3 s at 200 Hz; only then may the next begin

    def __post_init__(self) -> None:
        bounds = {
            "channel": (self.channel, 0, 255),
            "gain": (self.gain, sys.float_info.min, sys.float_info.max),
            "threshold": (self.threshold, 0.0, sys.float_info.max),
            "release": (self.release, 0.0, 1.0),
            "quiet": (self.quiet, 1, 100_000),
        }
        for key, (value, low, high) in bounds.items():
            if not low <= value <= high:
                raise ConfigError(
                    f"Toggle site {self.name!r}: {key} is {value:g}; it must be from {low:g} to {high:g}.",
                    key,
                )


class _Latch:
    """Whether the next rise above the threshold counts."""

    def __init__(self) -> None:
        self._quiet = 0
        self._armed = False

    def step(self, site: ToggleSite, levels: NDArray[np.float64]) -> int:
        """Toggles in `levels` (V before gain, one a sample; NaN changes nothing)."""
        toggles = 0
        for level in levels * site.gain:
            if level < site.release * site.threshold:
                self._quiet += 1
                self._armed = self._armed or self._quiet >= site.quiet
            elif not math.isnan(level):
                self._quiet = 0
            if level > site.threshold and self._armed:
                self._armed = False
                toggles += 1
        return toggles


class Toggling:
    """Toggles of several sites. `sites` may be replaced between two steps.

    A site counts once per contraction: when its mean absolute value rises above the threshold. The
    contraction lasts until the signal has been low for `quiet` samples in a row, since over 50 ms the
    mean of a steady contraction scatters by a quarter and dips below any release level sooner or later.
    At the start and after a reset a site must first be seen quiet: the contraction may be an old one.
    """

    def __init__(self, sites: Sequence[ToggleSite], window: int = WINDOW) -> None:
        self.sites = tuple(sites)
        self._envelope = Envelope(window)
        self._latches: dict[str, _Latch] = {}

    def step(self, samples: Samples) -> dict[str, int]:
        """Toggles by site in `samples`: all that came since the last step (V, shape (n, channels))."""
        levels = self._envelope.step(samples)
        return {site.name: self._latch(site).step(site, levels[:, site.channel]) for site in self.sites}

    def _latch(self, site: ToggleSite) -> _Latch:
        return self._latches.setdefault(site.name, _Latch())

    def reset(self) -> None:
        """Forget every sample; each site must be seen quiet before its next toggle."""
        self._envelope.reset()
        self._latches.clear()
