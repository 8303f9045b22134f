"""Classifiers that follow their wearer, and predictions that are weighed in: simulated people, held out.

SIZE: how many people adaptation is shown with (3). A check of the software, not of people.
"""

import os
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from bentod.config_adaptation import Fusion
from sim.studies.adaptation import CHANGES, Wearer, everything, mean, worst
from sim.studies.fused_use import Use, person, used
from sim.studies.patterns_people import everybody
from tests.benchmarks.harness import Row, at_least, main

FIRST = 60_001
"""Number of the first person: none with whom anything was chosen when this was written."""

JOBS = 2
SHOWN = ("nothing", "shift of 20 degrees", "fatigue and shift of 30 degrees", "moved and put back")
USERS = 2
FUSIONS = {"off": None, "on": Fusion(), "on, softened": Fusion(beta=0.5, softness=6.0)}


def rows() -> Iterator[Row]:
    """Under a minute and a half on two cores."""
    size = int(os.environ.get("SIZE", "3"))
    yield from _adaptation(size)
    yield from _fusion()


def _adaptation(size: int) -> Iterator[Row]:
    """Recall in the last third of a session: what the wearer has by then."""
    wearers = [Wearer(FIRST + number, CHANGES[name]) for name in SHOWN for number in range(size)]
    found = everybody(everything, wearers, JOBS)
    for place, name in enumerate(SHOWN):
        people = found[place * size : (place + 1) * size]
        for follower in people[0]:
            yield Row(f"{name}: {follower}", 100 * mean(people, follower), "%")
        gain = 100 * (mean(people, "ours") - mean(people, "no adaptation"))
        bound = 5 if "shift" in name else -2
        yield at_least(f"{name}: gain of ours", gain, "points", bound)
        yield Row(f"{name}: ours, worst person", 100 * worst(people, "ours"), "points")
        yield Row(f"{name}: naive, worst person", 100 * worst(people, "naive"), "points")


@dataclass(frozen=True, slots=True)
class Trial:
    """Who does which task with which predictions."""

    person: int
    predictable: bool
    fusion: str


def _play(trial: Trial) -> Use:
    return used(person(trial.person), trial.predictable, FUSIONS[trial.fusion], trial.person)


def _fusion() -> Iterator[Row]:
    known = range(FIRST, FIRST + USERS)
    trials = [Trial(who, task, name) for task in (True, False) for name in FUSIONS for who in known]
    found = dict(zip(trials, everybody(_play, trials, JOBS), strict=True))
    for task in (True, False):
        told = "the same again and again" if task else "at random"
        for name in FUSIONS:
            uses = [found[Trial(who, task, name)] for who in known]
            plain = [found[Trial(who, task, "off")] for who in known]
            right = 100 * float(np.mean([use.right for use in uses]))
            yield Row(f"{told}, fusion {name}: right", right, "%")
            yield Row(f"{told}, fusion {name}: wrong", 100 * float(np.mean([use.wrong for use in uses])), "%")
            if name != "off":
                before = 100 * float(np.mean([use.right for use in plain]))
                yield at_least(f"{told}, fusion {name}: gain", right - before, "points", -1)
                owed = 100 * float(np.mean([use.owed for use in uses]))
                yield Row(f"{told}, fusion {name}: decisions it changed", owed, "%")


if __name__ == "__main__":
    main("emg_adaptation", rows())
