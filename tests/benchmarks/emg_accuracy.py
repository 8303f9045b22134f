"""How well classes are told apart on a public recording, and how long one window takes each classifier.

LibEMG's Myo recording, of eight channels at 200 Hz: five classes, four repetitions, the armband moved before
the last. Where it is not there, the rows say that nothing was measured. The times are of one window of eight
channels and four features, among seven classes, as a pipeline asks for them.
"""

import os
import statistics
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import numpy as np
from sklearn.discriminant_analysis import LinearDiscriminantAnalysis
from sklearn.ensemble import RandomForestClassifier
from sklearn.neighbors import KNeighborsClassifier
from threadpoolctl import threadpool_limits

from bentod.emg.classify import labelled_files
from bentod.emg.classify.evaluation import across, at_random, by_repetition, total
from bentod.emg.classify.kinds import trainer
from bentod.emg.classify.labelled import LabelledWindows, windows_of
from bentod.emg.classify.training import Recipe
from bentod.emg.features.feature_list import FeatureList
from bentod.emg.recognition import Segmenting, Table
from bentod.registry import CLASSIFIERS
from tests.benchmarks.harness import Row, at_least, at_most, interleave, main

RECORDING = Path(os.environ.get("BENTOD_MYO", Path(__file__).parents[3] / "shared/data/libemg_myo_200hz.npz"))
FEATURES = ("mav", "zc_product", "ssc_ge0", "wl")
"""MAV, ZC, SSC and WL as LibEMG defines them, without thresholds."""

CLASSES, COLUMNS, ROWS = 7, 32, 1200
"""Of the windows that are timed: a minute of training."""

ROUNDS = 400

KINDS = sorted(CLASSIFIERS)
THEIRS = {
    "lda": LinearDiscriminantAnalysis(),
    "knn": KNeighborsClassifier(5, algorithm="brute"),
    "random_forest": RandomForestClassifier(100, random_state=0),
}


def rows() -> Iterator[Row]:
    """Accuracy, then times."""
    if RECORDING.exists():
        yield from _accuracy(windows_of([labelled_files.read(RECORDING)], Segmenting(30, 10)))
    else:
        yield Row("accuracy on LibEMG's Myo recording: not measured, it is not here", float("nan"), "%")
    yield from _times()


def _accuracy(windows: LabelledWindows) -> Iterator[Row]:
    known, unmoved = (windows.where(windows.repetitions < end) for end in (2, 3))
    features = FeatureList(FEATURES, windows.windows.shape[1], 200.0)
    for kind in KINDS:
        recipe = Recipe(features, kind)
        again, moved = (
            100 * across(known, windows.where(windows.repetitions == k), recipe).accuracy for k in (2, 3)
        )
        name = f"Myo, {kind}"
        if kind == "lda":
            yield at_least(f"{name}: repetitions 0 and 1, tried on 2", again, "%", 100.0)
            yield at_least(f"{name}: tried on 3, the armband moved", round(moved, 1), "%", 21.5)
        else:
            yield Row(f"{name}: repetitions 0 and 1, tried on 2", again, "%")
            yield Row(f"{name}: tried on 3, the armband moved", moved, "%")
        left_out = total(list(by_repetition(unmoved, recipe).values())).accuracy
        yield Row(f"{name}: one repetition of 0 to 2 left out", 100 * left_out, "%")
        split = total(at_random(windows, recipe, times=5)).accuracy
        yield Row(f"{name}: a random fifth of all, 5 times (windows overlap)", 100 * split, "%")


def _times() -> Iterator[Row]:
    random = np.random.default_rng(1)
    labels = np.repeat([f"class {k}" for k in range(CLASSES)], ROWS // CLASSES).tolist()
    centres = np.repeat(random.normal(size=(CLASSES, COLUMNS)), ROWS // CLASSES, axis=0)
    table = centres + random.normal(size=centres.shape)
    ask = {kind: trainer(kind)(table, labels, {}, 0).probabilities for kind in KINDS}
    theirs = {f"scikit-learn's {kind}": model.fit(table, labels) for kind, model in THEIRS.items()}
    ask |= {name: model.predict_proba for name, model in theirs.items()}
    with threadpool_limits(1):  # with its threads, scikit-learn's nearest neighbours take up to 100 ms
        taken = interleave({name: partial(_seconds, asked, table) for name, asked in ask.items()}, ROUNDS)
    middle = {name: 1e6 * statistics.median(values) for name, values in taken.items()}
    for kind in KINDS:
        name = f"one window, {kind}"
        bound = at_most(f"{name}: median", middle[kind], "µs", 10)
        yield bound if kind == "lda" else Row(bound.name, bound.value, bound.unit)
        yield Row(f"{name}: 99th percentile", 1e6 * float(np.quantile(taken[kind], 0.99)), "µs")
        if kind in THEIRS:
            sooner = middle[f"scikit-learn's {kind}"] / middle[kind]
            yield at_least(f"{name}: times sooner than scikit-learn on one thread", sooner, "", 1)


def _seconds(asked: Callable[[Table], object], table: Table) -> float:
    """What one window takes, after another one that has just been asked for."""
    asked(table[:1])
    began = time.perf_counter()
    asked(table[1:2])
    return time.perf_counter() - began


if __name__ == "__main__":
    main("emg_accuracy", rows())
