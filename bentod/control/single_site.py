"""One site that drives a group both ways, for who has no second one."""

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass

from bentod.control.course import Heard, Moment, Side


@dataclass(frozen=True, slots=True)
class OneWay:
    """How contractions of one site are told apart; times in samples."""

    weak: int  # where a weak contraction goes, 1 or -1
    strong: float  # effort from which on it is strong
    decide: int  # since its rise; by then it is known which
    rest: int  # quiet in a row before the next may begin


class SingleSite(ABC):
    """Each contraction goes one way. It lasts until the site has been quiet for `rest` samples.

    Where samples are missing, at the start and after a reset the site asks for nothing until it has rested.
    """

    def __init__(self, site: str, ways: OneWay) -> None:
        self._site = site
        self._ways = ways
        self._side = Side()
        self.reset()

    def reset(self) -> None:
        """Forget everything."""
        self._side = Side()
        self._rested = False
        self._way = 0
        self._lasts = 0

    def step(self, heard: Heard) -> list[int]:
        """Follow a stretch; such a site has no toggles of its own."""
        for moment in heard.course(self._site):
            self._see(moment)
        return []

    def _see(self, moment: Moment) -> None:
        self._side.see(moment)
        if math.isnan(moment.share):
            self._rested, self._way, self._lasts = False, 0, 0
        elif self._side.quiet >= self._ways.rest:
            self._rested, self._way, self._lasts = True, 0, 0
        elif self._rested and (self._side.on or self._lasts):
            self._lasts += 1
            self._way = self._decided(moment)

    @abstractmethod
    def _decided(self, moment: Moment) -> int:
        """Which way the contraction goes, 1 or -1; 0 while that is not known."""

    def effort(self, efforts: Mapping[str, float]) -> float:
        """What the site asks, -1..1."""
        return self._way * efforts[self._site]

    def tense(self, efforts: Mapping[str, float]) -> bool:
        """Whether it is contracted, be it that it asks for nothing."""
        return efforts[self._site] > 0 or (self._lasts > 0 and not self._way)


class TwoState(SingleSite):
    """A weak contraction goes one way, a strong one the other (brachIOplexus: single-site 2-state).

    It is strong if the mean effort in the second half of the time to decide is. Once decided, it may be
    as strong or as weak as it likes.
    """

    def reset(self) -> None:
        """Forget everything."""
        super().reset()
        self._sum = 0.0

    def _decided(self, moment: Moment) -> int:
        ways = self._ways
        if self._way or self._lasts > ways.decide:
            return self._way
        half = ways.decide - ways.decide // 2
        self._sum = 0.0 if self._lasts == 1 else self._sum
        self._sum += moment.effort if self._lasts > ways.decide - half else 0.0
        if self._lasts < ways.decide or not self._sum:
            return 0
        return -ways.weak if self._sum / half >= ways.strong else ways.weak


class Alternate(SingleSite):
    """Each contraction goes where the one before did not; the first after a reset goes the positive way.

    One that is over before the time to decide does not count: the next goes the same way.
    """

    def reset(self) -> None:
        """Forget everything."""
        super().reset()
        self._last = -1

    def _decided(self, moment: Moment) -> int:
        way = self._way or -self._last
        if self._lasts >= self._ways.decide and self._side.on:
            self._last = way
        return way
