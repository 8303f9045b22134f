import math

import numpy as np
import pytest

from bentod.learn.confidence.visits import Visit, Visits

BIAS = 9


def state(*features: int) -> np.ndarray[tuple[int], np.dtype[np.intp]]:
    return np.array([*features, BIAS], dtype=np.intp)


def test_the_curves_are_the_sum_and_the_least_of_what_was_counted_before() -> None:
    visits = Visits(10, [BIAS])
    for features in [state(0, 1), state(0, 1), state(1, 2)]:
        visits.step(features)
    visit = visits.step(state(1, 2))
    assert (visit.total, visit.mean, visit.least) == (4, 2.0, 1)
    np.testing.assert_array_equal(visits.counts, [2, 4, 2, 0, 0, 0, 0, 0, 0, 4])


def test_a_state_is_the_more_familiar_the_longer_one_was_there() -> None:
    visits = Visits(10, [BIAS])
    told = [visits.step(state(0, 1) if t % 2 else state(2, 3)).familiarity for t in range(400)]
    assert told[0] == told[1] == 0
    assert np.all(np.diff(told[1::2]) > 0)
    assert told[61] == pytest.approx(0.5)
    assert visits.step(state(0, 3)).familiarity > 0.8
    assert visits.step(state(0, 5)).familiarity < 0.4 < 0.9
    assert visits.step(state(7, 8)).familiarity == 0


@pytest.mark.parametrize("apart", [[], [BIAS]])
def test_a_feature_that_is_always_active_makes_nothing_familiar(apart: list[int]) -> None:
    visits = Visits(10, apart)
    for _ in range(1000):
        visits.step(state(0, 1))
    assert visits.step(state(2, 3)).familiarity < 0.001


def test_a_state_was_last_visited_no_later_than_its_longest_missing_feature() -> None:
    visits = Visits(10, [BIAS])
    assert visits.step(state(0, 1)).since == math.inf
    assert visits.step(state(0, 1)).since == 1
    visits.step(state(0, 2))
    visits.step(state(3, 4), ticks=5)
    assert visits.step(state(0, 1)).since == 7  # 0 was seen 6 ticks ago, 1 before that
    assert visits.step(state(0, 5)).since == math.inf


def test_a_state_of_which_nothing_is_to_be_counted_is_never_familiar() -> None:
    assert Visits(10, [BIAS]).step(state()) == Visit(0, 0.0, 0, 0.0, math.inf)


def test_what_is_recalled_counts_on() -> None:
    old, new = Visits(10, [BIAS]), Visits(10, [BIAS])
    for features in [state(0, 1), state(1, 2)]:
        old.step(features)
    new.recall(old.memory())
    old.step(state(1, 3))
    assert new.step(state(1, 3)).least == 0
    assert new.step(state(1, 2)) == old.step(state(1, 2))
    with pytest.raises(ValueError, match="'counts' has the shape"):
        Visits(11).recall(old.memory())


@pytest.mark.parametrize(("apart", "half"), [([10], 30.0), ([-1], 30.0), ([], 0.0)])
def test_settings_that_make_no_sense_are_refused(apart: list[int], half: float) -> None:
    with pytest.raises(ValueError, match="Visits need"):
        Visits(10, apart, half)
