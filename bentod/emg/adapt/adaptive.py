"""A classifier that follows its wearer, and what keeps it from confirming its own errors.

Whoever learns from labels of their own makes errors true: a class that is taken for another one pulls that
one to itself (thesis 6.2). What stands against it here:

* It learns from contractions, not from windows, and only from those that were sure, calm, long enough not to
  have been broken off, and not followed at once by another movement: nobody corrected them.
* Labels are the classifier's own, before votes and before any prediction is added, so that a prediction
  cannot confirm itself through what it changed.
* A class may not go further from where it was trained than its nearest neighbour was, nor come nearer to
  another one than half of what they had been apart.
* Every class, rest included, moves by one step a contraction, however long or frequent it is.
* When contractions are no longer calm, it goes back to an earlier state that is as sure of them.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from bentod.config_adaptation import Adaptation
from bentod.emg.adapt.contractions import Contractions, Ended
from bentod.emg.adapt.health import Health
from bentod.emg.adapt.normal import Normal, Row
from bentod.emg.classify.model import Model
from bentod.emg.recognition import REST, Table
from bentod.frames import Value


class Adaptive:
    """Answers as its classifier, which changes in between; windows come in order, each one once."""

    def __init__(self, trained: Normal, rules: Adaptation, step_s: float) -> None:
        """`step_s`: s from one window to the next."""
        self.labels = trained.labels
        self.learned = 0
        """Contractions that were learned from."""
        self.newest = ""
        """What became of the newest contraction, as a sentence."""
        self.obeyed = True
        """Whether the arm does what the muscles ask; else nothing is learned, for nobody would correct it."""
        self._trained, self._rules = trained, rules
        self._between = np.array([trained.distances(mean) for mean in trained.means])
        self._reach = rules.bound * np.array([np.min(row[row > 0], initial=np.inf) for row in self._between])
        self._contractions = Contractions(rules, step_s)
        self.reset()

    def reset(self) -> None:
        """Back to what was trained."""
        self._now = self._trained
        self._health = Health(self._trained, self._rules.trouble)
        self._contractions.forget()

    def interrupt(self) -> None:
        """Windows are missing: what was under way counts for nothing."""
        self._contractions.forget()

    def probabilities(self, table: Table) -> Table:
        """See `Classifier`; what a row teaches counts from the next row on."""
        none = np.empty((0, len(self.labels)))
        return np.concatenate([none, *(self._step(row) for row in table)])

    def arrays(self) -> Mapping[str, NDArray[np.float64]]:
        """Of the classifier as it is now."""
        return self._now.arrays()

    def drift(self) -> Mapping[str, float]:
        """By label, how far each class is from where it was trained, as a share of how far it may be."""
        means = enumerate(self._now.means)
        moved = [float(self._trained.distances(mean)[place]) for place, mean in means]
        known = zip(self.labels, moved, self._reach.tolist(), strict=True)
        return {label: far / reach for label, far, reach in known}

    def describe(self) -> dict[str, Value]:
        """As clients see it."""
        return {
            "learned": self.learned,
            "rolled_back": self._health.rolled_back,
            "calm": self._health.calm,
            "drift": dict(self.drift()),
            "newest": self.newest,
        }

    def _step(self, row: Row) -> Table:
        shares = self._now.probabilities(row[np.newaxis])
        if not self.obeyed:
            self._contractions.forget()
            return shares
        for ended in self._contractions.take(row, shares[0].tolist(), self.labels):
            self._learn(ended)
        return shares

    def _learn(self, ended: Ended) -> None:
        one = ended.contraction
        before = self._now
        why = ended.why or self._follow(one.label, one.mean)
        if not why:
            self.learned += 1
        self.newest = f"{one.label}: {why or 'learned'}."
        if one.label == REST or not one.counted:
            return
        self._now = self._health.judge(before, self._now, one.mean, not ended.why)

    def _follow(self, label: str, seen: Row) -> str:
        """Go a step towards what was seen of a class. Returns why not; empty if it did."""
        place = self.labels.index(label)
        mean = self._now.means[place]
        moved = mean + self._rules.rate * (seen - mean)
        far = float(self._trained.distances(moved)[place])
        if far > self._reach[place]:
            home = self._trained.means[place]
            moved = home + self._reach[place] / far * (moved - home)
        near = self._now.distances(moved) < self._rules.apart * self._between[place]
        near[place] = False
        if near.any():
            return f"it would come too near to {self.labels[int(np.argmax(near))]}"
        self._now = self._now.moved(place, moved)
        return ""


def adaptive(model: Model, rules: Adaptation | None) -> Adaptive | None:
    """What follows the wearer from where `model` was trained; None: nobody asked for it, or it cannot."""
    if rules is None or not isinstance(model.classifier, Normal):
        return None
    setting = model.setting
    return Adaptive(model.classifier, rules, setting.segmenting.step / setting.rate_hz)
