"""Toggles by pulse: a short and strong contraction of one site, while the other stays at rest."""

from dataclasses import dataclass

from bentod.control.candidates import Candidates, Pacing, Phase
from bentod.control.course import Moment


@dataclass(frozen=True, slots=True)
class Beat:
    """What makes a contraction a pulse; times in samples."""

    pacing: Pacing
    strong: float  # effort that it reaches, at least
    rise: int  # how long that takes, at most
    least: int  # from its rise to its end, at least
    within: int  # and at most


class Pulses(Candidates):
    """The first of two sites rises from rest, is strong soon, and soon over; the second stays low.

    A contraction that is not strong by then, or not over, moves the arm from then on.
    """

    def __init__(self, beat: Beat) -> None:
        self._beat = beat
        super().__init__(beat.pacing)

    def _begins(self) -> bool:
        if self._other.on:
            self._give_up()
        return self._one.on and not self._other.on

    def _rises(self, one: Moment, other: Moment) -> None:
        if not self._one.on and not self._other.on:
            self.phase = Phase.NONE
        elif self._other.on or self._lasts > self._beat.rise:
            self._give_up()
        elif one.effort >= self._beat.strong:
            self.phase = Phase.RISEN

    def _ends(self, one: Moment, other: Moment) -> bool:
        if self._other.on or self._lasts > self._beat.within:
            self._give_up()
            return False
        if self._one.on:
            return False
        self._spend()
        return self._lasts >= self._beat.least
