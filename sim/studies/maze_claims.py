"""What must come out of the maze: the numbers of the thesis, its troubles, and what does better than it."""

import statistics
from collections.abc import Callable, Iterator, Sequence

from sim.studies.maze_people import Person
from sim.studies.stage import CircuitResult
from sim.studies.study import Claim

OURS = "confident"
LEAST_RECOVERED = 1.1
"""Times the mean of the assisted circuits before, within which a circuit counts as recovered."""

Measure = Callable[[CircuitResult], float]


def toggles(result: CircuitResult) -> float:
    """A `Measure`."""
    return result.toggles


def seconds(result: CircuitResult) -> float:
    """A `Measure`: s."""
    return result.time


def contacts(result: CircuitResult) -> float:
    """A `Measure`."""
    return result.contacts


def mean(results: Sequence[CircuitResult], measure: Measure) -> float:
    """NaN of none."""
    return statistics.fmean(map(measure, results)) if results else float("nan")


def change(person: Person, way: str, measure: Measure) -> float:
    """How much more in assisted than in solo circuits, as a share."""
    return mean(person.helped[way].results, measure) / mean(person.solo, measure) - 1


def first_is_slow(person: Person, way: str) -> bool:
    """Whether the first assisted circuit took longer than solo circuits on average, and a deviation more."""
    times = [result.time for result in person.solo]
    spread = statistics.stdev(times) if len(times) > 1 else 0.0
    return person.helped[way].results[0].time > statistics.fmean(times) + spread


def share(people: Sequence[Person], holds: Callable[[Person], bool]) -> float:
    """Of people of whom something is so; NaN of nobody."""
    return statistics.fmean(map(holds, people)) if people else float("nan")


def over(people: Sequence[Person], way: str, measure: Measure) -> float:
    """Mean over all assisted circuits of all."""
    return mean([result for person in people for result in person.helped[way].results], measure)


def recovery(person: Person, way: str) -> int:
    """Circuits after the maze was mirrored until one takes about the time and toggles of those before."""
    helped = person.helped[way]
    bounds = [LEAST_RECOVERED * mean(helped.results, measure) + 1e-9 for measure in (seconds, toggles)]
    for number, result in enumerate(helped.changed, 1):
        if result.time <= bounds[0] and result.toggles <= max(bounds[1], 1.0):
            return number
    return len(helped.changed) + 1


def claims(people: Sequence[Person]) -> tuple[Claim, ...]:
    """All that can be asked of what these people did."""
    ways = set(people[0].helped) if people else set[str]()
    found: list[Claim] = []
    if "thesis 10" in ways:
        found += _author([person for person in people if person.name.startswith("author")])
    if {"thesis 10", "thesis 20"} <= ways:
        found += _troubles([person for person in people if person.name.startswith("naive")])
    if {"thesis 20", OURS} <= ways:
        found += ours(people)
    if {"thesis 10", "shuffled"} <= ways:
        text = "the thesis' DPCC at 10 steps over predictions shuffled in time: toggles"
        gain = over(people, "thesis 10", toggles) / over(people, "shuffled", toggles)
        found.append(Claim("ablation", text, gain, "at most", 0.8))
    return tuple(found)


def ours(people: Sequence[Person]) -> Iterator[Claim]:
    """What must be better than in the thesis, at its own timescales."""
    measures = (("toggles", toggles, 1.0), ("time", seconds, 0.95), ("contacts", contacts, 0.5))
    for theirs in sorted({"thesis 10", "thesis 20"} & set(people[0].helped)):
        for text, measure, bound in measures:
            value = over(people, OURS, measure) / max(over(people, theirs, measure), 1e-9)
            told = f"dpcc_confident over DPCC at {theirs.split()[1]} steps: {text}"
            yield Claim("ours", told, value, "at most", bound)
    slow = share(people, lambda person: first_is_slow(person, OURS))
    text = "dpcc_confident: share whose first circuit is slower than solo mean + 1 sd"
    yield Claim("ours", text, slow, "at most", 0.1)
    worst = max(change(person, OURS, seconds) for person in people)
    yield Claim("ours", "dpcc_confident: worst operator, time over solo, less 1", worst, "at most", 0.0)


def _author(authors: Sequence[Person]) -> Iterator[Claim]:
    if authors:
        way = "thesis 10"
        for text, measure, bound in (("toggles", toggles, -0.6), ("time", seconds, -0.1)):
            value = statistics.fmean(change(person, way, measure) for person in authors)
            yield Claim("Table B.1", f"like the author, 10 steps: {text}, share", value, "at most", bound)


def _troubles(naive: Sequence[Person]) -> Iterator[Claim]:
    if naive:
        slow = share(naive, lambda person: first_is_slow(person, "thesis 20"))
        text = "naive, DPCC at 20 steps: share whose first circuit is slow"
        yield Claim("Table B.1", text, slow, "at least", 0.5)
        more = over(naive, "thesis 20", contacts) - over(naive, "thesis 10", contacts)
        text = "naive: contacts a circuit at 20 steps, less those at 10"
        yield Claim("appendix B", text, more, "at least", 0.1)
