"""Patterns of generated EMG with and without a load: a check of the software, not of people.

SIZE: how many people chapter 3 is done with (3); our answer is chosen on twice as many, and shown on others.
"""

import os
from collections.abc import Iterator

from sim.movements import LOADS
from sim.studies import patterns_answers as answers
from sim.studies import patterns_people as people
from sim.studies.patterns_people import RANDOM, REPETITIONS, Order, loaded, mean
from sim.studies.patterns_sets import SINGLE, TD, TD_AR
from sim.studies.patterns_tables import GAIN, rank, usual
from tests.benchmarks.harness import Row, at_least, at_most, main

FIRST = 50_001
"""Number of the first person: none with whom anything was chosen when this was written."""

SPLITS, REPEATED = 2, 4
CLASSIFIERS = ("KNN", "LDA")
JOBS = 2
SHOWN = (
    "TD/AR without segments",
    "TD/AR + tonic",
    "robust",
    "robust + tonic",
    "robust + tonic + rest tracked",
)


def rows() -> Iterator[Row]:
    """Less than two minutes on two cores that have nothing else to do."""
    size = int(os.environ.get("SIZE", "3"))
    yield from _chapter(size)
    yield from _answer(size)


def _chapter(size: int) -> Iterator[Row]:
    sets = (TD, TD_AR, *SINGLE)
    orders = [Order(FIRST + number, SPLITS, REPEATED, sets, CLASSIFIERS) for number in range(size)]
    found = people.everybody(people.play, orders, JOBS)
    for name in (TD, TD_AR):
        yield at_least(f"{name}, LDA, unloaded, 80/20", 100 * mean(found, name, "LDA", RANDOM), "%", 90)
        yield Row(
            f"{name}, LDA, unloaded, a repetition left out", 100 * mean(found, name, "LDA", REPETITIONS), "%"
        )
    for load in LOADS[1:]:
        yield Row(f"TD/AR, LDA, {load}", 100 * mean(found, TD_AR, "LDA", load), "%")
    fall = 100 * (mean(found, TD_AR, "LDA", RANDOM) - mean(found, TD_AR, "LDA", "15 lb"))
    yield at_least("TD/AR, LDA: fall from unloaded to 15 lb", fall, "points", 25)
    yield at_most("rank of the ratios among ten features under load (KNN, LDA)", rank(found), "", 2)
    best = max(SINGLE, key=lambda name: sum(loaded(found, name, which) for which in CLASSIFIERS))
    yield Row(f"best of ten features under load: {best}, LDA", 100 * loaded(found, best, "LDA"), "%")


def _answer(size: int) -> Iterator[Row]:
    asks = [answers.Ask(FIRST + size + number, REPEATED) for number in range(4 * size)]
    tried = people.everybody(answers.play, asks, JOBS)
    choosing, shown = tried[: 2 * size], tried[2 * size :]
    for name in SHOWN:
        yield Row(f"{name}: mean under load, other people", 100 * answers.loaded(shown, name), "%")
    name = answers.chosen(choosing)
    gain = 100 * (answers.loaded(shown, name) - usual(shown))
    yield at_least(f"chosen, {name}: over TD/AR with LDA under load", gain, "points", GAIN)
    cost = 100 * (answers.mean(shown, answers.BASE, LOADS[0]) - answers.mean(shown, name, LOADS[0]))
    yield at_most(f"chosen, {name}: lost without a load", cost, "points", 2)


if __name__ == "__main__":
    main("emg_patterns", rows())
