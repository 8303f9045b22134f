"""The table of the thesis' appendix B for any recordings that have trials, and whether conditions differ."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from itertools import combinations

from bentod.analysis.circuits import Circuit
from bentod.analysis.statistics import Description, Test, describe, paired, unpaired

NOT_RECORDED = "not recorded"

METRICS: Mapping[str, Callable[[Circuit], float | None]] = {
    "toggles": lambda circuit: circuit.toggles,
    "time": lambda circuit: circuit.time,
    "contacts": lambda circuit: circuit.contacts,
}
"""What is counted of a circuit; None: it cannot be known."""

UNITS = {"toggles": "toggles", "time": "circuit time, s", "contacts": "contacts"}


@dataclass(frozen=True, slots=True)
class Summary:
    """The circuits of one participant, timescale and condition: a cell of Table B.1."""

    participant: str
    timescale: float  # steps; 0: no assist
    condition: str
    circuits: int  # whole ones
    metrics: Mapping[str, Description | None]  # by name in METRICS; None: not recorded


@dataclass(frozen=True, slots=True)
class Comparison:
    """Two conditions compared by one metric."""

    metric: str
    first: str
    second: str
    within: str  # the participant; empty: across participants, one mean of each in each condition
    test: Test


def summaries(circuits: Iterable[Circuit]) -> list[Summary]:
    """One for each participant, timescale and condition, in the order in which they first appear."""
    groups: dict[tuple[str, float, str], list[Circuit]] = {}
    for circuit in circuits:
        if circuit.whole:
            key = (circuit.participant, circuit.timescale, circuit.condition)
            groups.setdefault(key, []).append(circuit)
    return [
        Summary(*key, len(found), {name: _described(found, name) for name in METRICS})
        for key, found in groups.items()
    ]


def _described(circuits: Sequence[Circuit], metric: str) -> Description | None:
    values = [METRICS[metric](circuit) for circuit in circuits]
    known = [value for value in values if value is not None]
    return describe(known) if len(known) == len(values) else None


def comparisons(circuits: Sequence[Circuit]) -> list[Comparison]:
    """Each pair of conditions by each metric: within each participant, and across them if there are several.

    The thesis tests nothing: it shows means with their standard errors. Across participants, conditions
    are paired; within one, circuits are compared as two samples.
    """
    whole = [circuit for circuit in circuits if circuit.whole]
    conditions = list(dict.fromkeys(circuit.condition for circuit in whole))
    people = list(dict.fromkeys(circuit.participant for circuit in whole))
    found = []
    for first, second in combinations(conditions, 2):
        for metric in METRICS:
            values = {(p, c): _values(whole, metric, p, c) for p in people for c in (first, second)}
            both = [p for p in people if values[p, first] and values[p, second]]
            for person in both:
                test = unpaired(values[person, first], values[person, second])
                found.append(Comparison(metric, first, second, person, test))
            if len(both) > 1:
                means = [[_mean(values[p, condition]) for p in both] for condition in (first, second)]
                found.append(Comparison(metric, first, second, "", paired(*means)))
    return found


def _values(circuits: Sequence[Circuit], metric: str, person: str, condition: str) -> list[float]:
    """Of one person in one condition; empty if one of them is not known."""
    chosen = [c for c in circuits if c.participant == person and c.condition == condition]
    values = [METRICS[metric](circuit) for circuit in chosen]
    return [value for value in values if value is not None] if None not in values else []


def _mean(values: Sequence[float]) -> float:
    return sum(values) / len(values)


HEAD = (
    *("participant", "timescale", "condition", "n"),
    *("toggles", "min (count)", "max", "first"),
    *("time (s)", "fastest", "slowest", "first", "contacts"),
)
"""Columns of Table B.1, one row for each condition; toggles, time and contacts are mean (deviation)."""


def table(found: Sequence[Summary]) -> list[tuple[str, ...]]:
    """The rows of `HEAD` as texts."""
    return [_row(summary) for summary in found]


def _row(summary: Summary) -> tuple[str, ...]:
    toggles, time = summary.metrics["toggles"], summary.metrics["time"]
    return (
        summary.participant,
        f"{summary.timescale:g}" if summary.timescale else "–",
        summary.condition or "(none)",
        str(summary.circuits),
        mean(toggles),
        f"{toggles.minimum:g} ({toggles.minimum_count})" if toggles else NOT_RECORDED,
        f"{toggles.maximum:g}" if toggles else "",
        f"{toggles.first:g}" if toggles else "",
        mean(time),
        f"{time.minimum:.1f}" if time else NOT_RECORDED,
        f"{time.maximum:.1f}" if time else "",
        f"{time.first:.1f}" if time else "",
        mean(summary.metrics["contacts"]),
    )


CIRCUIT_HEAD = ("trial", "name", "condition", "circuit", "time (s)", "toggles", "contacts", "remark")


def circuit_row(circuit: Circuit) -> tuple[str, ...]:
    """The cells of `CIRCUIT_HEAD` as texts."""
    return (
        str(circuit.trial),
        circuit.name,
        circuit.condition or "(none)",
        str(circuit.number),
        f"{circuit.time:.2f}",
        str(circuit.toggles),
        NOT_RECORDED if circuit.contacts is None else str(circuit.contacts),
        circuit.remark,
    )


def mean(described: Description | None) -> str:
    """Mean and sample standard deviation, as the thesis writes them."""
    if described is None:
        return NOT_RECORDED
    deviation = "–" if math.isnan(described.deviation) else f"{round(described.deviation, 9):.3g}"
    return f"{described.mean:.3g} ({deviation})"


def sentence(comparison: Comparison) -> str:
    """A comparison in words."""
    test = comparison.test
    where = comparison.within or f"{test.n} participants, paired"
    kind = f"{'exact' if test.exact else 'sampled'} permutation test"
    return (
        f"{UNITS[comparison.metric]}: {comparison.second or '(none)'} minus {comparison.first or '(none)'} "
        f"= {test.difference:+.3g} ({where}; {kind}, two-sided p = {test.p:.2g}, n = {test.n})"
    )


HOW = (
    "A circuit is a trial, from the tick at which it started to the tick at which it was stopped, or what "
    "lies between two marks `circuit` in it; a trial with a mark `task` has no others. A toggle is a change "
    "of a group's active joint, by whomever. A contact is a mark `contact`: a recording without any, and "
    "without a mark `task`, does not tell how many there were."
)

CAVEAT = (
    "Deviations are of the sample (n − 1). The tests know nothing of order: what a wearer learned from block "
    "to block looks like an effect of the condition. p values are not corrected for how many there are."
)


def as_data(circuits: Sequence[Circuit]) -> dict[str, object]:
    """Everything above as plain data, for JSON; what is not recorded is null."""
    return {
        "circuits": [asdict(circuit) for circuit in circuits],
        "summaries": [asdict(summary) for summary in summaries(circuits)],
        "comparisons": [asdict(comparison) for comparison in comparisons(circuits)],
    }
