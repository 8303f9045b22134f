"""Measures of predictions, on signals whose answers are plain."""

import math

import numpy as np
import pytest

from sim.studies.measures import best_of_present, correlation, lead, nrmse, settled

WAVE = np.sin(np.arange(400) / 9.0)


def test_the_best_constant_has_an_error_of_1() -> None:
    assert nrmse(np.full(400, WAVE.mean()), WAVE) == pytest.approx(1)
    assert nrmse(WAVE, WAVE) == 0


def test_what_never_changes_cannot_be_compared_with() -> None:
    assert math.isnan(nrmse(WAVE, np.ones(400)))
    assert math.isnan(correlation(WAVE, np.ones(400)))


@pytest.mark.parametrize("ahead", [-7, 0, 5])
def test_a_shifted_signal_leads_by_as_much_as_it_was_shifted(ahead: int) -> None:
    assert lead(np.roll(WAVE, -ahead), WAVE, 12) == ahead


def test_of_shifts_that_are_equally_alike_the_least_counts() -> None:
    period = np.tile([1.0, 0.0, 0.0, 0.0], 50)
    assert lead(period, period, 8) == 0


def test_the_best_that_the_present_tells_is_the_mean_of_all_steps_that_look_alike() -> None:
    seen = np.array([[0, 0], [0, 1], [0, 0], [1, 1], [0, 1]], dtype=np.float64)
    ideal = np.array([1.0, 2.0, 3.0, 7.0, 4.0])
    assert best_of_present(seen, ideal).tolist() == [2, 3, 2, 7, 3]


def test_errors_are_taken_late_but_not_where_returns_are_not_known() -> None:
    assert settled(1000, 0.2, 10) == slice(800, 950)
