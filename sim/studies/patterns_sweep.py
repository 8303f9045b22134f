"""Table 3.1: the parameters of each feature, tried on windows without a load."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

from sim.movements import Prompted
from sim.studies.patterns import CLASSIFIERS, SEGMENTING, Labelled, generated, random_splits, scores
from sim.studies.patterns_sets import BIAS, SINGLE, Spec

Values = Mapping[str, Sequence[float]]

SEGMENTS = [count for count in range(1, 11) if SEGMENTING.length % count == 0]
"""Those from 1 to 10 that cut 150 samples into equal parts."""

THRESHOLDS = {"threshold_v": (0.1, 0.2)}
ORDERS = {"order": tuple(range(1, 11))}

WHOLE: Mapping[str, Values] = {
    "MAV": {"segments": SEGMENTS},
    "ZC": {"segments": SEGMENTS, **THRESHOLDS},
    "SSC": {"segments": SEGMENTS, **THRESHOLDS},
    "WL": {"segments": SEGMENTS},
    "VAR": {"segments": SEGMENTS},
    "MAVS": {"segments": SEGMENTS[1:]},
    "HIST": {"segments": SEGMENTS, "bins": tuple(range(10, 71, 10))},
    "Ratios": {"segments": SEGMENTS},
    "CC": {"segments": (1, 2, 3), **ORDERS},
    "AR": {"segments": SEGMENTS, **ORDERS},
}

QUICK: Mapping[str, Values] = {
    "MAV": {"segments": (1, 10)},
    "ZC": {"segments": (1, 5), **THRESHOLDS},
    "SSC": {"segments": (1, 5), **THRESHOLDS},
    "WL": {"segments": (1, 5)},
    "VAR": {"segments": (1, 6)},
    "MAVS": {"segments": (2, 5)},
    "HIST": {"segments": (1,), "bins": (10, 70)},
    "Ratios": {"segments": (1, 5)},
    "CC": {"segments": (1,), "order": (2, 4, 10)},
    "AR": {"segments": (1,), "order": (2, 4, 10)},
}


@dataclass(frozen=True, slots=True)
class Tried:
    """One combination of parameters of one feature."""

    feature: str
    spec: Spec
    accuracy: Mapping[str, float]  # by classifier, 0..1


def sweep(person: int, repetitions: int, whole: bool) -> list[Tried]:
    """One 80/20 split of one person for every combination; `whole`: of all values and classifiers."""
    data = generated(Prompted(person=person, session=10 * person, repetitions=repetitions))
    train, test = (data.where(part) for part in next(random_splits(len(data), 1, person)))
    classifiers = tuple(CLASSIFIERS) if whole else ("KNN", "LDA")
    return [
        Tried(feature, spec, _accuracy(train, test, spec, classifiers))
        for feature, values in (WHOLE if whole else QUICK).items()
        for spec in _specs(feature, values)
    ]


def _specs(feature: str, values: Values) -> Iterator[Spec]:
    for chosen in product(*values.values()):
        yield {**SINGLE[feature], **dict(zip(values, chosen, strict=True))}


def _accuracy(train: Labelled, test: Labelled, spec: Spec, classifiers: Sequence[str]) -> dict[str, float]:
    found = scores(train, {"": test}, (spec, BIAS), classifiers)
    return {name: found[name, ""] for name in classifiers}


def rows(tried: Sequence[Tried]) -> tuple[Sequence[str], ...]:
    """A table with a head: each combination, those of Table 3.2 marked."""
    names = list(tried[0].accuracy)
    head = ("feature", "parameters", *names, "mean", "Table 3.2")
    return (head, *(_row(one, names) for one in tried))


def _row(one: Tried, names: Sequence[str]) -> Sequence[str]:
    told = ", ".join(
        f"{key} {value:g}"
        for key, value in one.spec.items()
        if isinstance(value, int | float) and key != "floor_v"
    )
    cells = [f"{100 * one.accuracy[name]:.1f}" for name in names]
    mean = 100 * sum(one.accuracy.values()) / len(names)
    usual = SINGLE[one.feature]
    same = all(value == usual.get(key, 1) for key, value in one.spec.items())
    return (one.feature, told, *cells, f"{mean:.1f}", "yes" if same else "")
