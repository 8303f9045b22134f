"""Two sites that drive a group, one in each direction: what counts when both are contracted."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TypeAlias

from bentod.control.candidates import Candidates, Phase
from bentod.control.course import Heard, Moment, Side, let_go

Combine: TypeAlias = Callable[[float, float], float]
"""What two sites ask together, -1..1, from the newest effort of each, 0..1: the positive one first."""


def greatest(positive: float, negative: float) -> float:
    """The stronger one alone, at its own effort (brachIOplexus: differential). Equal ones ask for nothing."""
    if positive == negative:
        return 0.0
    return positive if positive > negative else -negative


class FirstOver:
    """Whichever was first above its threshold, until it ends (brachIOplexus: first to Smin).

    The other does nothing meanwhile. Of two that rise at the same sample the stronger one is first, and
    what is contracted at the start was nobody's first.
    """

    def __init__(self, lapse: int) -> None:
        """`lapse`: samples that both must have been quiet for before one of them is first."""
        self._lapse = lapse
        self.reset()

    def reset(self) -> None:
        """Nobody has it, until both have rested."""
        self._first = 0
        self._rested = False
        self._sides = Side(), Side()

    def follow(self, positive: Iterable[Moment], negative: Iterable[Moment]) -> None:
        """Find out who was first, sample by sample."""
        for pair in zip(positive, negative, strict=True):
            self._see(*pair)

    def _see(self, positive: Moment, negative: Moment) -> None:
        if not self._rested:
            for side, moment in zip(self._sides, (positive, negative), strict=True):
                side.see(moment)
            self._rested = let_go(*self._sides, self._lapse)
        if not (positive.effort if self._first > 0 else negative.effort):
            self._first = 0
        if self._rested and not self._first and (positive.effort or negative.effort):
            self._first = 1 if positive.effort >= negative.effort else -1

    def effort(self, positive: float, negative: float) -> float:
        """The effort of the first, with its sign."""
        return positive * (self._first > 0) - negative * (self._first < 0)


class TwoSites:
    """A pair of sites, its rule, and what looks for toggles among its contractions."""

    def __init__(
        self,
        sites: tuple[str, str],
        rule: Combine | FirstOver,
        candidates: Sequence[tuple[str, Candidates]] = (),
    ) -> None:
        """`sites`: the positive one first; `candidates`: each with the site that it watches first."""
        self._sites = sites
        self._first = rule if isinstance(rule, FirstOver) else None
        self._combine = rule.effort if isinstance(rule, FirstOver) else rule
        self._candidates = tuple(candidates)

    def step(self, heard: Heard) -> list[int]:
        """The toggles in a stretch."""
        if self._first:
            self._first.follow(*map(heard.course, self._sites))
        toggles = []
        for first, candidates in self._candidates:
            second = next(name for name in self._sites if name != first)
            toggles += candidates.step(heard.course(first), heard.course(second))
        return toggles

    def effort(self, efforts: Mapping[str, float]) -> float:
        """What the pair asks, -1..1: nothing while a contraction may be a toggle, or was one."""
        if any(found.phase is not Phase.NONE for _, found in self._candidates):
            return 0.0
        positive, negative = (efforts[name] for name in self._sites)
        return self._combine(positive, negative)

    def tense(self, efforts: Mapping[str, float]) -> bool:
        """Whether a muscle is contracted, be it that it asks for nothing."""
        return any(efforts[name] for name in self._sites) or any(one.open for _, one in self._candidates)

    def reset(self) -> None:
        """Forget everything."""
        if self._first:
            self._first.reset()
        for _, candidates in self._candidates:
            candidates.reset()
