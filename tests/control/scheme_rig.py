"""A scheme of the config on generated muscles: samples in, what it asks and its toggles out."""

from collections.abc import Iterable, Sequence

import numpy as np

from bentod.config_sites import Pair, SingleSite
from bentod.control.course import Heard
from bentod.control.proportional import Envelope, Proportional, Site
from bentod.control.schemes import schemes_of
from bentod.frames import Samples

RATE_HZ = 200.0
SITES = (Site("flexor", 0, 1.0, 10e-6, 50e-6), Site("extensor", 1, 1.0, 10e-6, 50e-6))
THIRD = Site("third", 2, 1.0, 10e-6, 50e-6)
REST = (0.5, 0.0, 0.0)


class Played:
    """One scheme, its sites, and their envelope of 50 ms."""

    def __init__(
        self, table: Pair | SingleSite, rate_hz: float = RATE_HZ, sites: Sequence[Site] = (*SITES, THIRD)
    ) -> None:
        pairs, singles = ([table], []) if isinstance(table, Pair) else ([], [table])
        (self.scheme,) = schemes_of(pairs, singles, rate_hz)
        self._envelope = Envelope(round(0.05 * rate_hz))
        self._proportional = Proportional(sites)

    def step(self, samples: Samples) -> list[int]:
        """Toggles in `samples`."""
        levels = self._envelope.step(samples)
        sites = {site.name: site for site in self._proportional.sites}
        return self.scheme.step(Heard(sites, levels, self._proportional.step(levels)))

    @property
    def wish(self) -> float:
        return self.scheme.effort(self._proportional.newest())

    @property
    def tense(self) -> bool:
        return self.scheme.tense(self._proportional.newest())

    def course(self, samples: Samples) -> tuple[list[tuple[int, int]], list[float]]:
        """Every toggle with the sample at which it came, and what was asked at each sample."""
        toggles, wishes = [], []
        for index in range(len(samples)):
            toggles += [(index, step) for step in self.step(samples[index : index + 1])]
            wishes.append(self.wish)
        return toggles, wishes


def muscles(*stretches: tuple[float, ...], seed: int | None = None, rate_hz: float = RATE_HZ) -> Samples:
    """Stretches of (s, share of the maximum of each muscle ...) on three channels; even without a seed."""
    rows = [
        np.tile([*shares, 0.0, 0.0, 0.0][:3], (round(seconds * rate_hz), 1)) for seconds, *shares in stretches
    ]
    loud = np.concatenate(rows) * 50e-6 + 1e-6
    if seed is None:
        return np.asarray(loud * np.where(np.arange(len(loud)) % 2, 1.0, -1.0)[:, np.newaxis], np.float32)
    noise = np.random.default_rng(seed).normal(0.0, np.sqrt(np.pi / 2), loud.shape)
    return np.asarray(loud * noise, np.float32)


def lost(seconds: float) -> Samples:
    """Samples that never came."""
    return np.full((round(seconds * RATE_HZ), 3), np.nan, np.float32)


def same_however_cut(table: Pair | SingleSite, samples: Samples, cuts: Iterable[int]) -> None:
    """Assert that pieces give the toggles, and at their ends the wishes, of single samples."""
    toggles, wishes = Played(table).course(samples)
    cutting, found, index = Played(table), [], 0
    for piece in np.split(samples, sorted(place % len(samples) for place in cuts)):
        found += cutting.step(piece)
        index += len(piece)
        assert not index or cutting.wish == wishes[index - 1]
        before = [step for at, step in toggles if at < index]
        assert found == before
