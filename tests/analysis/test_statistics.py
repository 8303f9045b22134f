"""Exact tests against brute force."""

import math
from itertools import permutations, product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bentod.analysis.statistics import EXACT, describe, paired, unpaired

numbers = st.integers(-20, 20).map(float)


def test_numbers_are_described_as_in_the_thesis_table() -> None:
    found = describe([17.0, 1.0, 1.0, 4.0])
    assert (found.n, found.minimum, found.minimum_count, found.maximum, found.first) == (
        4,
        1.0,
        2,
        17.0,
        17.0,
    )
    assert found.mean == 5.75
    assert found.deviation == pytest.approx(math.sqrt((11.25**2 + 2 * 4.75**2 + 1.75**2) / 3))
    assert found.error == pytest.approx(found.deviation / 2)


def test_a_single_number_has_no_deviation() -> None:
    assert math.isnan(describe([3.0]).deviation)


@settings(max_examples=40, deadline=None)
@given(st.lists(st.tuples(numbers, numbers), min_size=1, max_size=7))
def test_the_paired_test_looks_at_every_choice_of_signs(pairs: list[tuple[float, float]]) -> None:
    first, second = zip(*pairs, strict=True)
    differences = [b - a for a, b in pairs]
    sums = [
        sum(s * d for s, d in zip(signs, differences, strict=True))
        for signs in product((1, -1), repeat=len(pairs))
    ]
    expected = np.mean([abs(one) >= abs(sum(differences)) - 1e-9 for one in sums])
    found = paired(first, second)
    assert found.exact
    assert found.p == pytest.approx(expected)
    assert found.difference == pytest.approx(np.mean(differences))


@settings(max_examples=30, deadline=None)
@given(st.lists(numbers, min_size=1, max_size=4), st.lists(numbers, min_size=1, max_size=3))
def test_the_unpaired_test_looks_at_every_division(first: list[float], second: list[float]) -> None:
    def difference(whole: tuple[float, ...]) -> float:
        return float(np.mean(whole[len(first) :]) - np.mean(whole[: len(first)]))

    observed = difference((*first, *second))
    expected = np.mean(
        [abs(difference(one)) >= abs(observed) - 1e-9 for one in permutations((*first, *second))]
    )
    found = unpaired(first, second)
    assert found.exact
    assert found.p == pytest.approx(expected)
    assert found.difference == pytest.approx(observed)


def test_the_least_p_of_five_pairs_is_one_sixteenth() -> None:
    assert paired([1, 2, 3, 4, 5], [2, 4, 6, 8, 10]).p == 2 / 2**5


def test_too_many_divisions_are_sampled_and_say_so() -> None:
    rows = np.random.default_rng(1).normal(size=(2, 20))
    assert math.comb(40, 20) > EXACT
    same, apart = unpaired(rows[0], rows[0] + 0.001), unpaired(rows[0], rows[1] + 10)
    assert not same.exact
    assert same.p > 0.9
    assert apart.p == 1 / (EXACT + 1)
    assert unpaired(rows[0], rows[1]) == unpaired(rows[0], rows[1])


def test_sampled_p_values_are_near_the_exact_ones() -> None:
    first, second = np.arange(18.0), np.arange(18.0) + np.tile([2.0, -1.0, 0.5], 6)
    exact = sum(abs(one) >= abs((second - first).sum()) - 1e-9 for one in _sign_sums(second - first)) / 2**18
    found = paired(first.tolist(), second.tolist())
    assert not found.exact
    assert found.p == pytest.approx(exact, abs=0.005)


def _sign_sums(differences: np.ndarray) -> np.ndarray:
    sums = np.zeros(1)
    for one in differences:
        sums = np.concatenate([sums + one, sums - one])
    return sums
