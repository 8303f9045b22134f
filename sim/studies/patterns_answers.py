"""What raises accuracy under load without loaded training data: chosen on some people, shown on others."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from bentod.emg.augment import Tonic, with_tonic
from bentod.emg.classify.kinds import trainer
from bentod.emg.features.feature_list import FeatureList
from bentod.emg.recognition import Classifier, Table, Windows
from sim.movements import LOADS, Prompted
from sim.studies.patterns import Labelled, generated, right
from sim.studies.patterns_sets import FLOOR_V, ROBUST, SINGLE, TOGETHER, USUAL, Specs

BASE = "TD/AR"


@dataclass(frozen=True, slots=True)
class Answer:
    """Features, a classifier, and what is done to training data or windows before."""

    specs: Specs
    classifier: str = "lda"
    tonic: Tonic | None = None
    normalised: bool = False
    tracked: bool = False


def _plain(*names: str) -> Specs:
    return tuple({**SINGLE[name], "segments": 1} if name != "AR" else {"name": "ar_burg"} for name in names)


LOG: Specs = ({"name": "log_rms", "floor_v": FLOOR_V},)
AR4: Specs = ({"name": "ar_burg"},)
RATIOS = _plain("Ratios")
LOG_RATIOS: Specs = (*LOG, *RATIOS)

ANSWERS: Mapping[str, Answer] = {
    BASE: Answer(TOGETHER["TD/AR"]),
    "TD/AR without segments": Answer(USUAL),
    "TD/AR, shrunk covariance": Answer(TOGETHER["TD/AR"], "lda_shrunk"),
    "TD/AR, windows of equal amplitude": Answer(USUAL, normalised=True),
    "ratios": Answer(RATIOS),
    "ratios, ZC, SSC": Answer(_plain("Ratios", "ZC", "SSC")),
    "spectra: AR, ZC, SSC": Answer(_plain("AR", "ZC", "SSC")),
    "logarithms": Answer(LOG),
    "logarithms and ratios": Answer(LOG_RATIOS),
    "robust": Answer(ROBUST),
    "TD/AR + tonic": Answer(USUAL, tonic=Tonic()),
    "logarithms and ratios + tonic": Answer(LOG_RATIOS, tonic=Tonic()),
    "robust + weaker tonic": Answer(ROBUST, tonic=Tonic(strength=1.0)),
    "robust + tonic": Answer(ROBUST, tonic=Tonic()),
    "robust + stronger tonic": Answer(ROBUST, tonic=Tonic(strength=3.0)),
    "robust + tonic, KNN": Answer(ROBUST, "knn", Tonic(copies=2)),
    "robust + tonic, linear SVM": Answer(ROBUST, "svm_linear", Tonic(copies=2)),
    "robust + tonic + rest tracked": Answer(ROBUST, tonic=Tonic(), tracked=True),
}

UNLOADED_BOUND = 0.02
"""What may be lost without a load, against `BASE`."""


@dataclass(frozen=True, slots=True)
class Ask:
    """Who is to try which answers, trained without a load and tested in sessions that differ as told."""

    person: int
    repetitions: int
    answers: tuple[str, ...] = tuple(ANSWERS)
    tests: Mapping[str, Mapping[str, object]] = field(default_factory=lambda: TESTS)


TESTS: Mapping[str, Mapping[str, object]] = {load: {"load": load} for load in LOADS}

HARDER: Mapping[str, Mapping[str, object]] = {
    "15 lb, voltage linear in activation": {"load": "15 lb", "exponent": 1.0},
    "15 lb, half as heavy again": {"load": "15 lb", "load_share": 1.5},
    "15 lb, harder movements": {"load": "15 lb", "effort": 1.1},
    "15 lb, weak movements": {"load": "15 lb", "effort": 0.5},
    "15 lb, the band turned by 10 degrees": {"load": "15 lb", "drift": {"rotation_rad": 0.175}},
    "15 lb, another day": {"load": "15 lb", "day": 1},
    "15 lb, tired muscles": {"load": "15 lb", "drift": {"fatigue": 1.0, "amplitude": 0.3}},
    "15 lb, mains hum of 20 uV": {"load": "15 lb", "nuisances": {"hum_v": 20e-6}},
}
"""What answers were not chosen for: `Prompted` differs from training in these besides."""


def play(ask: Ask) -> dict[tuple[str, str], float]:
    """Accuracies, 0..1, by answer and test."""
    train = _session(ask, 0, {})
    tests = {name: _session(ask, number, told) for number, (name, told) in enumerate(ask.tests.items(), 1)}
    found: dict[tuple[str, str], float] = {}
    for name in ask.answers:
        made = trained(ANSWERS[name], train, ask.person)
        found |= {
            (name, test): right(made.classifier, made.of(data), data.labels) for test, data in tests.items()
        }
    return found


def _session(ask: Ask, number: int, told: Mapping[str, object]) -> Labelled:
    usual = {"person": ask.person, "session": 100 * ask.person + number, "repetitions": ask.repetitions}
    return generated(Prompted.model_validate({**usual, **told}))


@dataclass(frozen=True, slots=True)
class Trained:
    """An answer that has learned."""

    answer: Answer
    features: FeatureList
    classifier: Classifier

    def of(self, data: Labelled) -> Table:
        """What the classifier sees of windows."""
        return _table(self.answer, self.features, data)


def trained(answer: Answer, train: Labelled, seed: int) -> Trained:
    """From sessions without a load alone."""
    features = FeatureList(answer.specs, train.windows.shape[1], train.rate_hz).fit(train.windows)
    data = _augmented(train, answer.tonic, seed) if answer.tonic else train
    learn = trainer(answer.classifier)
    return Trained(answer, features, learn(_table(answer, features, data), data.labels.tolist(), {}, seed))


def _augmented(train: Labelled, tonic: Tonic, seed: int) -> Labelled:
    """With tonic contractions; the background of a window has risen by about what was added to it."""
    windows, labels = with_tonic(train.windows, train.labels.tolist(), tonic, seed)
    times = tonic.copies + 1
    before = np.tile(_power(train.windows), (times, 1))
    known = np.random.default_rng([seed, 9]).uniform(0.5, 1.1, before.shape[:1])[:, np.newaxis]
    rise = known * np.maximum(_power(windows) - before, 0.0)
    background = np.tile(train.background, (times, 1)) + rise
    return Labelled(windows, np.array(labels), np.tile(train.repetitions, times), background, train.rate_hz)


def _table(answer: Answer, features: FeatureList, data: Labelled) -> Table:
    if answer.normalised:
        whole = np.sqrt(_power(data.windows).mean(axis=1))[:, np.newaxis, np.newaxis]
        return features.of(data.windows / np.maximum(whole, FLOOR_V))
    if not answer.tracked:
        return features.of(data.windows)
    power = _power(data.windows)
    left = np.maximum(power - data.background, FLOOR_V**2) / np.maximum(power, FLOOR_V**2)
    alone = data.windows * np.sqrt(left)[..., np.newaxis]
    rest = 0.5 * np.log(np.maximum(data.background, FLOOR_V**2))
    return np.hstack([features.of(data.windows), features.of(alone), rest])


def _power(windows: Windows) -> Table:
    return np.asarray(np.mean(windows**2, axis=-1))


Found = Sequence[Mapping[tuple[str, str], float]]


def mean(found: Found, answer: str, test: str) -> float:
    """Over people."""
    return float(np.mean([one[answer, test] for one in found]))


def loaded(found: Found, answer: str) -> float:
    """Mean over people and loads."""
    return float(np.mean([mean(found, answer, load) for load in LOADS[1:]]))


def chosen(found: Found) -> str:
    """The best mean over loads, of answers that need no memory and lose little without a load."""
    bound = mean(found, BASE, LOADS[0]) - UNLOADED_BOUND
    fit = [name for name, one in ANSWERS.items() if not one.tracked and mean(found, name, LOADS[0]) >= bound]
    return max(fit, key=lambda name: loaded(found, name))
