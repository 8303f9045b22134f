import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bentod.learn.confidence.guard import Guard, exploding
from tests.learn.confidence.oracles import returns


@settings(max_examples=20)
@given(st.integers(0, 2**32 - 1), st.booleans())
def test_it_is_silent_for_whoever_is_right(seed: int, scaled: bool) -> None:
    rng = np.random.default_rng(seed)
    gammas = np.where(rng.random(120) < 0.05, 0.0, rng.uniform(0.5, 0.99, 120))
    cumulants = np.where(rng.random(120) < 0.5, 1.0, -1.0) * rng.uniform(0, 3)  # nothing new ever comes
    rewards = cumulants * (1 - gammas) if scaled else cumulants
    right = np.nan_to_num(returns(rewards, gammas, np.zeros(120), 0.0))
    guard = Guard(np.zeros(1), slack=1.0 + 1e-9)
    guard.step(np.zeros(1), rewards[[np.argmax(np.abs(rewards) / (1 - gammas))]], float(np.max(gammas)))
    for prediction, reward, gamma in zip(right, rewards, gammas, strict=True):
        assert not guard.step(np.array([prediction]), np.array([reward]), gamma)[0]


def test_one_that_always_answers_the_sum_of_an_endless_reward_is_at_the_bound_and_right() -> None:
    guard = Guard(np.zeros(2), slack=1.0)
    gammas = np.array([0.95, 0.95**3])  # the second misses two ticks of three
    rewards = np.array([1.0, 1 + 0.95 + 0.95**2])
    whole = np.full(2, 1 / (1 - 0.95))
    assert not guard.step(whole * (1 - 1e-12), rewards, gammas).any()
    assert guard.step(whole * (1 + 1e-9), rewards, gammas).all()


def test_a_learner_that_grows_is_caught_within_moments_of_leaving_reason() -> None:
    guard = Guard(np.zeros(1))
    grown = [guard.step(np.array([1.3**t]), np.ones(1) * 0.05, 0.95)[0] for t in range(40)]
    assert grown.index(True) == 18  # 1.3^18 is above 100
    assert all(grown[18:])


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_what_is_no_number_is_told_whatever_the_bound(value: float) -> None:
    for bound in (0.0, 1.0, np.inf):
        np.testing.assert_array_equal(exploding(np.array([value, 0.0]), np.full(2, bound)), [True, False])


def test_where_nothing_can_be_known_nothing_finite_is_told() -> None:
    guard = Guard(np.zeros(3))
    told = guard.step(np.full(3, 1e300), np.array([0.0, 1.0, np.nan]), np.array([0.9, 1.0, 0.9]))
    assert not told.any()


def test_a_first_prediction_is_within_reason_even_if_the_cumulant_rests() -> None:
    guard = Guard(np.array([5.0]))
    assert not guard.step(np.array([5.0]), np.array([1e-6]), 0.95)[0]
    guard.grow(1, 7.0)
    guard.forget(np.array([0, 1]))
    assert not guard.step(np.array([5.0, 7.0]), np.array([1e-6, 1e-6]), 0.95).any()
    guard.take(np.array([1]))
    assert not guard.step(np.array([700.0]), np.array([0.0]), 0.95)[0]
    assert guard.step(np.array([701.0]), np.array([0.0]), 0.95)[0]


def test_a_slack_below_one_is_refused() -> None:
    with pytest.raises(ValueError, match="slack of a guard"):
        Guard(np.zeros(1), 0.5)
