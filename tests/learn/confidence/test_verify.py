import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bentod.learn.confidence.verify import TAIL, ReturnError, horizon
from bentod.learn.returns import discount, ideal_predictions
from tests.learn.confidence.oracles import Vector, returns

seeds = st.integers(0, 2**32 - 1)


def signal(steps: int) -> Vector:
    t = np.arange(steps)
    return np.sin(t / 17) + 0.5 * np.sin(t / 5) + 3


def verified(errors: ReturnError, predictions: Vector, rewards: Vector, gammas: Vector) -> Vector:
    """RMSE of a single GVF after every step."""
    steps = zip(predictions, rewards, gammas, strict=True)
    return np.array([errors.step(np.array([p]), np.array([r]), g)[0] for p, r, g in steps])


def noted(errors: ReturnError, predictions: Vector, truth: Vector) -> Vector:
    """Errors of those predictions of which notes are taken."""
    notes = slice(0, None, errors.every)
    return (predictions - truth)[notes]


@settings(max_examples=25)
@given(seeds, st.sampled_from([0.0, 0.5, 0.8, 0.95]), st.integers(1, 20))
def test_the_error_is_that_against_returns_summed_up_one_by_one(seed: int, gamma: float, lanes: int) -> None:
    rng = np.random.default_rng(seed)
    predictions, rewards = rng.normal(size=300), rng.normal(size=300)
    gammas = np.where(rng.random(300) < 0.1, 0.0, gamma)  # now and then something ends
    errors = ReturnError(1, horizon(gamma), lanes, memory=1e12)
    rmse = verified(errors, predictions, rewards, gammas)
    wrong = noted(errors, predictions, returns(rewards, gammas, predictions, TAIL))
    assert rmse[-1] == pytest.approx(np.sqrt(np.nanmean(wrong**2)), rel=1e-9)


@settings(max_examples=8)
@given(seeds)
def test_gvfs_with_a_gamma_each_are_verified_as_if_each_were_alone(seed: int) -> None:
    rng = np.random.default_rng(seed)
    predictions, rewards = rng.normal(size=(2, 250, 3))
    gammas = rng.choice([0.0, 0.7, 0.97], size=(250, 3), p=[0.03, 0.47, 0.5])
    together = ReturnError(3, 120)
    for step in zip(predictions, rewards, gammas, strict=True):
        rmse = together.step(*step)
    for gvf in range(3):
        alone = verified(ReturnError(1, 120), predictions[:, gvf], rewards[:, gvf], gammas[:, gvf])
        assert rmse[gvf] == pytest.approx(alone[-1], rel=1e-12, nan_ok=True)


@pytest.mark.parametrize("timescale", [2.0, 20.0, 80.0])
def test_ideal_predictions_have_no_error_but_what_the_tail_costs(timescale: float) -> None:
    theta = signal(1500)
    gamma = discount(timescale)
    ideal = ideal_predictions(theta, timescale)
    errors = ReturnError(1, horizon(gamma))
    rmse = verified(errors, ideal, (1 - gamma) * theta, np.full(1500, gamma))
    assert np.isnan(rmse[0])
    assert rmse[-1] < 1e-9


def test_a_prediction_that_is_off_by_so_much_has_that_error() -> None:
    theta, gamma = signal(4000), discount(20)
    ideal = ideal_predictions(theta, 20)
    errors = ReturnError(1, horizon(gamma))
    off = verified(errors, ideal + 0.25, (1 - gamma) * theta, np.full(4000, gamma))[-1]
    assert off == pytest.approx(0.25, rel=0.011)  # the tail believes 1 % of the prediction
    assert errors.normalised[0] == pytest.approx(off / np.std(ideal), rel=0.05)
    mean = ReturnError(1, horizon(gamma))
    verified(mean, np.full(4000, np.mean(ideal)), (1 - gamma) * theta, np.full(4000, gamma))
    assert mean.normalised[0] == pytest.approx(1, abs=0.05)


