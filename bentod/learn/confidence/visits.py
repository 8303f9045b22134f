"""How often, and how long ago, the arm was in a state like the current one, counted in features.

The two curves of thesis Fig. 5.12 are the sum and the least of the counts of the active features. A count
that grows whatever happens says nothing about the state (thesis 6.1.1: the bias, features that never
change), so such features can be left out by index; and in `familiarity` each counts as much as it
discriminates.
"""

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bentod.contracts import Features
from bentod.learn.confidence.columns import check


@dataclass(frozen=True, slots=True)
class Visit:
    """What was known of a state when it was entered, this visit not counted."""

    total: int  # ticks: sum of the counts of its features, "Feature Counts" of Fig. 5.12
    mean: float  # ticks: the same for one feature, whatever collisions cost
    least: int  # ticks: the rarest of its features was active so often, "Min Counts" of Fig. 5.12
    familiarity: float  # 0..1
    since: float  # ticks: the state was certainly not visited since then; infinite: never


class Visits:
    """Counts the ticks at which each of `size` binary features was active. `apart`: features to be left out.

    Familiarity is a mean of N/(N + `half`) over the active features, N being their counts, weighted by 1 −
    N/(T + 1) after T ticks: by the share of time at which a feature was *not* active. A bias that nobody
    left out then weighs next to nothing. A feature is half familiar after `half` ticks, 1 s at 30 Hz.

    A state was visited no later than the feature of it that was not active for longest: that is `since`.
    """

    def __init__(self, size: int, apart: Collection[int] = (), half: float = 30.0) -> None:
        if not half > 0 or not all(0 <= feature < size for feature in apart):
            raise ValueError(
                f"Visits need `half` above 0, and features to leave out within 0..{size - 1}, "
                f"not {half} and {sorted(apart)}."
            )
        self._half = half
        self._within = np.ones(size, dtype=np.bool_)
        self._within[list(apart)] = False
        # Whole numbers, exact in float64 for longer than any arm will last.
        self._counts = np.zeros(size)
        self._last = np.full(size, -math.inf)
        self._ticks = 0.0

    @property
    def counts(self) -> NDArray[np.float64]:
        """Ticks at which each feature was active, shape (size,)."""
        return self._counts.copy()

    def step(self, features: Features, ticks: int = 1) -> Visit:
        """Tell what is known of the state with these features, then count it.

        `ticks`: since the step before. What was active in between is not known, and not counted.
        """
        self._ticks += ticks
        told = features[self._within[features]]
        visit = self._visit(told) if len(told) else Visit(0, 0.0, 0, 0.0, math.inf)
        self._counts[features] += 1
        self._last[features] = self._ticks
        return visit

    def memory(self) -> dict[str, NDArray[np.float64]]:
        """Copies of all that has been counted, by name."""
        return {
            "counts": self._counts.copy(),
            "last": self._last.copy(),
            "ticks": np.array([self._ticks]),
        }

    def recall(self, memory: Mapping[str, NDArray[np.float64]]) -> None:
        """Become what `memory` told. Raises ValueError: it is not that of as many features."""
        check(memory, {"counts": self._counts.shape, "last": self._last.shape, "ticks": (1,)})
        counts, ticks = memory["counts"], memory["ticks"]
        if not (counts.min(initial=0) >= 0 and counts.max(initial=0) <= ticks[0] < math.inf):
            raise ValueError("Visits are 0 or more, and no more than there were ticks.")
        self._counts = memory["counts"].copy()
        self._last = memory["last"].copy()
        self._ticks = float(memory["ticks"][0])

    def _visit(self, told: Features) -> Visit:
        counts = self._counts[told]
        total = float(counts.sum())
        discriminates = 1 - counts / (self._ticks + 1)
        known = float((discriminates * (counts / (counts + self._half))).sum())
        return Visit(
            total=int(total),
            mean=total / len(told),
            least=int(counts.min()),
            familiarity=known / float(discriminates.sum()),
            since=self._ticks - float(self._last[told].min()),
        )
