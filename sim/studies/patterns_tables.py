"""What the study of patterns tells as claims and tables."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from bentod.contracts import Vector
from sim.movements import LOADS
from sim.studies import patterns_answers as answers
from sim.studies.patterns import CLASSIFIERS
from sim.studies.patterns_people import RANDOM, REPETITIONS, Key, loaded, mean
from sim.studies.patterns_sets import ALL, SETS, SINGLE, TD, TD_AR
from sim.studies.study import Claim, Listing

People = Sequence[Mapping[Key, float]]
Table = tuple[Sequence[str], ...]

USABLE = 0.9
GAIN = 10.0
"""Points of accuracy under load that our answer is to bring."""


def claims(people: People) -> Iterator[Claim]:
    """What chapter 3 says."""
    value = mean(people, TD, "LDA", RANDOM)
    yield Claim("Fig. 3.4", "TD with LDA, without a load, 80/20", value, "at least", USABLE)
    best = max(mean(people, TD_AR, which, "15 lb") for which in CLASSIFIERS)
    yield Claim("Fig. 3.5a", "TD/AR, 15 lb: the best of four classifiers", best, "at most", USABLE)
    fall = min(_fall(people, TD_AR, which) for which in CLASSIFIERS)
    yield Claim("Fig. 3.5a", "TD/AR, 15 lb: the least fall of four classifiers", fall, "at least", 0.25)
    heavier = mean(people, TD_AR, "LDA", "5 lb") - mean(people, TD_AR, "LDA", "15 lb")
    yield Claim("Fig. 3.5a", "TD/AR with LDA: what 15 lb cost more than 5 lb", heavier, "at least", 0.05)
    best = max(mean(people, ALL, which, load) for which in CLASSIFIERS for load in ("15 lb", "hammer"))
    yield Claim("Fig. 3.5b", "all features, 15 lb and hammer: the best", best, "at most", USABLE)
    yield Claim("Fig. 3.6", "rank of the ratios among ten features, under load", rank(people), "at most", 2)
    fall = min((_fall(people, name, which) for name, which in _good(people)), default=float("nan"))
    yield Claim("Fig. 3.6", "what is usable without a load: least fall at 15 lb", fall, "at least", 0.1)


def _fall(people: People, name: str, which: str) -> float:
    """From no load to 15 lb."""
    return mean(people, name, which, RANDOM) - mean(people, name, which, "15 lb")


def rank(people: People) -> float:
    """Of the ratios among single features by the mean over classifiers and loads; 1 is best."""
    tried = sorted({which for _, which, _ in people[0]})
    means = {name: sum(loaded(people, name, which) for which in tried) for name in SINGLE}
    return 1.0 + sum(value > means["Ratios"] for value in means.values())


def _good(people: People) -> list[tuple[str, str]]:
    return [
        (name, which)
        for name in SINGLE
        for which in CLASSIFIERS
        if mean(people, name, which, RANDOM) >= USABLE
    ]


def answer_claims(choosing: answers.Found, shown: answers.Found) -> Iterator[Claim]:
    """Our answer, on people with whom it was not chosen, against the better of two TD/AR with LDA."""
    name = answers.chosen(choosing)
    gain = 100 * (answers.loaded(shown, name) - usual(shown))
    text = f"'{name}' over TD/AR with LDA, under load, other people: points"
    yield Claim("ours", text, gain, "at least", GAIN)
    cost = 100 * (answers.mean(shown, answers.BASE, LOADS[0]) - answers.mean(shown, name, LOADS[0]))
    yield Claim("ours", f"'{name}': points lost without a load", cost, "at most", 2)


def usual(found: answers.Found) -> float:
    """Accuracy under load of TD/AR with LDA, as in the thesis or without segments, whichever is better."""
    return max(answers.loaded(found, name) for name in (answers.BASE, "TD/AR without segments"))


def comparison(people: People) -> Table:
    """Every set of features and classifier."""
    head = ("features", "classifier", RANDOM, REPETITIONS, *LOADS[1:], "mean under load")
    rows = [
        (
            *(name, which, percent(mean(people, name, which, RANDOM))),
            percent(mean(people, name, which, REPETITIONS))
            if (name, which, REPETITIONS) in people[0]
            else "",
            *(percent(mean(people, name, which, load)) for load in LOADS[1:]),
            percent(loaded(people, name, which)),
        )
        for name in SETS
        for which in CLASSIFIERS
    ]
    return (head, *rows)


def percent(share: float) -> str:
    """With one digit."""
    return f"{100 * share:.1f}"


def answer_listing(choosing: answers.Found, shown: answers.Found) -> Listing:
    """All answers, on both halves of the people."""
    head = ("answer", "chosen on: mean under load", "shown on: mean under load", *LOADS, "over TD/AR + LDA")
    rows = tuple(
        (
            *(name, percent(answers.loaded(choosing, name)), percent(answers.loaded(shown, name))),
            *(percent(answers.mean(shown, name, load)) for load in LOADS),
            f"{100 * (answers.loaded(shown, name) - usual(shown)):+.1f}",
        )
        for name in answers.ANSWERS
    )
    note = (
        f"Chosen: {answers.chosen(choosing)}, the best under load of those that need no memory and lose at "
        "most 2 points without a load, on the people of the second column; all others are of other people."
    )
    return Listing("answers", "Without loaded training data: what helps (% right)", (head, *rows), note)


def harder_listing(found: answers.Found, names: Sequence[str]) -> Listing:
    """Where the assumptions behind the answer are broken."""
    rows = tuple(
        (test, *(percent(answers.mean(found, name, test)) for name in names)) for test in answers.HARDER
    )
    return Listing("harder", "What the answer was not chosen for (% right)", (("test", *names), *rows))


def series(people: People) -> dict[str, Vector]:
    """One row a person, set, classifier and test; all by their place, from 0."""
    tests = (RANDOM, *LOADS[1:])
    rows = [
        (who, *divmod(place, len(CLASSIFIERS)), which, one[name, classifier, test])
        for who, one in enumerate(people)
        for place, (name, classifier) in enumerate((n, c) for n in SETS for c in CLASSIFIERS)
        for which, test in enumerate(tests)
    ]
    columns = np.array(rows, np.float64).T
    return dict(zip(("person", "features", "classifier", "test", "right"), columns, strict=True))
