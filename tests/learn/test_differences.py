"""What a snapshot is refused for is said by name."""

from copy import deepcopy

import pytest

from bentod.frames import Value
from bentod.learn.differences import MOST, Sides, differences

QUESTIONS: list[Value] = [
    {"name": "elbow.position@20", "lam": 0.95, "gamma": 0.95, "options": {"eta": 0.1}},
    {"name": "hand.load@20", "lam": 0.95, "gamma": "1 - hand.load", "options": {}},
]
SPEC: dict[str, Value] = {
    "representations": {"arm": {"tilings": 100, "tiles": [{"width": 0.5}]}},
    "questions": QUESTIONS,
    "precision": "float64",
}


def changed(**changes: Value) -> dict[str, Value]:
    return {**deepcopy(SPEC), **changes}


def question(place: int, **changes: Value) -> list[Value]:
    told = deepcopy(QUESTIONS)
    entry = told[place]
    assert isinstance(entry, dict)
    entry.update(changes)
    return told


def test_equal_specifications_have_no_differences_whatever_holds_their_values() -> None:
    assert differences(SPEC, deepcopy(SPEC)) == []
    assert differences({"widths": (1, 2), "x": float("nan")}, {"widths": [1, 2], "x": float("nan")}) == []  # type: ignore[dict-item]


@pytest.mark.parametrize(
    ("theirs", "told"),
    [
        (
            changed(representations={"arm": {"tilings": 64, "tiles": [{"width": 0.5}]}}),
            "representation arm: tilings 100 here, 64 in the snapshot",
        ),
        (
            changed(representations={"arm": {"tilings": 100, "tiles": [{"width": 1.0}]}}),
            "representation arm: tiles.0.width 0.5 here, 1.0 in the snapshot",
        ),
        (
            changed(questions=question(0, lam=0.9)),
            "the question elbow.position@20 is asked with λ 0.95 here, 0.9 in the snapshot",
        ),
        (
            changed(questions=question(1, gamma=0.95)),
            "the question hand.load@20 is asked with γ 1 - hand.load here, 0.95 in the snapshot",
        ),
        (
            changed(questions=question(0, options={})),
            "the question elbow.position@20 is asked with options.eta 0.1 here, nothing in the snapshot",
        ),
        (changed(questions=QUESTIONS[:1]), "the question hand.load@20 is only here"),
        (
            changed(questions=[*QUESTIONS, {"name": "new"}]),
            "the question new is only in the snapshot",
        ),
        (
            changed(questions=QUESTIONS[::-1]),
            "the question elbow.position@20 stands here where hand.load@20 stands in the snapshot",
        ),
        (changed(precision="float32"), "precision: float64 here, float32 in the snapshot"),
    ],
)
def test_a_difference_is_a_sentence_that_names_it(theirs: dict[str, Value], told: str) -> None:
    assert differences(SPEC, theirs) == [told]
    assert differences(theirs, SPEC)


def test_nothing_is_a_specification_too() -> None:
    assert differences({}, {}) == []
    assert "the question elbow.position@20 is only here" in differences(SPEC, {})
    assert "representation arm" not in str(differences({}, {}))


def test_thousands_of_differences_are_not_told_one_by_one() -> None:
    asked: list[Value] = [{"name": f"q{i}"} for i in range(1000)]
    found = differences({"questions": asked}, {}, Sides("in a", "in b"))
    assert len(found) == MOST + 1
    assert found[0] == "the question q0 is only in a"
    assert found[-1] == f"and {1000 - MOST} differences more"


def test_a_long_value_is_cut() -> None:
    (told,) = differences({"x": "a" * 500}, {"x": 1})
    assert len(told) < 150
