"""Everything that happens to samples before sites are judged by them: filters, and leads that are off."""

from collections.abc import Sequence

import numpy as np

from bentod.config_conditioning import Filter, Leads
from bentod.emg.conditioning import Conditioning, Volts
from bentod.emg.contact import Contact, Turn, Wired
from bentod.frames import Samples

MEAN_FREE = frozenset({"high_pass", "band_pass"})
"""Filters after which an offset is gone."""


class Electrodes:
    """Conditioned samples by index, whatever is late or lost on the way."""

    def __init__(self, filters: Sequence[Filter], leads: Leads, rate_hz: float, channels: int) -> None:
        """Raises ConfigError: the source is too slow for a filter, or SciPy is missing."""
        self.mean_free = any(one.kind in MEAN_FREE for one in filters)
        """Whether an offset of the source is of no account."""
        self.conditioned: Volts = np.zeros((0, channels))
        """What the newest step made of its samples, before leads that are off are blanked out: the same as
        `Conditioning` makes of a recording of them."""
        self._conditioning = Conditioning(filters, rate_hz, channels)
        self._contact = Contact(leads, rate_hz)
        self._next = 0

    def watch(self, sites: Sequence[Wired]) -> None:
        """Judge the leads of these sites from now on."""
        self._contact.sites = tuple(sites)

    def step(self, samples: Samples, first: int) -> Volts:
        """Conditioned samples (V, shape (n, channels)), NaN where unknown and where a site's lead is off.

        `first`: index of the first of `samples`; what is missing before it counts as missing.
        """
        if first > self._next:
            self._conditioning.skip(first - self._next)
        self._next = first + len(samples)
        self.conditioned = self._conditioning.step(samples)
        return self._contact.step(samples, self.conditioned)

    @property
    def off(self) -> dict[str, str]:
        """Why, by site whose lead is off."""
        return dict(self._contact.off)

    @property
    def problem(self) -> str:
        """Why a site asks for nothing, as a sentence; empty when all leads are on."""
        return next((f"EMG site {name}: {reason}." for name, reason in self._contact.off.items()), "")

    def take_turns(self) -> list[Turn]:
        """Leads that came off or are on again since the last call."""
        return self._contact.take_turns()
