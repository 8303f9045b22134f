"""Simulated wearers whose signals change in use, and classifiers that follow them, well or badly."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from bentod.config_adaptation import Adaptation
from bentod.emg.adapt.adaptive import Adaptive
from bentod.emg.adapt.normal import Normal, train
from bentod.emg.features.feature_list import FeatureList
from bentod.emg.recognition import REST, Classifier, Segmenting, Table
from bentod.emg.segmenting import cut
from sim.movement_signals import Moving
from sim.movements import Drift, Prompted, Scatter

RATE_HZ = 1000.0
SEGMENTING = Segmenting(150, 50)
STEP_S = 0.05
ELECTRODES = 6
HOLD_S = REST_S = 2.0
TRAINED = 4
"""Repetitions of each movement that are trained on."""

NOTICED = 8
"""Windows (0.4 s) of a wrong movement, after which a wearer sees it and lets go."""

HEEDED = 0.8
"""Share of the contractions in which the wearer looks."""


@dataclass(frozen=True, slots=True)
class Change:
    """What becomes of the signals during a session."""

    drift: Drift = field(default_factory=Drift)
    moved: float = 0.0
    """How far the band sits elsewhere in the middle third of the session, in radians as a deviation."""


CHANGES: Mapping[str, Change] = {
    "nothing": Change(),
    "fatigue": Change(Drift(amplitude=0.5, fatigue=1.0)),
    "shift of 20 degrees": Change(Drift(rotation_rad=0.35)),
    "fatigue and shift of 30 degrees": Change(Drift(amplitude=0.5, fatigue=1.0, rotation_rad=0.52)),
    "moved and put back": Change(moved=0.35),
}


@dataclass(frozen=True, slots=True)
class Session:
    """Windows in order of time."""

    rows: Table  # of features
    labels: NDArray[np.str_]  # what the wearer means; empty across an onset


def session(features: FeatureList, options: Prompted) -> Session:
    """A session of prompted movements, with everything between them."""
    moving = Moving(options, RATE_HZ)
    index = np.arange(0, moving.length - SEGMENTING.length + 1, SEGMENTING.step)
    first, last = moving.labels(index), moving.labels(index + SEGMENTING.length - 1)
    windows = cut(moving.samples.astype(np.float64), SEGMENTING)
    return Session(features.of(windows), np.where(first == last, first, ""))


@dataclass(frozen=True, slots=True)
class Wearer:
    """One person: what is trained on, and a session in which signals change."""

    person: int
    change: Change
    repetitions: int = 12
    sets: str = "robust"

    def sessions(self) -> tuple[Session, Session]:
        """Of one day."""
        features = FeatureList(self.sets, ELECTRODES, RATE_HZ)
        calm = self._prompted(1, TRAINED)
        use = session(features, self._prompted(2, self.repetitions, drift=self.change.drift))
        if self.change.moved:
            scatter = Scatter(day=self.change.moved)
            other = session(features, self._prompted(2, self.repetitions, scatter=scatter, day=1))
            use = _middle(use, other)
        return session(features, calm), use

    def _prompted(self, number: int, repetitions: int, **told: object) -> Prompted:
        usual = {
            "person": self.person, "session": 100 * self.person + number, "repetitions": repetitions,
            "electrodes": ELECTRODES, "hold_s": HOLD_S, "rest_s": REST_S,
        }  # fmt: skip
        return Prompted.model_validate({**usual, **told})


def _middle(use: Session, other: Session) -> Session:
    """`use`, with the middle third of `other`, in which the same is asked for at the same time."""
    third = len(use.rows) // 3
    rows = np.concatenate([use.rows[:third], other.rows[third : 2 * third], use.rows[2 * third :]])
    return Session(rows, use.labels)


class Naive:
    """Believes every label that it gives itself, at once: each window moves its class by `rate`."""

    def __init__(self, trained: Normal, rate: float) -> None:
        self.labels = trained.labels
        self._now, self._rate = trained, rate

    def probabilities(self, table: Table) -> Table:
        """See `Classifier`."""
        return np.concatenate([self._step(row) for row in table])

    def arrays(self) -> Mapping[str, NDArray[np.float64]]:
        """See `Classifier`."""
        return self._now.arrays()

    def _step(self, row: NDArray[np.float64]) -> Table:
        shares = self._now.probabilities(row[np.newaxis])
        place = int(np.argmax(shares))
        self._now = self._now.moved(
            place, self._now.means[place] + self._rate * (row - self._now.means[place])
        )
        return shares


def trained(known: Session) -> Normal:
    """On all windows in which only one thing is done."""
    clear = known.labels != ""
    return train(known.rows[clear], known.labels[clear].tolist(), {}, 0)


def followers(known: Normal) -> dict[str, Classifier]:
    """What is compared."""
    return {
        "no adaptation": known,
        "naive, slow": Naive(known, 0.005),
        "naive": Naive(known, 0.02),
        "naive, fast": Naive(known, 0.1),
        "ours": Adaptive(known, Adaptation(), STEP_S),
    }


@dataclass(frozen=True, slots=True)
class Outcome:
    """Recall averaged over classes, 0..1, in each third of the session."""

    thirds: tuple[float, ...]
    told: Mapping[str, object] = field(default_factory=dict)  # what the classifier says of itself


def used(classifier: Classifier, use: Session, seed: int) -> Outcome:
    """A session in which the wearer lets go when the arm does something else for too long.

    What is scored is the answer to what the wearer would have shown, be it that they had let go by then.
    """
    wearer = _Attentive(use, np.random.default_rng([seed, 11]))
    said: list[str] = []
    for place, meant in enumerate(use.labels.tolist()):
        asked = type(classifier) is Normal or not wearer.let_go
        row = use.rows[place] if asked else wearer.resting(place)
        shares = classifier.probabilities(row[np.newaxis])
        if not asked:
            shares = _alone(classifier).probabilities(use.rows[place : place + 1])
        said.append(classifier.labels[int(np.argmax(shares))])
        wearer.see(meant, said[-1])
    told = classifier.describe() if isinstance(classifier, Adaptive) else {}
    return Outcome(tuple(_recall(use.labels, np.array(said), third) for third in range(3)), told)


def _alone(classifier: Classifier) -> Normal:
    """As it is now, and stays."""
    known = classifier.arrays()
    return Normal(classifier.labels, known["means"], known["precision"], known["logs"])


class _Attentive:
    """Sees a wrong movement after a while, and lets go until the next movement is due."""

    def __init__(self, use: Session, random: np.random.Generator) -> None:
        self.let_go = False
        self._random, self._wrong, self._looks = random, 0, True
        self._rests, self._rows = np.flatnonzero(use.labels == REST), use.rows

    def see(self, meant: str, said: str) -> None:
        """What the arm does instead of what is meant."""
        if meant == REST:
            self.let_go, self._wrong = False, 0
            self._looks = self._random.random() < HEEDED
        elif meant and not self.let_go:
            self._wrong = self._wrong + 1 if said not in (meant, REST) else 0
            self.let_go = self._looks and self._wrong >= NOTICED

    def resting(self, place: int) -> NDArray[np.float64]:
        """A window of rest from about that time."""
        near = int(np.searchsorted(self._rests, place))
        chosen = max(0, min(near - 1 - int(self._random.integers(20)), len(self._rests) - 1))
        row: NDArray[np.float64] = self._rows[self._rests[chosen]]
        return row


def _recall(meant: NDArray[np.str_], said: NDArray[np.str_], third: int) -> float:
    part = slice(third * len(meant) // 3, (third + 1) * len(meant) // 3)
    known = sorted(set(meant[part].tolist()) - {""})
    return float(np.mean([np.mean(said[part][meant[part] == label] == label) for label in known]))


def everything(wearer: Wearer) -> dict[str, Outcome]:
    """All that is compared, with one person."""
    known, use = wearer.sessions()
    return {name: used(one, use, wearer.person) for name, one in followers(trained(known)).items()}


def mean(outcomes: Sequence[Mapping[str, Outcome]], name: str, third: int = 2) -> float:
    """Over people."""
    return float(np.mean([one[name].thirds[third] for one in outcomes]))


def worst(outcomes: Sequence[Mapping[str, Outcome]], name: str) -> float:
    """The person who lost most in the last third against no adaptation: share, negative if one lost."""
    return min(one[name].thirds[2] - one["no adaptation"].thirds[2] for one in outcomes)
