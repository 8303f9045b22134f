"""Generated signals of a few gestures, and what is trained on them."""

from functools import cache

import numpy as np
from numpy.typing import NDArray

from bentod.emg.classify.labelled import LabelledWindows, Piece, Recorded, windows_of
from bentod.emg.classify.model import Model, Setting
from bentod.emg.classify.training import Recipe, trained
from bentod.emg.features.feature_list import FeatureList
from bentod.emg.recognition import REST, Segmenting

RATE_HZ, CHANNELS = 200.0, 4
SETTING = Setting(RATE_HZ, CHANNELS, Segmenting(30, 10))
FEATURES = FeatureList("td", CHANNELS, RATE_HZ)
GAINS = {REST: (1, 1, 1, 1), "close": (9, 2, 4, 2), "open": (2, 9, 2, 4), "turn": (3, 3, 9, 9)}
"""By class, of the channels; in µV."""

OPTIONS = {
    "lda": {},
    "lda_adaptive": {},
    "lda_shrunk": {},
    "knn": {},
    "random_forest": {"trees": 20.0},
    "svm_linear": {},
    "svm_rbf": {},
}
"""Every kind of classifier, with options that make it quick to train."""


def session(repetitions: int = 3, seconds: float = 1.5, seed: int = 1) -> Recorded:
    """White noise of a strength that rises and falls; each class is prompted so many times."""
    random = np.random.default_rng(seed)
    count = int(seconds * RATE_HZ)
    samples, labels, numbers = [], [], []
    for repetition in range(repetitions):
        for label, gains in GAINS.items():
            strength = 0.6 + 0.4 * np.sin(np.linspace(0, np.pi, count))[:, np.newaxis]
            samples.append(1e-6 * strength * random.normal(size=(count, CHANNELS)) * gains)
            labels += [label] * count
            numbers += [repetition] * count
    conditions = np.full(len(labels), "")
    return Recorded(
        RATE_HZ, (Piece(np.concatenate(samples), np.array(labels), np.array(numbers), conditions),)
    )


@cache
def windows() -> LabelledWindows:
    """Those of a session."""
    return windows_of([session()], SETTING.segmenting)


@cache
def model(kind: str = "lda") -> Model:
    """Trained on that session."""
    return trained(windows(), Recipe(FEATURES, kind, OPTIONS[kind]), SETTING)


@cache
def table() -> NDArray[np.float64]:
    """Features of another session of the same person."""
    other = windows_of([session(seed=2)], SETTING.segmenting)
    return FEATURES.of(other.windows)
