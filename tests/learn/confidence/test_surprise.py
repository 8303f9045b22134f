import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bentod.learn.confidence.surprise import Surprise
from tests.learn.confidence.oracles import Vector


def weighted(deltas: Vector, rate: float) -> tuple[float, float]:
    """Mean and variance with weights that fall by 1 − β a step, by direct summation."""
    weights = (1 - rate) ** np.arange(len(deltas))[::-1]
    mean = float(np.average(deltas, weights=weights))
    return mean, float(np.average((deltas - mean) ** 2, weights=weights))


@settings(max_examples=25)
@given(st.integers(0, 2**32 - 1), st.floats(0.05, 0.9), st.floats(0.001, 0.05), st.floats(-1e4, 1e4))
def test_z_is_6_1_with_weights_that_fall_exponentially(
    seed: int, rate: float, slow_rate: float, offset: float
) -> None:
    deltas = np.random.default_rng(seed).normal(offset, 1.0, 30)
    surprise = Surprise(1, rate, slow_rate)
    for t, delta in enumerate(deltas):
        z = surprise.step(np.array([delta]))
        if t:
            expected = abs(weighted(deltas[: t + 1], rate)[0])
            expected /= np.sqrt(weighted(deltas[: t + 1], slow_rate)[1])
            assert z[0] == pytest.approx(expected, rel=1e-6)


def test_noise_that_was_always_there_does_not_surprise_but_a_bias_does() -> None:
    noise = np.random.default_rng(0).normal(size=6000)
    surprise = Surprise(1)
    calm = [surprise.step(noise[t : t + 1])[0] for t in range(5000)]
    assert np.sqrt(np.mean(np.square(calm[500:]))) == pytest.approx(0.13, abs=0.02)
    startled = [surprise.step(noise[t : t + 1] + 2)[0] for t in range(5000, 5060)]
    assert max(calm[500:]) < 0.6 < 1.5 < startled[-1]


def test_one_error_that_stands_out_is_seen_at_once() -> None:
    surprise = Surprise(1)
    for t in range(600):
        surprise.step(np.array([0.01 * (-1) ** t]))
    assert surprise.step(np.array([1.0]))[0] > 0.6
    one_rate = Surprise(1, 1 / 30, 1 / 30)
    for t in range(600):
        one_rate.step(np.array([0.01 * (-1) ** t]))
    assert one_rate.step(np.array([1.0]))[0] < 0.2, "what the slow rate is for"


def test_a_step_that_taught_nothing_changes_nothing() -> None:
    surprise, told = Surprise(2), Surprise(2)
    for delta in ([1.0, 2.0], [0.5, -1.0], [3.0, 1.0]):
        surprise.step(np.array(delta))
        told.step(np.array(delta))
    before = surprise.value
    after = surprise.step(np.array([np.nan, 1.0]))
    told.step(np.array([np.inf, 1.0]))
    assert after[0] == before[0]
    assert after[1] != before[1]
    np.testing.assert_array_equal(told.value, after)


def test_errors_without_any_variance_do_not_surprise() -> None:
    surprise = Surprise(1)
    assert surprise.value[0] == 0
    assert all(surprise.step(np.array([0.3]))[0] == 0 for _ in range(100))


@pytest.mark.parametrize(("rate", "slow_rate"), [(0.1, 0.2), (1.1, 0.1), (0.1, 0.0)])
def test_rates_that_make_no_sense_are_refused(rate: float, slow_rate: float) -> None:
    with pytest.raises(ValueError, match="Surprise needs rates"):
        Surprise(1, rate, slow_rate)
