"""Muscles that were lost move nothing until all of them have been seen at rest."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bentod.control.proportional import Site
from bentod.control.rest import LOST_S, REST_S, RestFirst

RATE_HZ = 200.0
REST = round(REST_S * RATE_HZ)  # samples
SITES = [Site("flexor", 0, 2.0, 1.0, 3.0), Site("extensor", 1, 1.0, 1.0, 3.0, release=0.5)]
QUIET, TENSE = (0.5, 0.5), (0.51, 0.5)  # V before gain, at and above what ends an effort


def levels(*rows: tuple[float, float]) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    return np.array(rows, np.float64).reshape(-1, 2)


def lost() -> RestFirst:
    rest = RestFirst(RATE_HZ)
    rest.watch(0.0, "The EMG source broke.", 1)
    rest.watch(0.5, "", 2)
    return rest


def test_muscles_that_were_never_lost_may_move_at_once() -> None:
    rest = RestFirst(RATE_HZ)
    rest.watch(0.0, "", 1)
    assert rest.step(SITES, levels(TENSE)) == ""


def test_muscles_whose_source_was_opened_again_must_rest_first() -> None:
    rest = lost()
    assert rest.step(SITES, levels(*[QUIET] * (REST - 1))) == (
        "EMG is back; it moves nothing until every muscle has been at rest for 0.3 s."
    )
    assert rest.step(SITES, levels(QUIET)) != ""  # the last that is wanted; what comes with it moves nothing
    assert rest.step(SITES, levels(TENSE)) == ""


@pytest.mark.parametrize("row", [TENSE, (0.5, 0.51), (np.nan, 0.5)])
def test_one_muscle_that_is_not_at_rest_begins_the_time_anew(row: tuple[float, float]) -> None:
    rest = lost()
    rest.step(SITES, levels(*[QUIET] * (REST - 1), row, QUIET))
    assert rest.step(SITES, levels(*[QUIET] * (REST - 2)))
    assert rest.step(SITES, levels(QUIET))
    assert rest.step(SITES, levels()) == ""


@pytest.mark.parametrize(("seconds", "waits"), [(LOST_S - 0.01, False), (LOST_S + 0.01, True)])
def test_an_interruption_is_not_a_loss_until_it_has_lasted(seconds: float, waits: bool) -> None:
    rest = RestFirst(RATE_HZ)
    for now, problem in [(0.0, ""), (10.0, "No EMG sample."), (10.5, "EMG is old."), (10.0 + seconds, "")]:
        rest.watch(now, problem, 1)
    assert bool(rest.step(SITES, levels(TENSE))) is waits


def test_an_interruption_while_they_rest_begins_the_time_anew() -> None:
    rest = lost()
    rest.step(SITES, levels(*[QUIET] * (REST - 1)))
    rest.watch(1.0, "No EMG sample.", 2)
    rest.watch(1.1, "", 2)
    rest.step(SITES, levels(*[QUIET] * (REST - 1)))
    assert rest.step(SITES, levels(QUIET))
    assert rest.step(SITES, levels()) == ""


@given(
    st.lists(st.sampled_from([QUIET, QUIET, QUIET, TENSE, (np.nan, 0.5)]), max_size=30),
    st.lists(st.integers(0, 60), max_size=10),
)
def test_how_samples_are_cut_into_steps_makes_no_difference(
    rows: list[tuple[float, float]], cuts: list[int]
) -> None:
    long = levels(*[row for row in rows for _ in range(20)])
    whole, cut = lost(), lost()
    whole.step(SITES, long)
    for piece in np.split(long, np.minimum(np.cumsum(cuts), len(long)) if cuts else []):
        cut.step(SITES, piece)
    assert whole._owed == cut._owed
