"""Garbage is collected while nobody waits: in the slack of a tick, not whenever Python thinks of it."""

import gc
from types import TracebackType
from typing import Self, TypeAlias

from bentod.contracts import Clock

_Thresholds: TypeAlias = tuple[int, int, int]

DUE = (700, 10, 30)
"""From when on a generation is collected if there is time: objects since the last collection of the young
one, collections of the generation below it for the others. Python's own numbers, but for the oldest."""

OVERDUE = (7_000, 100, 300)
"""From when on it is collected, time or not: memory has a bound, and what piles up only takes longer."""

STUCK: _Thresholds = (70_000, 10, 10)
"""From when on Python collects a generation by itself, in whatever it does: more than piles up between two
ticks, but ticks may cease, in a bus that never answers, while clients go on making garbage."""

MARGIN = 2.0
"""A collection is begun if this many times of what it is expected to take is left."""

DISTRUST = 2.0
"""What a collection is expected to take grows by this factor at most each time: most that takes long does so
because the machine did something else meanwhile."""


class Collector:
    """Leaves garbage to Python."""

    def collect(self, deadline: float) -> None:
        """A tick is done, and nothing is to be done before `deadline` (monotonic s)."""

    def __enter__(self) -> Self:
        """Everything that lasts has been built."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """The last tick is done."""


class SlackCollector(Collector):
    """While entered, garbage is collected in the slack of ticks only, and what was there before not at all.

    The young generation is looked through often, the oldest rarely, and only when what is left of the
    period is enough. A tick without slack collects nothing, until so much has piled up that it must.
    Without ticks Python collects by itself, late (`STUCK`).
    """

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._below = [0, 0, 0]  # collections of the generation below since the last of this one
        self._expected = [0.0] * len(DUE)  # s, of the young one s per object; 0 until it has been measured
        self._automatic, self._thresholds = True, gc.get_threshold()

    def collect(self, deadline: float) -> None:
        """Collect the oldest generation that is due and fits, or that must be collected."""
        waiting = (gc.get_count()[0], *self._below[1:])
        began = self._clock.now()
        for generation in (2, 1, 0):
            amount = waiting[0] if generation == 0 else 1
            fits = began + MARGIN * self._expected[generation] * amount <= deadline
            if waiting[generation] >= (DUE if fits else OVERDUE)[generation]:
                gc.collect(generation)
                self._collected(generation, (self._clock.now() - began) / max(amount, 1))
                return

    def __enter__(self) -> Self:
        self._automatic, self._thresholds = gc.isenabled(), gc.get_threshold()
        gc.collect()
        gc.freeze()
        gc.set_threshold(*STUCK)
        gc.enable()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        gc.unfreeze()
        gc.set_threshold(*self._thresholds)
        if not self._automatic:
            gc.disable()

    def _collected(self, generation: int, took: float) -> None:
        before = self._expected[generation]
        self._expected[generation] = min(took, DISTRUST * before) if before else took
        self._below[: generation + 1] = [0] * (generation + 1)
        if generation + 1 < len(self._below):
            self._below[generation + 1] += 1