def test_it_is_known_once_the_horizon_has_passed_and_not_before() -> None:
    errors = ReturnError(1, horizon(discount(20)))
    rmse = verified(errors, np.zeros(95), np.ones(95), np.full(95, discount(20)))
    assert horizon(discount(20)) == 90
    assert np.isnan(rmse[:90]).all()
    assert np.isfinite(rmse[90:]).all()


def test_old_errors_are_forgotten_with_the_time_constant() -> None:
    errors = ReturnError(1, 1, memory=100.0)
    verified(errors, np.ones(1000), np.zeros(1000), np.zeros(1000))
    rmse = verified(errors, np.zeros(101), np.zeros(101), np.zeros(101))
    assert rmse[0] == pytest.approx(1)
    assert rmse[100] ** 2 == pytest.approx(np.exp(-1), rel=0.01)


@pytest.mark.parametrize("lost", [np.nan, np.inf])
def test_returns_of_which_a_part_was_not_observed_are_not_verified(lost: float) -> None:
    theta, gamma = signal(400), discount(20)
    ideal, rewards = ideal_predictions(theta, 20), (1 - gamma) * theta
    rewards[200] = lost
    errors = ReturnError(1, horizon(gamma))
    assert verified(errors, ideal, rewards, np.full(400, gamma))[-1] < 1e-9


def test_nothing_is_verified_across_a_cut() -> None:
    theta, gamma = signal(600), discount(20)
    ideal, rewards = ideal_predictions(theta, 20), (1 - gamma) * theta
    errors = ReturnError(1, horizon(gamma))
    verified(errors, ideal[:200], rewards[:200], np.full(200, gamma))
    errors.cut()
    assert verified(errors, ideal[400:], rewards[400:], np.full(200, gamma))[-1] < 1e-9
    uncut = ReturnError(1, horizon(gamma))
    verified(uncut, ideal[:200], rewards[:200], np.full(200, gamma))
    assert verified(uncut, ideal[400:], rewards[400:], np.full(200, gamma))[-1] > 0.01


def test_what_never_ends_is_never_verified() -> None:
    errors = ReturnError(1, horizon(1.0, most=40), lanes=4)
    assert np.isnan(verified(errors, np.zeros(300), np.ones(300), np.ones(300))).all()
    assert verified(errors, np.zeros(1), np.ones(1), np.zeros(1))[0] > 10, "now it has ended"


def test_a_learner_that_is_beyond_all_numbers_leaves_the_average_alone() -> None:
    errors = ReturnError(2, 1)
    for huge in (1.0, 1e200, np.inf, np.nan, 1.0):
        rmse = errors.step(np.array([huge, 1.0]), np.zeros(2), 0.0)
    np.testing.assert_array_equal(rmse, [1, 1])


@pytest.mark.parametrize(("gamma", "ticks"), [(0.0, 1), (0.01, 1), (0.1, 2), (0.9875, 367), (1.0, 54_000)])
def test_a_horizon_is_where_the_rest_weighs_a_hundredth(gamma: float, ticks: int) -> None:
    assert horizon(gamma) == ticks
    if 0 < gamma < 1:
        assert gamma**ticks <= 0.01 * (1 + 1e-12)
        assert gamma ** (ticks - 1) > 0.01 * (1 - 1e-12)


@pytest.mark.parametrize("timescale", range(1, 200, 7))
def test_no_note_of_a_constant_gamma_is_thrown_away(timescale: int) -> None:
    gamma = discount(timescale)
    errors = ReturnError(1, horizon(gamma))
    steps = 3 * horizon(gamma) + 20
    rmse = verified(errors, np.zeros(steps), np.ones(steps), np.full(steps, gamma))
    assert np.isfinite(rmse[horizon(gamma) :]).all()


def test_settings_that_make_no_sense_are_refused() -> None:
    with pytest.raises(ValueError, match="A return needs"):
        ReturnError(1, 0)
