"""Indices from stamps: uneven ones are no gaps, held-up samples are no gaps, and gaps are."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from drivers.emg.lsl_stamps import SURE_S, Stamps

RATE_HZ = 1000.0
CHUNK = 10  # samples


def placed(stamps: NDArray[np.float64], rate_hz: float = RATE_HZ) -> list[tuple[int, float, int]]:
    line = Stamps(rate_hz)
    return [line.place(stamps[begin : begin + CHUNK]) for begin in range(0, len(stamps), CHUNK)]


def even(seconds: float, rate_hz: float = RATE_HZ, start: float = 100.0) -> NDArray[np.float64]:
    return start + np.arange(round(seconds * rate_hz)) / rate_hz


def lost(stamps: NDArray[np.float64]) -> int:
    return sum(missing for _, _, missing in placed(stamps))


def test_even_stamps_give_even_indices_and_their_own_times() -> None:
    for number, (first, time, missing) in enumerate(placed(even(2.0))):
        assert (first, missing) == (CHUNK * number, 0)
        assert time == pytest.approx(100.0 + first / RATE_HZ, abs=1e-6)


@settings(max_examples=30)
@given(st.integers(0, 2**32 - 1), st.floats(0, 0.009))
def test_stamps_that_scatter_are_no_gaps(seed: int, scatter: float) -> None:
    stamps = even(2.0) + np.random.default_rng(seed).uniform(0, scatter, round(2.0 * RATE_HZ))
    assert lost(stamps) == 0


@pytest.mark.parametrize("seconds", [0.02, 0.05, 0.25])
def test_samples_that_are_stamped_when_they_arrive_and_were_held_up_are_no_gap(seconds: float) -> None:
    stamps = even(3.0)
    stamps[1000 : 1000 + round(seconds * RATE_HZ)] = 100.0 + 1.0 + seconds
    assert lost(stamps) == 0


@pytest.mark.parametrize("missing", [15, 50, 400])
def test_samples_that_are_missing_are_counted_soon(missing: int) -> None:
    stamps = np.delete(even(3.0), np.s_[1000 : 1000 + missing])
    told = placed(stamps)
    assert sum(lost for _, _, lost in told) == pytest.approx(missing, abs=2)
    noticed = next(number for number, (_, _, lost) in enumerate(told) if lost)
    assert stamps[CHUNK * noticed] - stamps[1000] <= SURE_S + 2 * CHUNK / RATE_HZ
    first, time, _ = told[-1]
    begins = stamps[CHUNK * (len(told) - 1)]
    assert time == pytest.approx(begins, abs=2e-3)
    assert first == pytest.approx((begins - 100.0) * RATE_HZ, abs=2)


def test_every_gap_is_counted_and_indices_never_go_back() -> None:
    stamps = np.delete(even(10.0), [*range(1000, 1040), *range(3000, 3500), *range(7000, 7020)])
    told = placed(stamps)
    assert sum(lost for _, _, lost in told) == pytest.approx(560, abs=4)
    for (first, _, _), (later, _, missing) in pairwise(told):
        assert later == first + CHUNK + missing


@pytest.mark.parametrize("share", [-0.005, 0.005])
def test_a_clock_that_runs_differently_is_followed(share: float) -> None:
    stamps = even(60.0) * (1 + share)
    told = placed(stamps)
    assert sum(lost for _, _, lost in told) == 0
    assert told[-1][1] == pytest.approx(stamps[-CHUNK], abs=2e-3)


def test_a_clock_that_is_set_back_is_followed_at_once() -> None:
    stamps = even(2.0)
    stamps[1000:] -= 5.0
    told = placed(stamps)
    assert (told[-1][0], sum(lost for _, _, lost in told)) == (2000 - CHUNK, 0)
    assert told[-1][1] == pytest.approx(stamps[-CHUNK], abs=2e-3)
