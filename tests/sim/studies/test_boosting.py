"""The study of weak predictors that add up to a strong one, on a shorter run."""

import numpy as np
import pytest

from bentod.learn.returns import ideal_predictions
from sim.studies import boosting
from sim.studies.boosting import AHEAD, LAMBDA, STEP_SIZE, TIMESCALES, coded, poor, primary
from sim.studies.pulses import PERIOD, WIDTH, pulses
from sim.studies.study import Findings


@pytest.fixture(scope="module")
def found() -> Findings:
    return boosting.run(1, 0.5)


def test_weak_predictors_only_chase_and_together_make_a_strong_one(found: Findings) -> None:
    assert [claim.row for claim in found.claims if not claim.holds] == []


def test_every_figure_of_the_thesis_has_its_counterpart(found: Findings) -> None:
    assert [picture.name for picture in found.pictures] == ["4-6", "4-7"]
    assert [len(picture.panels) for picture in found.pictures] == [2, 1]


@pytest.mark.parametrize(("signals", "features"), [(1, 51 + 1), (2, 2 * 51 + 321 + 1), (8, 9397)])
def test_there_are_as_many_features_as_in_the_thesis(signals: int, features: int) -> None:
    assert coded(np.zeros((1, signals))).size == features


def test_signals_are_coded_one_by_one_and_in_pairs_and_the_bias_is_always_on() -> None:
    features = coded(np.random.default_rng(2).random((50, 8)))
    assert features.indices.shape == (50, (8 + 28) * 9 + 1)
    assert (features.indices[:, -1] == 9396).all()
    phis = list(features)
    assert {phi.sum() for phi in phis} == {features.indices.shape[1]}
    assert all(phi[active].all() for phi, active in zip(phis, features.indices, strict=True))


def test_pulses_have_one_size_and_follow_one_another() -> None:
    x1, x2, x3 = pulses(3 * PERIOD).T
    assert x1[:PERIOD].tolist() == [1] * WIDTH + [0] * (PERIOD - WIDTH)
    assert np.array_equal(np.roll(x1, 10), x2)
    assert np.array_equal(np.roll(x1, 20), x3)


def test_a_learner_learns_by_the_equations_of_the_thesis() -> None:
    target = pulses(100)[:, 0]
    gamma = 1 - 1 / 8
    phis = np.column_stack([np.ones(100), target, 1 - target])
    w = e = np.zeros(3)
    expected = []
    for t, phi in enumerate(phis):
        if t:
            e = LAMBDA * gamma * e + STEP_SIZE * phis[t - 1] / max(1, np.count_nonzero(phis[t - 1]))  # (4.3)
            delta = (1 - gamma) * target[t] + gamma * (phi @ w) - phis[t - 1] @ w  # (4.2)
            w = w + delta * e  # (4.4)
        expected.append(w @ phi)
    assert poor(target, target, 8) == pytest.approx(np.array(expected), abs=1e-12)


def test_weak_predictions_are_history_because_they_drift_between_the_edges_of_the_pulse() -> None:
    signals = pulses(20 * PERIOD)
    weak = primary(signals, boosting.OURS)[-PERIOD:]
    off = signals[-PERIOD:, 0] == 0
    assert weak.shape == (PERIOD, 2 * len(TIMESCALES))
    assert len(np.unique(weak[off, TIMESCALES.index(AHEAD)].round(6))) > 20


def test_read_to_the_letter_both_weak_predictors_are_one_and_the_strong_one_is_not(found: Findings) -> None:
    letter = primary(pulses(200), boosting.OTHERS[1])
    assert np.array_equal(letter[:, :4], letter[:, 4:])
    errors = {row[0]: float(row[1]) for row in found.comparison[1:]}
    assert errors[boosting.OTHERS[1].name] > 0.5 > errors[boosting.OTHERS[0].name]


def test_a_chasing_predictor_fails_the_claims_of_the_strong_one() -> None:
    signals = pulses(600)
    weak, ideal = poor(signals[:, 2], signals[:, 2], AHEAD), ideal_predictions(signals[:, 2], AHEAD)
    late = slice(300, 550)
    claims = boosting._strong(weak[late], signals[late, 2], ideal[late])
    assert not any(claim.holds for claim in claims)
