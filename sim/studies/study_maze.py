"""Thesis 5.5 and appendix B: the angle maze, alone and with an arm that helps, by simulated operators."""

from collections.abc import Sequence

import numpy as np

from bentod.contracts import Vector
from sim.people.population import population
from sim.studies.maze_charts import charts
from sim.studies.maze_claims import change, claims, contacts, first_is_slow, mean, recovery, seconds, toggles
from sim.studies.maze_people import TOLD, WAYS, Order, Person, chosen, everybody
from sim.studies.maze_table import HEAD, THESIS, row
from sim.studies.study import Findings, Listing, People, Setting, Study

OPERATORS, CIRCUITS = 4, 20
CHANGED = 10
"""Circuits in the mirrored maze."""
CHANGED_WAYS = ("thesis 20", "confident")
CHANGED_OPERATORS = 2


def run(seed: int, asked: People) -> Findings:
    """Everybody alone, with every assist, and a few in a maze that is mirrored in mid-session."""
    circuits, number = asked.circuits or CIRCUITS, asked.operators or OPERATORS
    ways = chosen(asked.modes or tuple(TOLD))
    traits = population(number, seed)
    orders = [Order(it, seed + i, ways, circuits, circuits) for i, it in enumerate(traits)]
    changing = tuple(way for way in CHANGED_WAYS if way in ways)
    few = traits[-CHANGED_OPERATORS:] if changing else []
    first = seed + number - len(few)
    orders += [
        Order(it, first + i, changing, circuits, circuits, min(CHANGED, circuits), tracked=False)
        for i, it in enumerate(few)
    ]
    found = everybody(orders, asked.jobs)
    people, changed = found[:number], found[number:]
    return Findings(
        settings=SETTINGS,
        claims=claims(people),
        pictures=(),
        comparison=_table(people),
        series=_series(people),
        simulated=SIMULATED,
        remarks=REMARKS,
        charts=charts(people),
        listings=_listings(people, changed),
    )


def _table(people: Sequence[Person]) -> tuple[Sequence[str], ...]:
    """Table B.1, its own rows first, and contacts, which the thesis did not count."""
    rows: list[tuple[str, ...]] = [(f"thesis: {cells[0]}", *cells[1:], "", "") for cells in THESIS]
    for person in people:
        for way, helped in person.helped.items():
            cells = row(f"{person.name}, {way}", WAYS[way].help.timescale, person.circuits(way))
            touched = [f"{mean(results, contacts):.2g}" for results in (person.solo, helped.results)]
            rows.append((cells[0], *cells[1:], *touched))
    return ((*HEAD, "solo contacts avg", "assisted contacts avg"), *rows)


def _listings(people: Sequence[Person], changed: Sequence[Person]) -> tuple[Listing, ...]:
    listings = [
        Listing("ways", "With every assist, over all operators", (WAYS_HEAD, *_ways(people)), WAYS_NOTE),
        Listing("worst", "Where it still fails", (WORST_HEAD, *_worst(people)), WORST_NOTE),
    ]
    if changed:
        rows = tuple(
            (person.name, way, *map(str, _recovered(person, way)))
            for person in changed
            for way in person.helped
        )
        head = ("operator", "assist", "circuits", "s before", "s after", "toggles before", "toggles after")
        listings.append(Listing("change", "The maze mirrored in mid-session", (head, *rows), CHANGE_NOTE))
    return tuple(listings)


def _recovered(person: Person, way: str) -> tuple[str, ...]:
    helped, count = person.helped[way], recovery(person, way)
    until = f"more than {len(helped.changed)}" if count > len(helped.changed) else str(count)
    measured = [mean(part, m) for m in (seconds, toggles) for part in (helped.results, helped.changed)]
    return (until, *(f"{value:.1f}" for value in measured))


def _ways(people: Sequence[Person]) -> list[tuple[str, ...]]:
    rows: list[tuple[str, ...]] = []
    for way in people[0].helped:
        changes = [[change(person, way, measure) for person in people] for measure in (toggles, seconds)]
        touched = np.mean([mean(person.helped[way].results, contacts) for person in people])
        slow = sum(first_is_slow(person, way) for person in people)
        errors = np.mean([person.helped[way].rmse for person in people], axis=0)
        cells = [f"{np.mean(values):+.0%} ({min(values):+.0%} to {max(values):+.0%})" for values in changes]
        shown = (f"{touched:.2f}", f"{slow} of {len(people)}", f"{errors[0]:.4f}", f"{errors[1]:.4f}")
        rows.append((way, *cells, *shown))
    return rows


