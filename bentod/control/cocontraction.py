"""Toggles by co-contraction: both muscles of a pair squeezed at once, which moves nothing."""

from dataclasses import dataclass

from bentod.control.candidates import Candidates, Pacing, Phase
from bentod.control.course import Moment


@dataclass(frozen=True, slots=True)
class Squeeze:
    """What makes a co-contraction a deliberate one; times in samples."""

    pacing: Pacing
    together: int  # from the rise of one site to that of the other, at most
    dwell: int  # how long both stay, at least
    balance: float  # share of its maximum of the weaker site, over that of the stronger one, at least


class CoContractions(Candidates):
    """Both sites rise from rest, one soon after the other, and stay: one toggle, however long they stay.

    That both are above their thresholds says little: antagonists overlap whenever a movement turns round, and
    accompany each other weakly. The first do not rise together from rest, the second are out of balance.
    """

    def __init__(self, squeeze: Squeeze) -> None:
        self._squeeze = squeeze
        super().__init__(squeeze.pacing)

    def reset(self) -> None:
        """As of every candidate."""
        super().reset()
        self._stays = 0
        """Samples since both have risen."""
        self._loud = (0.0, 0.0)
        """Shares of the two, added up over these."""

    def _begins(self) -> bool:
        return self._one.on or self._other.on

    def _rises(self, one: Moment, other: Moment) -> None:
        if self._one.on and self._other.on:
            self.phase, self._stays, self._loud = Phase.RISEN, 0, (0.0, 0.0)
        elif not (self._one.on or self._other.on):
            self.phase = Phase.NONE
        elif self._lasts > self._squeeze.together:
            self._give_up()

    def _ends(self, one: Moment, other: Moment) -> bool:
        self._stays += 1
        self._loud = (self._loud[0] + one.share, self._loud[1] + other.share)
        quiet = max(self._one.quiet, self._other.quiet)
        if quiet >= self._squeeze.pacing.lapse:
            self._spend()
        if quiet or self._stays < self._squeeze.dwell:
            return False
        weaker, stronger = sorted(self._loud)
        if weaker < self._squeeze.balance * stronger:
            self._give_up()
            return False
        self._spend()
        return True
