"""What chapter 3 measures, of one simulated person after the other."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from typing import TypeVar

import numpy as np

from sim.movements import LOADS
from sim.studies.patterns import (
    CLASSIFIERS,
    Labelled,
    Split,
    four_loads,
    random_splits,
    repetition_splits,
    scores,
)
from sim.studies.patterns_sets import SETS, TOGETHER

Key = tuple[str, str, str]
"""Features, classifier, and what they were tested on: a load, or one of the following."""

RANDOM, SPREAD, REPETITIONS = "80/20", "80/20: standard error", "a repetition left out"

LEFT_OUT = tuple(TOGETHER)
"""The sets for which repetitions are left out."""


@dataclass(frozen=True, slots=True)
class Order:
    """What one person is to do."""

    person: int
    splits: int
    repetitions: int
    sets: tuple[str, ...] = tuple(SETS)
    classifiers: tuple[str, ...] = tuple(CLASSIFIERS)


def play(order: Order) -> dict[Key, float]:
    """Accuracies, 0..1."""
    sessions = four_loads(order.person, order.repetitions)
    unloaded = sessions[LOADS[0]]
    loaded: dict[str, Labelled] = {load: sessions[load] for load in LOADS[1:]}
    found: dict[Key, float] = {}
    for name in order.sets:
        specs = SETS[name]
        tested = scores(unloaded, loaded, specs, order.classifiers)
        found |= {(name, *key): value for key, value in tested.items()}
        drawn = _split(unloaded, random_splits(len(unloaded), order.splits, order.person), name, order)
        for classifier, values in drawn.items():
            found[name, classifier, RANDOM] = float(np.mean(values))
            found[name, classifier, SPREAD] = float(np.std(values) / np.sqrt(max(1, len(values) - 1)))
        if name in LEFT_OUT:
            left = _split(unloaded, repetition_splits(unloaded.repetitions), name, order)
            found |= {(name, which, REPETITIONS): float(np.mean(left[which])) for which in left}
    return found


def _split(data: Labelled, splits: Iterable[Split], name: str, order: Order) -> dict[str, list[float]]:
    """Accuracy in each split, by classifier."""
    found: dict[str, list[float]] = {which: [] for which in order.classifiers}
    for train, test in splits:
        told = scores(data.where(train), {"": data.where(test)}, SETS[name], order.classifiers)
        for which in order.classifiers:
            found[which].append(told[which, ""])
    return found


Asked = TypeVar("Asked")
Answer = TypeVar("Answer")


def everybody(work: Callable[[Asked], Answer], orders: Sequence[Asked], jobs: int = 1) -> list[Answer]:
    """All orders, in `jobs` processes at once, with the same outcome for any number of them."""
    if jobs <= 1 or len(orders) <= 1:
        return [work(order) for order in orders]
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        return list(pool.map(work, orders))


def mean(found: Sequence[Mapping[Key, float]], *key: str) -> float:
    """Over people, of features, classifier and test."""
    name, classifier, test = key
    return float(np.mean([one[name, classifier, test] for one in found]))


def loaded(found: Sequence[Mapping[Key, float]], name: str, classifier: str) -> float:
    """Mean over people and loads."""
    return float(np.mean([mean(found, name, classifier, load) for load in LOADS[1:]]))
