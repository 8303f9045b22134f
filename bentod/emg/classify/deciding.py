"""From probabilities to decisions: rejection, majority vote, flutter filter, ramp and proportional speed."""

from collections import Counter, deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from bentod.emg.classify.loudness import Range
from bentod.emg.recognition import REST, Decision
from bentod.errors import ConfigError

MOST_VOTES = 31
MOST_FLUTTER = 20
MOST_RAMP = 200
"""Decisions; at 50 ms a decision 10 s."""


@dataclass(frozen=True, slots=True)
class Deciding:
    """What is done with the answers of a classifier. The defaults do nothing but make speed proportional."""

    reject_below: float = 0.0
    """The least probability that is believed, 0..1; below it the muscles ask for nothing."""
    votes: int = 1
    """Windows that vote about the class, odd; 1: each window speaks for itself."""
    flutter: int = 1
    """Decisions for a class in a row, before it takes over from another; rest takes over at once."""
    ramp: int = 0
    """Decisions for a class until it has its full speed; 0: at once."""
    ramp_down: int = 2
    """How many of them each decision for something else takes away."""
    proportional: bool = True
    """Whether the speed follows the strength of the contraction; else a class has its full speed."""

    def __post_init__(self) -> None:
        """Raises ConfigError: a value is out of bounds."""
        _within("reject_below", self.reject_below, 0, 1)
        _within("votes", self.votes, 1, MOST_VOTES)
        _within("flutter", self.flutter, 1, MOST_FLUTTER)
        _within("ramp", self.ramp, 0, MOST_RAMP)
        _within("ramp_down", self.ramp_down, 1, MOST_RAMP)
        if not self.votes % 2:
            raise ConfigError(f"votes is {self.votes}; of two classes one must win: make it odd", "votes")


def _within(name: str, value: float, low: float, high: float) -> None:
    if not low <= value <= high:
        raise ConfigError(f"{name} is {value:g}; it must be from {low:g} to {high:g}", name)


class Decider:
    """What windows say one after the other. It knows no time: the same windows make the same decisions."""

    def __init__(
        self, labels: Sequence[str], ranges: Mapping[str, Range], deciding: Deciding | None = None
    ) -> None:
        """`ranges`: the loudness of each class in training."""
        self._labels = tuple(labels)
        self._ranges = ranges
        self._deciding = deciding or Deciding()
        self._votes: deque[str] = deque(maxlen=self._deciding.votes)
        self.forget()

    def forget(self) -> None:
        """Begin anew, as after a long rest: nothing else that was voted for or held counts."""
        self._votes.extend([REST] * self._deciding.votes)
        self._held = self._next = REST
        self._persisted = 0
        self._ramps = dict.fromkeys(self._labels, 0)

    def decide(self, index: int, shares: Sequence[float], loud: float) -> Decision:
        """About the window that sample `index` completed. `shares`: by label; `loud`: V, see `loudness`."""
        most = max(shares)
        likely = self._labels[list(shares).index(most)]
        rejected = most < self._deciding.reject_below
        self._votes.append(REST if rejected else likely)
        lasting = self._steady(self._vote())
        label = REST if rejected else lasting
        gain = self._ramp(label)
        speed = 0.0 if label == REST else gain * self._speed(label, loud)
        told = dict(zip(self._labels, shares, strict=True))
        return Decision(index, label, speed, told, likely, rejected)

    def refuse(self, index: int, reason: str) -> Decision:
        """No decision about the window that `index` completes, and what comes after it begins anew."""
        self.forget()
        return Decision(index, REST, 0.0, {}, REST, False, reason)

    def _vote(self) -> str:
        """The class that most windows say; of several the one that was said last."""
        counts = Counter(self._votes)
        most = max(counts.values())
        return next(label for label in reversed(self._votes) if counts[label] == most)

    def _steady(self, label: str) -> str:
        """What is held on to, until another class has come up often enough in a row."""
        self._persisted = self._persisted + 1 if label == self._next else 1
        self._next = label
        if label == REST or self._persisted >= self._deciding.flutter:
            self._held = label
        return self._held

    def _ramp(self, label: str) -> float:
        """The share of its speed that `label` has by now (the ramp of BioPatRec)."""
        length, down = self._deciding.ramp, self._deciding.ramp_down
        if not length:
            return 1.0
        for name, count in self._ramps.items():
            self._ramps[name] = min(count + 1, length) if name == label else max(count - down, 0)
        return self._ramps.get(label, 0) / length

    def _speed(self, label: str, loud: float) -> float:
        return self._ranges[label].speed(loud) if self._deciding.proportional else 1.0
