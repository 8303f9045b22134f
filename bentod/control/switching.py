"""Switching by a toggle site (thesis A.1.2): one toggle a contraction, wherever the tick falls."""

import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass

from bentod.control.proportional import Levels
from bentod.errors import ConfigError

RELEASE = 0.7
"""Share of the threshold below which a muscle counts as quiet: over 50 ms, the mean of a steady contraction
scatters by a quarter."""

QUIET_S = 0.3
"""s for which a toggle site must be quiet before its next contraction begins."""

ENDED_S = 0.1
"""s for which it must be quiet before its contraction is known to have been a short one."""

FORWARD, BACKWARD = 1, -1
"""Toggles, as steps along the list of joints."""


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
    release: float = RELEASE  # a contraction ends when the signal is below this share of the threshold ...
    quiet: int = 60  # ... for so many samples in a row, 0.3 s at 200 Hz; only then may the next begin
    step: int = FORWARD  # what a contraction toggles, a short one if there are long ones
    long: int = 0  # samples from which on a contraction is long and toggles the other way; 0: none is
    ended: int = 20  # samples in a row below the release after which a contraction was a short one

    def __post_init__(self) -> None:
        bounds = {
            "channel": (self.channel, 0, 255),
            "gain": (self.gain, sys.float_info.min, sys.float_info.max),
            "threshold": (self.threshold, 0.0, sys.float_info.max),
            "release": (self.release, 0.0, 1.0),
            "quiet": (self.quiet, 1, 100_000),
            "long": (self.long, 0, 100_000),
            "ended": (self.ended, 1, 100_000),
        }
        for key, (value, low, high) in bounds.items():
            if not low <= value <= high:
                raise ConfigError(
                    f"Toggle site {self.name!r}: {key} is {value:g}; it must be from {low:g} to {high:g}.",
                    key,
                )


class _Latch:
    """Whether the next rise above the threshold counts, and for what."""

    def __init__(self) -> None:
        self._quiet = 0
        self._armed = False
        self.lasts = -1
        """Samples since a rise of which nobody knows yet whether it is long; -1 without one."""

    def step(self, site: ToggleSite, levels: Levels) -> list[int]:
        """Toggles in `levels` (V before gain, one a sample; NaN changes nothing but what is undecided)."""
        toggles: list[int] = []
        for level in (levels * site.gain).tolist():
            self._count(site, level)
            if level > site.threshold and self._armed:
                self._armed = False
                self.lasts = 0
            if self.lasts >= 0:
                toggles += self._judge(site, level)
        return toggles

    def _count(self, site: ToggleSite, level: float) -> None:
        if level < site.release * site.threshold:
            self._quiet += 1
            self._armed = self._armed or self._quiet >= site.quiet
        elif not math.isnan(level):
            self._quiet = 0

    def _judge(self, site: ToggleSite, level: float) -> list[int]:
        """What the contraction under way toggles, as soon as that is known."""
        self.lasts += 1
        short = not site.long or self._quiet >= site.ended
        if not (short or self.lasts >= site.long or math.isnan(level)):
            return []
        self.lasts = -1
        if math.isnan(level):
            return []
        return [site.step if short else -site.step]


class Toggling:
    """Toggles of several sites. `sites` may be replaced between two steps.

    A site counts once per contraction: when its mean absolute value rises above the threshold. The
    contraction lasts until the signal has been low for `quiet` samples in a row, since over 50 ms the
    mean of a steady contraction scatters by a quarter and dips below any release level sooner or later.
    At the start and after a reset a site must first be seen quiet: the contraction may be an old one.
    A site that tells short contractions from long ones counts when it knows; one in which samples are
    missing until then counts for nothing.
    """

    def __init__(self, sites: Sequence[ToggleSite]) -> None:
        self.sites = tuple(sites)
        self._latches: dict[str, _Latch] = {}

    def step(self, levels: Levels) -> dict[str, list[int]]:
        """Toggles by site, in all `levels` since the last step (V, shape (n, channels))."""
        return {site.name: self._latch(site).step(site, levels[:, site.channel]) for site in self.sites}

    @property
    def undecided(self) -> bool:
        """Whether a contraction is under way that will toggle one way or the other."""
        return any(latch.lasts >= 0 for latch in self._latches.values())

    def _latch(self, site: ToggleSite) -> _Latch:
        return self._latches.setdefault(site.name, _Latch())

    def reset(self) -> None:
        """Forget everything; each site must be seen quiet before its next toggle."""
        self._latches.clear()
