"""The table of the thesis' appendix B, and comparisons of conditions."""

from dataclasses import replace

import pytest

from bentod.analysis.circuits import Circuit
from bentod.analysis.tasks import NOT_RECORDED, as_data, circuit_row, comparisons, sentence, summaries, table

ONE = Circuit("s", "A", 20.0, "solo", 1, "maze", 1, 0.0, 27.0, 15, None, True, "")


def circuits(person: str, condition: str, *counted: tuple[int, float]) -> list[Circuit]:
    return [
        replace(ONE, participant=person, condition=condition, trial=number, toggles=toggles, time=time)
        for number, (toggles, time) in enumerate(counted, 1)
    ]


SOLO = circuits("A", "solo", (14, 27.0), (16, 24.6), (14, 35.2))
DPCC = circuits("A", "dpcc", (17, 37.5), (1, 15.7), (1, 16.0))


def test_a_row_reads_like_table_b_1() -> None:
    solo, dpcc = table(summaries([*SOLO, *DPCC]))
    assert solo == (
        *("A", "20", "solo", "3"),
        *("14.7 (1.15)", "14 (2)", "16", "14"),
        *("28.9 (5.56)", "24.6", "35.2", "27.0", NOT_RECORDED),
    )
    assert dpcc[4:8] == ("6.33 (9.24)", "1 (2)", "17", "17")


def test_circuits_without_an_end_do_not_count() -> None:
    (summary,) = summaries([*SOLO, replace(ONE, whole=False, toggles=900)])
    assert summary.circuits == 3
    assert summary.metrics["toggles"] is not None
    assert summary.metrics["toggles"].maximum == 16


def test_contacts_are_described_only_if_they_are_known_of_every_circuit() -> None:
    known = [replace(circuit, contacts=number) for number, circuit in enumerate(SOLO)]
    (all_known,) = summaries(known)
    (some,) = summaries([*known, SOLO[0]])
    assert all_known.metrics["contacts"] is not None
    assert all_known.metrics["contacts"].mean == 1.0
    assert some.metrics["contacts"] is None
    assert NOT_RECORDED in circuit_row(SOLO[0])
    assert circuit_row(known[0])[6] == "0"


def test_conditions_of_one_person_are_two_samples() -> None:
    found = {one.metric: one for one in comparisons([*SOLO, *DPCC])}
    assert set(found) == {"toggles", "time"}  # of contacts nothing is known
    assert found["time"].within == "A"
    assert found["time"].test.difference == pytest.approx((37.5 + 15.7 + 16.0 - 27.0 - 24.6 - 35.2) / 3)
    assert found["time"].test.n == 6


def test_several_persons_are_compared_in_pairs() -> None:
    people = [
        circuit
        for person, gain in (("A", 3), ("B", 5), ("C", 4))
        for circuit in (*circuits(person, "solo", (10, 20.0)), *circuits(person, "dpcc", (10 - gain, 20.0)))
    ]
    (across,) = [one for one in comparisons(people) if one.metric == "toggles" and not one.within]
    assert across.test.difference == -4.0
    assert (across.test.n, across.test.p, across.test.exact) == (3, 0.25, True)
    assert "3 participants, paired" in sentence(across)
    assert "dpcc minus solo = -4" in sentence(across)


def test_who_lacks_a_condition_is_in_no_pair() -> None:
    people = [*SOLO, *DPCC, *circuits("B", "solo", (10, 20.0))]
    assert {one.within for one in comparisons(people)} == {"A"}


def test_a_single_condition_is_compared_with_nothing() -> None:
    assert comparisons(SOLO) == []


def test_data_for_programs_says_null_where_nothing_is_known() -> None:
    told = as_data(SOLO)
    assert told["circuits"][0]["contacts"] is None  # type: ignore[index]
    assert told["summaries"][0]["metrics"]["toggles"]["minimum_count"] == 2  # type: ignore[index]
