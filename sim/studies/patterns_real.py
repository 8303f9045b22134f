"""What comes out on recordings that a user gives: of one day or condition, and from one to the others."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import permutations
from pathlib import Path

import numpy as np

from sim.studies.patterns import Labelled, random_splits, repetition_splits, right
from sim.studies.patterns_answers import ANSWERS as GENERATED
from sim.studies.patterns_answers import Answer, trained
from sim.studies.patterns_recordings import conditions
from sim.studies.patterns_tables import percent
from sim.studies.study import Listing

CHOSEN: Mapping[str, Answer] = {
    name: GENERATED[name]
    for name in ("TD/AR without segments", "ratios", "ratios, ZC, SSC", "robust", "robust + tonic")
}

MOST_TESTS = 20
"""Pairs of conditions that are told."""

NOTE = (
    "High-pass at 20 Hz; volts scaled so that the first condition has a root mean square of 1 V, "
    "about what the generated signals have behind the amplifier. 80/20 is optimistic: neighbouring "
    "windows share samples."
)


def listing(number: int, path: Path, splits: int, seed: int) -> Listing:
    """Accuracies in % of one recording.

    Raises:
        InputFileError: it cannot be used.
    """
    found = _scaled(conditions(path))
    head = ("trained on", "tested on", *CHOSEN)
    rows = [*_within(found, splits, seed), *_across(found, seed)]
    return Listing(f"recording-{number}", f"{path.name}: % right, LDA", (head, *rows), NOTE)


def _scaled(found: Mapping[str, Labelled]) -> dict[str, Labelled]:
    first = next(iter(found.values()))
    level = float(np.sqrt(np.mean(first.windows**2))) or 1.0
    return {name: replace(data, windows=data.windows / level) for name, data in found.items()}


def _within(found: Mapping[str, Labelled], splits: int, seed: int) -> Iterator[Sequence[str]]:
    for name, data in found.items():
        drawn = {"80/20": list(random_splits(len(data), splits, seed))}
        if len(np.unique(data.repetitions)) > 1:
            drawn["a repetition left out"] = list(repetition_splits(data.repetitions))
        for how, parts in drawn.items():
            cells = [
                np.mean([_right(answer, data.where(train), data.where(test), seed) for train, test in parts])
                for answer in CHOSEN.values()
            ]
            yield (name, f"the same, {how}", *(percent(float(cell)) for cell in cells))


def _across(found: Mapping[str, Labelled], seed: int) -> Iterator[Sequence[str]]:
    for one, other in list(permutations(found, 2))[:MOST_TESTS]:
        cells = [_right(answer, found[one], found[other], seed) for answer in CHOSEN.values()]
        yield (one, other, *(percent(cell) for cell in cells))


def _right(answer: Answer, train: Labelled, test: Labelled, seed: int) -> float:
    learned = trained(answer, train, seed)
    return right(learned.classifier, learned.of(test), test.labels)
