"""Windows one by one into contractions, and which of them nobody took back."""

from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from bentod.config_adaptation import Adaptation
from bentod.emg.recognition import REST

Row = NDArray[np.float64]

EDGE = 3
"""Windows at either end of a contraction that show the way to it or from it, and as many that end it."""


@dataclass(slots=True)
class Contraction:
    """Windows that look like one class (rest is one, too), with a few others among them."""

    label: str
    windows: int = 0
    others: int = 0
    surety: float = 0.0  # sum of the probabilities of `label`
    counted: int = 0  # windows in `total`
    total: Row = field(default_factory=lambda: np.zeros(0))  # sum of the rows of the class, without the edges
    newest: deque[Row] = field(default_factory=deque)  # rows that may turn out to be its end

    @property
    def mean(self) -> Row:
        """Of its rows, shape (columns,)."""
        return self.total / self.counted

    @property
    def sure(self) -> float:
        """Mean probability of its label, 0..1."""
        return self.surety / max(self.windows, 1)

    def take(self, row: Row, likely: str, share: float) -> None:
        """One window more. `share`: the probability of this contraction's label."""
        self.windows += 1
        self.surety += share
        if likely != self.label:
            self.others += 1
        elif self.windows > EDGE:
            self.newest.append(row)
        if len(self.newest) > EDGE:
            oldest = self.newest.popleft()
            self.total = self.total + oldest if self.counted else oldest.copy()
            self.counted += 1


@dataclass(frozen=True, slots=True)
class Ended:
    """What became of a contraction."""

    contraction: Contraction
    why: str  # it is not to be learned from; empty if it is


class Contractions:
    """Knows windows and their number only, so that the same windows end in the same contractions."""

    def __init__(self, rules: Adaptation, step_s: float) -> None:
        """`step_s`: s from one window to the next."""
        self._rules = rules
        self._least = max(round(rules.least_s / step_s), 2 * EDGE + 1)
        self._patience = round(rules.confirm_s / step_s)
        self.forget()

    def forget(self) -> None:
        """Windows are missing: nobody knows how what was under way went on."""
        self._now = Contraction(REST)
        self._streak: list[tuple[Row, Sequence[float], str]] = []
        self._waiting: Contraction | None = None
        self._waited = 0

    def take(self, row: Row, shares: Sequence[float], labels: Sequence[str]) -> Iterator[Ended]:
        """One window, and what has been decided about contractions by now."""
        likely = labels[max(range(len(shares)), key=shares.__getitem__)]
        streak = [*self._streak, (row, shares, likely)] if likely != self._now.label else []
        self._streak = streak[-EDGE:]
        if len(streak) >= EDGE and all(one[2] == likely for one in self._streak):
            yield from self._turn(likely, labels)
        else:
            self._now.take(row, likely, shares[labels.index(self._now.label)])
        yield from self._wait()

    def _turn(self, label: str, labels: Sequence[str]) -> Iterator[Ended]:
        """Another class has been likely for so long that the contraction is over."""
        ended, self._now = self._now, Contraction(label)
        ended.others -= EDGE - 1  # what began the next one was no disagreement about this one
        ended.windows -= EDGE - 1
        for row, shares, likely in self._streak:
            self._now.take(row, likely, shares[labels.index(label)])
        self._streak = []
        if self._waiting and label not in (REST, self._waiting.label):
            yield Ended(self._waiting, f"{label} was asked for right after it")
            self._waiting = None
        if ended.label == REST:
            yield Ended(ended, self._flaw(ended))
            return
        flaw = self._flaw(ended) or ("" if label == REST else f"it went over into {label}")
        if flaw:
            yield Ended(ended, flaw)
            return
        if self._waiting:  # the same movement again, which takes nothing back
            yield Ended(self._waiting, "")
        self._waiting, self._waited = ended, 0

    def _wait(self) -> Iterator[Ended]:
        if self._waiting is None:
            return
        self._waited += 1
        if self._waited > self._patience:
            yield Ended(self._waiting, "")
            self._waiting = None

    def _flaw(self, ended: Contraction) -> str:
        if ended.windows < self._least or not ended.counted:
            return "it was too short"
        if ended.others > self._rules.dissent * ended.windows:
            return "it looked like other classes in between"
        return "it was not recognised surely enough" if ended.sure < self._rules.sure else ""
