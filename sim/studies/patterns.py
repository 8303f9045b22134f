"""Windows with labels for the study of patterns: how they are generated and split, and who is right."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from bentod.emg.classify.kinds import trainer
from bentod.emg.classify.nearest import Nearest
from bentod.emg.features.feature_list import FeatureList
from bentod.emg.recognition import REST, Classifier, Segmenting, Table, Windows
from bentod.emg.segmenting import cut
from sim.movement_signals import Moving
from sim.movements import LOADS, Prompted
from sim.studies.patterns_sets import Specs

RATE_HZ = 1000.0
SEGMENTING = Segmenting(150, 50)
"""150 ms by 50 ms (thesis 3.3.1)."""

AMPLIFICATION = 1e4
"""Of the amplifier before the converter, as a Delsys Bagnoli may have: thresholds are in V behind it."""

CLASSIFIERS = {"KNN": "knn", "LDA": "lda", "RF": "random_forest", "SVM": "svm_rbf"}
"""The four of the thesis by their names in the registry."""

REMEMBERED_S = 12.0
"""For so long the background of a channel is looked for: long enough for a rest to be in it."""

LOW = 0.2
"""Share of the windows in it that are taken for rest."""


@dataclass(frozen=True, slots=True)
class Labelled:
    """Windows of which is known what was done; all of one length and of the same channels."""

    windows: Windows  # V at the converter
    labels: NDArray[np.str_]  # shape (windows,)
    repetitions: NDArray[np.int64]  # of the movement, from 0; shape (windows,)
    background: Table  # V², power of each channel in its latest rest, shape (windows, channels)
    rate_hz: float = RATE_HZ

    def __len__(self) -> int:
        return len(self.windows)

    def where(self, chosen: NDArray[np.bool_] | NDArray[np.int64]) -> "Labelled":
        """Some of the windows."""
        kept = self.windows[chosen], self.labels[chosen], self.repetitions[chosen], self.background[chosen]
        return Labelled(*kept, self.rate_hz)


def generated(options: Prompted) -> Labelled:
    """One session of a simulated person, with as many windows of rest as of one movement on average."""
    return thinned(whole(Moving(options, RATE_HZ)))


def whole(moving: Moving) -> Labelled:
    """All windows of a session in which only one thing is done; those across an onset have no one label."""
    index = np.arange(0, moving.length - SEGMENTING.length + 1, SEGMENTING.step)
    first, last = moving.labels(index), moving.labels(index + SEGMENTING.length - 1)
    shown = np.array([prompt.hidden for prompt in moving.prompts])
    place = np.minimum(np.searchsorted(shown, index), len(shown) - 1)
    repetitions = np.array([prompt.repetition for prompt in moving.prompts])[place]
    windows = cut(AMPLIFICATION * moving.samples.astype(np.float64), SEGMENTING)
    return Labelled(windows, first, repetitions, background(windows)).where(first == last)


def background(windows: Windows) -> Table:
    """V², shape (windows, channels): what a channel had at rest during `REMEMBERED_S` up to each window."""
    power = np.mean(windows**2, axis=-1)
    span = round(REMEMBERED_S * RATE_HZ / SEGMENTING.step)
    before = np.concatenate([np.repeat(power[:1], span - 1, axis=0), power])
    return np.asarray(np.quantile(sliding_window_view(before, span, axis=0), LOW, axis=-1))


def thinned(data: Labelled) -> Labelled:
    """As many windows of rest, evenly chosen, as of other classes on average: chance is the same for all."""
    rest = np.flatnonzero(data.labels == REST)
    others = len(np.unique(data.labels)) - 1
    fair = (len(data) - len(rest)) // max(others, 1)
    kept = rest[:: max(1, len(rest) // max(fair, 1))]
    return data.where(np.sort(np.concatenate([np.flatnonzero(data.labels != REST), kept])))


def four_loads(person: int, repetitions: int) -> dict[str, Labelled]:
    """A person's sessions of one day, unloaded first."""
    return {
        load: generated(
            Prompted(person=person, session=10 * person + number, load=load, repetitions=repetitions)
        )
        for number, load in enumerate(LOADS)
    }


def scores(
    train: Labelled, tests: Mapping[str, Labelled], specs: Specs, classifiers: Sequence[str], seed: int = 0
) -> dict[tuple[str, str], float]:
    """Share of windows told right, by classifier and test; features are fitted on `train` alone."""
    features = FeatureList(specs, train.windows.shape[1], train.rate_hz).fit(train.windows)
    table, labels = features.of(train.windows), train.labels.tolist()
    tables = {name: features.of(test.windows) for name, test in tests.items()}
    found: dict[tuple[str, str], float] = {}
    for name in classifiers:
        trained = trainer(CLASSIFIERS[name])(table, labels, {}, seed)
        for test, rows in tables.items():
            found[name, test] = right(trained, rows, tests[test].labels)
    return found


def right(trained: Classifier, table: Table, labels: NDArray[np.str_]) -> float:
    """Share of the rows whose most probable class is theirs."""
    shares = nearest(trained, table) if isinstance(trained, Nearest) else trained.probabilities(table)
    told = np.array(trained.labels)[np.argmax(shares, axis=1)]
    return float(np.mean(told == labels))


def nearest(trained: Nearest, table: Table) -> Table:
    """What it would say of each row alone, for all rows at once, which takes a hundredth of the time."""
    known = trained.arrays()
    rows, codes = known["rows"], known["codes"].astype(np.intp)
    asked = (table - known["mean"]) / known["deviation"]
    far = np.sum(rows**2, axis=1) - 2 * asked @ rows.T  # and the asked row's own square, the same for all
    near = codes[np.argpartition(far, int(known["neighbours"][0]) - 1)[:, : int(known["neighbours"][0])]]
    return np.stack([np.mean(near == code, axis=1) for code in range(len(trained.labels))], axis=1)


Split = tuple[NDArray[np.int64], NDArray[np.int64]]


def random_splits(count: int, splits: int, seed: int) -> Iterator[Split]:
    """80 % of windows to train, 20 % to test, at random (thesis 3.5)."""
    for number in range(splits):
        order = np.random.default_rng([seed, number]).permutation(count)
        yield order[count // 5 :], order[: count // 5]


def repetition_splits(repetitions: NDArray[np.int64]) -> Iterator[Split]:
    """Each repetition left out in its turn."""
    for left_out in np.unique(repetitions):
        yield np.flatnonzero(repetitions != left_out), np.flatnonzero(repetitions == left_out)
