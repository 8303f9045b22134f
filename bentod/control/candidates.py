"""Contractions of a pair of sites that may be meant as a toggle: found, followed, and then one or none."""

import math
from abc import ABC, abstractmethod
from collections.abc import Iterable
from dataclasses import dataclass
from enum import Enum

from bentod.control.course import Moment, Side, let_go


class Phase(Enum):
    """Where a candidate stands."""

    NONE = "none"
    RISING = "rising"
    RISEN = "risen"
    SPENT = "spent"
    """It is over, the muscles are not: they ask for nothing until both have been quiet."""


@dataclass(frozen=True, slots=True)
class Pacing:
    """Times that all kinds of candidates have, in samples."""

    step: int  # of the toggle, forward or backward
    rest: int  # both sites quiet before one can begin
    lapse: int  # quiet in a row that ends a contraction; a shorter dip is scatter
    refractory: int  # from one toggle to the next


class Candidates(ABC):
    """Watches two sites, sample by sample.

    A candidate begins at a rise from rest: both sites quiet for `rest` samples. So a pair that moves the arm
    has none, and after a toggle both must have been released. Where samples are missing it is spent, and
    so is everything at the start and after a reset: it may have begun when nobody looked. A site that nobody
    hears, because its lead is off, has no candidates, and does not keep the other one from moving the arm.
    """

    def __init__(self, pacing: Pacing) -> None:
        self._pacing = pacing
        self.reset()

    def reset(self) -> None:
        """Forget everything; both sites must be seen quiet before they ask for anything."""
        self.phase = Phase.SPENT
        self._one, self._other = Side(), Side()
        self._armed = False
        self._lasts = 0
        """Samples since the candidate rose."""
        self._since = self._pacing.refractory
        """Samples since the newest toggle."""

    @property
    def open(self) -> bool:
        """Whether a contraction is under way of which nobody knows yet what it is."""
        return self.phase in (Phase.RISING, Phase.RISEN)

    def step(self, one: Iterable[Moment], other: Iterable[Moment]) -> list[int]:
        """The toggles in a stretch."""
        return [
            self._pacing.step for pair in zip(one, other, strict=True) if self._see(*pair) and self._again()
        ]

    def _again(self) -> bool:
        """Whether the newest toggle is long enough ago for one more, which is then the newest."""
        again = self._since >= self._pacing.refractory
        if again:
            self._since = 0
        return again

    def _see(self, one: Moment, other: Moment) -> bool:
        """Take in one sample of each. Returns whether they make a candidate a toggle."""
        self._since += 1
        self._lasts += 1
        self._one.see(one)
        self._other.see(other)
        self._wait()
        if math.isnan(one.share + other.share):
            if self._armed or self.open:
                self._spend()
            return False
        if not self._armed and self.phase is Phase.NONE:
            return False
        if self.phase is Phase.NONE and self._begins():
            self.phase, self._lasts = Phase.RISING, 0
        if self.phase is Phase.RISING:
            self._rises(one, other)
        return self.phase is Phase.RISEN and self._ends(one, other)

    def _wait(self) -> None:
        """See what a rest makes possible."""
        if self.phase is Phase.SPENT and let_go(self._one, self._other, self._pacing.lapse):
            self.phase = Phase.NONE
        if self.phase is Phase.NONE and min(self._one.quiet, self._other.quiet) >= self._pacing.rest:
            self._armed = True

    def _spend(self) -> None:
        """Nothing more comes of what is contracted now."""
        self.phase, self._armed = Phase.SPENT, False

    def _give_up(self) -> None:
        """It was no candidate: what is contracted may move the arm."""
        self.phase, self._armed = Phase.NONE, False

    @abstractmethod
    def _begins(self) -> bool:
        """Whether a candidate begins, the sites having been at rest."""

    @abstractmethod
    def _rises(self, one: Moment, other: Moment) -> None:
        """Follow one that is rising."""

    @abstractmethod
    def _ends(self, one: Moment, other: Moment) -> bool:
        """Follow one that has risen; whether it is a toggle now."""
