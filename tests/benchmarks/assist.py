"""Collaborative control over a population of simulated operators: a check of the software, not of people.

SIZE: how many operators (8). All assists of an operator begin after the same circuits alone.
"""

import os
from collections.abc import Iterator, Sequence

from sim.people.population import population
from sim.studies.maze_claims import (
    change,
    claims,
    contacts,
    first_is_slow,
    over,
    recovery,
    seconds,
    share,
    toggles,
)
from sim.studies.maze_people import Order, Person, everybody
from sim.studies.study import Claim
from tests.benchmarks.harness import Row, main

SEED = 11
"""None of those that the operators were adjusted with."""

CIRCUITS, CHANGED = 20, 10
WAYS = ("thesis 10", "thesis 20", "confident", "oracle")
CHANGED_WAYS = ("thesis 20", "confident")
CHANGED_OPERATORS = 2
JOBS = 2


def rows() -> Iterator[Row]:
    """About eight minutes on two cores that have nothing else to do."""
    size = int(os.environ.get("SIZE", "8"))
    traits = population(size, SEED)
    orders = [Order(it, SEED + i, WAYS, CIRCUITS, CIRCUITS, tracked=False) for i, it in enumerate(traits)]
    orders += [
        Order(it, SEED + i, CHANGED_WAYS, CIRCUITS, CIRCUITS, CHANGED, tracked=False)
        for i, it in enumerate(traits[:CHANGED_OPERATORS])
    ]
    found = everybody(orders, JOBS)
    people, changed = found[:size], found[size:]
    yield from map(_row, claims(people))
    yield from _means(people)
    yield from _recovered(changed)


def _row(claim: Claim) -> Row:
    sign = "<=" if claim.relation == "at most" else ">="
    return Row(claim.text, claim.value, "", f"{sign} {claim.bound:g}", claim.holds)


MEASURES = (("toggles", toggles, ""), ("time", seconds, "s"), ("contacts", contacts, ""))


def _means(people: Sequence[Person]) -> Iterator[Row]:
    for way in WAYS:
        for text, measure, unit in MEASURES:
            yield Row(f"{way}: {text} of an assisted circuit", over(people, way, measure), unit)
        slower = sum(change(person, way, seconds) > 0 for person in people)
        yield Row(f"{way}: operators who are slower than alone", slower, f"of {len(people)}")
        slow = share(people, lambda person: first_is_slow(person, way))  # noqa: B023 -- called at once
        yield Row(f"{way}: share whose first circuit is slower than solo mean + 1 sd", slow, "")
        errors = [person.helped[way].rmse[1] for person in people]
        yield Row(f"{way}: elbow, RMSE against the ideal prediction", sum(errors) / len(errors), "rad")


def _recovered(changed: Sequence[Person]) -> Iterator[Row]:
    for way in CHANGED_WAYS:
        counts = [recovery(person, way) for person in changed]
        mean = sum(counts) / len(counts)
        text = f"{way}: circuits to recover from a mirrored maze ({CHANGED + 1}: not within {CHANGED})"
        yield Row(text, mean, "")


if __name__ == "__main__":
    main("assist", rows())
