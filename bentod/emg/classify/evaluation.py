"""How well classes are told apart in windows that were not trained on."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bentod.emg.classify.labelled import LabelledWindows
from bentod.emg.classify.training import Recipe, fitted
from bentod.emg.recognition import Classifier, Features
from bentod.errors import ConfigError


@dataclass(frozen=True, slots=True)
class Score:
    """Windows by what was done and what was recognised, before any vote or rejection."""

    labels: tuple[str, ...]
    confusion: NDArray[np.int64]  # shape (labels, labels): row what was done, column what was recognised

    @property
    def windows(self) -> int:
        """How many were tried."""
        return int(self.confusion.sum())

    @property
    def accuracy(self) -> float:
        """Share of the windows that were recognised, 0..1."""
        return float(np.trace(self.confusion) / self.confusion.sum())

    def recall(self) -> Mapping[str, float]:
        """Share of each class's own windows that were recognised, of the classes that were tried."""
        totals = self.confusion.sum(axis=1)
        return {
            label: float(self.confusion[k, k] / totals[k]) for k, label in enumerate(self.labels) if totals[k]
        }

    def __add__(self, other: "Score") -> "Score":
        labels = tuple(sorted({*self.labels, *other.labels}))
        together = np.zeros((len(labels), len(labels)), np.int64)
        for score in (self, other):
            places = [labels.index(label) for label in score.labels]
            together[np.ix_(places, places)] += score.confusion
        return Score(labels, together)


def scored(windows: LabelledWindows, features: Features, classifier: Classifier) -> Score:
    """What a trained classifier makes of these windows. Raises ConfigError: there are none."""
    if not len(windows):
        raise ConfigError("there are no windows to try")
    shares = classifier.probabilities(features.of(windows.windows))
    said = np.asarray(classifier.labels)[shares.argmax(axis=1)]
    labels = sorted({*classifier.labels, *windows.labels.tolist()})
    confusion = np.zeros((len(labels), len(labels)), np.int64)
    np.add.at(confusion, (np.searchsorted(labels, windows.labels), np.searchsorted(labels, said)), 1)
    return Score(tuple(labels), confusion)


def across(train: LabelledWindows, test: LabelledWindows, recipe: Recipe) -> Score:
    """Train on some windows, try on others. Raises ConfigError: see `fitted`."""
    return scored(test, *fitted(train, recipe))


def by_repetition(windows: LabelledWindows, recipe: Recipe) -> dict[int, Score]:
    """Each repetition tried by what was trained on all others: what a wearer can expect at best.

    Raises:
        ConfigError: there is only one repetition, or see `fitted`.
    """
    numbers = np.unique(windows.repetitions)
    if len(numbers) < 2:
        raise ConfigError("to leave one repetition out takes two or more")
    return {
        int(number): across(
            windows.where(windows.repetitions != number), windows.where(windows.repetitions == number), recipe
        )
        for number in numbers
    }


def at_random(
    windows: LabelledWindows, recipe: Recipe, share: float = 0.8, times: int = 30, seed: int = 0
) -> list[Score]:
    """Trained on a random `share` of all windows, tried on the others, again and again (thesis 3.5).

    Windows overlap, so those that are tried were half seen in training: this tells too much of a classifier.

    Raises:
        ConfigError: `share` is not between 0 and 1, or see `fitted`.
    """
    if not 0 < share < 1:
        raise ConfigError(
            f"{share:g} of all windows cannot be trained on; it must be between 0 and 1", "share"
        )
    return [
        across(windows.where(known), windows.where(asked), recipe)
        for known, asked in _splits(len(windows), share, times, seed)
    ]


def _splits(
    count: int, share: float, times: int, seed: int
) -> Iterator[tuple[NDArray[np.intp], NDArray[np.intp]]]:
    """Places of windows to train on and to try, both in order of time."""
    random = np.random.default_rng(seed)
    cut = round(share * count)
    for _ in range(times):
        order = random.permutation(count)
        yield np.sort(order[:cut]), np.sort(order[cut:])


def total(scores: Sequence[Score]) -> Score:
    """All windows of several scores."""
    first, *rest = scores
    return sum(rest, first)