def _worst(people: Sequence[Person]) -> list[tuple[str, ...]]:
    rows: list[tuple[str, ...]] = []
    for way in people[0].helped:
        worst = max(people, key=lambda person: change(person, way, seconds))
        slowest = max(worst.helped[way].results, key=seconds)
        given_up = sum(not result.whole for person in people for result in person.helped[way].results)
        told = (f"{change(worst, way, seconds):+.0%}", f"{change(worst, way, toggles):+.0%}")
        slow = f"{slowest.number}: {slowest.time:.1f} s, {slowest.toggles} toggles"
        rows.append((way, worst.name, *told, slow, str(given_up)))
    return rows


def _series(people: Sequence[Person]) -> dict[str, Vector]:
    """One row a circuit; operators and ways by their place, from 1, and 0 for the circuits alone."""
    rows = [
        (who, how, result.number, result.time, result.toggles, result.contacts, result.distance, result.trust)
        for who, person in enumerate(people, 1)
        for how, results in enumerate((person.solo, *(it.results for it in person.helped.values())))
        for result in results
    ]
    names = ("operator", "way", "number", "time_s", "toggles", "contacts", "distance_rad", "trust")
    columns = np.array(rows, dtype=np.float64).reshape(-1, len(names)).T
    return dict(zip(names, columns, strict=True))


WAYS_HEAD = (
    *("assist", "toggles over solo (range)", "time over solo (range)", "contacts a circuit"),
    *("first circuit slow", "shoulder RMSE (rad)", "elbow RMSE (rad)"),
)
WAYS_NOTE = (
    "A first circuit is slow above the solo mean plus one standard deviation. RMSE: of the predictions that "
    "the assist follows, against the ideal ones at its timescale, over the assisted circuits. "
    + " ".join(f"{name}: {told}." for name, told in TOLD.items())
)
WORST_HEAD = ("assist", "worst operator", "time", "toggles", "slowest circuit", "given up")
WORST_NOTE = (
    "Of each assist the operator who lost most time, or gained least, against their own solo circuits."
)
CHANGE_NOTE = (
    "Circuits until one is within 10 % of the time and of the toggles of the assisted circuits before. With "
    "room for both mazes in the joints' limits, the learners' normalisation differs from the other sessions."
)
SETTINGS = (
    Setting("familiarisation", "20 circuits, not recorded", "none: skill is given, not learned"),
    Setting("solo, then assisted", "20 and 20 circuits (appendix B)", "the same, --circuits for others"),
    Setting("speed", "0.2 rad/s; none for the automation", "the same; 0.8 rad/s for the joints"),
    Setting("k of (5.1)", "0.1", "the same, also for dpcc_confident"),
    Setting("timescales", "10, 15, 20 steps", "the same; dpcc_confident at 15"),
    Setting("manual after a toggle", "0.5 s", "the same"),
    Setting("learning", "on throughout", "the same; all assists of an operator begin with the same learners"),
    Setting("walls", "the rod bends and slides", "they do not hold the rod, which may go through them"),
)
SIMULATED = (
    "Simulated operators are checks of the software and no evidence about people. Their margins, trust, "
    "surprise, lenience with walls and confusion were adjusted until the thesis' circuits came out about "
    "right (like the author: seeds 1 and 2 at 10 steps), so that agreement with the thesis confirms nothing; "
    "differences between assists show what the software does with people such as these, no more. The "
    "arm is simulated too; controller, learners and assists are the daemon's."
)
REMARKS = (
    "Each operator does the solo circuits once; every assist begins with that operator, that arm and those "
    "learners as they were then. Only the history traces begin anew, in the rest at the green barrier.",
    "The layout of the maze is ours: the thesis gives the shorter joint's way, the barriers and the rests.",
)

STUDY = Study(
    title="Collaborative control in the angle maze (thesis 5.5, appendix B)",
    about="simulated operators go through an angled corridor, alone and helped",
    run=lambda seed, minutes: run(seed, People()),
    minutes=0.0,
    least_minutes=0.0,
    people=run,
)
