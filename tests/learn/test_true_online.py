from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bentod.contracts import Learner
from bentod.learn.true_online import TrueOnlineTD
from tests.learn import oracles
from tests.learn.oracles import Stream, Vector

SIZE = 12
Rule = Callable[[Stream, Vector, float, float], list[Vector]]
unit = st.floats(0, 1)
seeds = st.integers(0, 2**32 - 1)


def random_stream(seed: int, steps: int = 40, alpha: float | None = 0.1) -> Stream:
    """Binary features and normal rewards; α None: a new step size for every step."""
    rng = np.random.default_rng(seed)
    phis = [(rng.random(SIZE) < 0.4).astype(np.float64) for _ in range(steps + 1)]
    alphas = rng.uniform(0.01, 0.15, steps) if alpha is None else np.full(steps, alpha)
    return Stream(phis, rng.normal(size=steps).tolist(), alphas.tolist())


def start(seed: int) -> Vector:
    return np.full(SIZE, np.random.default_rng(seed + 1).normal())


def indices(phi: Vector) -> np.ndarray[tuple[int], np.dtype[np.intp]]:
    return np.flatnonzero(phi)


def learn(learner: Learner, stream: Stream) -> list[float]:
    """P_0 … P_T of the learner's first GVF."""
    rewards = [0.0, *stream.rewards]
    return [
        float(learner.step(indices(phi), [reward])[0])
        for phi, reward in zip(stream.phis, rewards, strict=True)
    ]


def furthest(ours: list[Vector], theirs: list[Vector]) -> float:
    return float(np.max(np.abs(np.array(ours) - np.array(theirs))))


@given(seeds, unit, unit, st.floats(0.001, 0.15))
def test_the_engine_computes_5_2_to_5_4(seed: int, gamma: float, lam: float, alpha: float) -> None:
    stream = random_stream(seed, steps=150, alpha=alpha)
    learner = TrueOnlineTD(SIZE, [start(seed)[0]], gamma, lam, alpha)
    predictions = learn(learner, stream)
    ws = oracles.equations_5_2_to_5_4(stream, start(seed), gamma, lam)
    np.testing.assert_allclose(learner.weights[:, 0], ws[-1], rtol=1e-10, atol=1e-10)
    expected = [w @ phi for w, phi in zip(ws, stream.phis, strict=True)]
    np.testing.assert_allclose(predictions, expected, rtol=1e-10, atol=1e-10)


@given(seeds, unit, unit)
def test_gvfs_in_a_group_learn_as_if_each_were_alone(seed: int, gamma: float, lam: float) -> None:
    streams = [random_stream(seed), random_stream(seed)]
    rewards = np.random.default_rng(seed + 2).normal(size=(40, 2))
    together = TrueOnlineTD(SIZE, [0.5, -2.0], gamma, lam, 0.1)
    for phi, reward in zip(streams[0].phis, [[0.0, 0.0], *rewards.tolist()], strict=True):
        together.step(indices(phi), reward)
    for gvf, first_weight in enumerate([0.5, -2.0]):
        alone = Stream(streams[gvf].phis, rewards[:, gvf].tolist(), streams[gvf].alphas)
        ws = oracles.equations_5_2_to_5_4(alone, np.full(SIZE, first_weight), gamma, lam)
        np.testing.assert_allclose(together.weights[:, gvf], ws[-1], rtol=1e-10, atol=1e-10)


@pytest.mark.parametrize("alpha", [0.1, None], ids=["constant step size", "varying step size"])
@given(seeds, unit, unit)
def test_algorithm_1_and_5_2_to_5_4_are_one_rule(
    alpha: float | None, seed: int, gamma: float, lam: float
) -> None:
    stream, w = random_stream(seed, alpha=alpha), start(seed)
    ours = oracles.equations_5_2_to_5_4(stream, w, gamma, lam)
    assert furthest(ours, oracles.algorithm_1(stream, w, gamma, lam)) < 1e-10


@pytest.mark.parametrize("alpha", [0.1, None], ids=["constant step size", "varying step size"])
@given(seeds, unit, unit)
def test_the_rule_equals_the_forward_view_at_every_step(
    alpha: float | None, seed: int, gamma: float, lam: float
) -> None:
    stream, w = random_stream(seed, steps=12, alpha=alpha), start(seed)
    ours = oracles.equations_5_2_to_5_4(stream, w, gamma, lam)
    assert furthest(ours, oracles.online_lambda_return(stream, w, gamma, lam)) < 1e-10


@given(seeds, unit, unit)
def test_a_step_size_outside_the_trace_agrees_while_it_is_constant(
    seed: int, gamma: float, lam: float
) -> None:
    stream, w = random_stream(seed), start(seed)
    ours = oracles.equations_5_2_to_5_4(stream, w, gamma, lam)
    assert furthest(ours, oracles.step_size_outside_the_trace(stream, w, gamma, lam)) < 1e-10


def test_a_step_size_outside_the_trace_differs_once_it_varies() -> None:
    stream, w = random_stream(1, alpha=None), start(1)
    ours = oracles.equations_5_2_to_5_4(stream, w, 0.95, 0.9)
    assert furthest(ours, oracles.step_size_outside_the_trace(stream, w, 0.95, 0.9)) > 0.01


@pytest.mark.parametrize("rule", [oracles.mixed_forms, oracles.late_v_old])
def test_mixing_the_two_forms_gives_another_rule(rule: Rule) -> None:
    stream, w = random_stream(1), start(1)
    ours = oracles.equations_5_2_to_5_4(stream, w, 0.95, 0.9)
    assert furthest(ours, rule(stream, w, 0.95, 0.9)) > 0.01


@given(seeds, unit, unit)
def test_after_a_cut_it_learns_as_a_new_learner_with_the_old_weights(
    seed: int, gamma: float, lam: float
) -> None:
    before, after = random_stream(seed), random_stream(seed + 7)
    learner = TrueOnlineTD(SIZE, [start(seed)[0]], gamma, lam, 0.1)
    learn(learner, before)
    kept = learner.weights[:, 0].copy()
    learner.cut()
    np.testing.assert_array_equal(learner.weights[:, 0], kept)
    learn(learner, after)
    ws = oracles.algorithm_1(after, kept, gamma, lam)
    np.testing.assert_allclose(learner.weights[:, 0], ws[-1], rtol=1e-9, atol=1e-9)


def test_the_first_step_after_a_cut_only_predicts() -> None:
    learner = TrueOnlineTD(3, [1.0], 0.9, 0.9, 0.1)
    for _ in range(2):
        assert learner.step(np.array([0, 2]), [50.0]).tolist() == [2.0]
        learner.cut()


def test_a_step_without_features_changes_nothing_it_should_not() -> None:
    learner = TrueOnlineTD(3, [0.0], 0.9, 0.9, 0.5)
    learner.step(np.array([0]), [0.0])
    assert learner.step(np.array([], dtype=np.intp), [1.0]).tolist() == [0.0]
    assert learner.weights[:, 0].tolist() == [0.5, 0.0, 0.0]


def test_a_cumulant_that_is_not_finite_teaches_only_its_own_gvf_nothing() -> None:
    learner = TrueOnlineTD(3, [0.0, 0.0], 0.9, 0.9, 0.5)
    learner.step(np.array([0]), [0.0, 0.0])
    learner.step(np.array([1]), [float("nan"), 1.0])
    assert learner.weights.T.tolist() == [[0.0, 0.0, 0.0], [0.5, 0.0, 0.0]]
    assert learner.resets.tolist() == [0, 0]


def test_a_gvf_that_overflows_starts_again_and_the_others_do_not() -> None:
    learner = TrueOnlineTD(3, [-1.0, 0.0], 1.0, 1.0, 1.0)
    learner.step(np.array([0]), [0.0, 0.0])
    for _ in range(8):
        prediction = learner.step(np.array([0, 1]), [1.7e308, 1.0])
        assert np.isfinite(prediction).all()
    assert learner.resets[0] > 0
    assert learner.resets[1] == 0
    assert np.isfinite(learner.weights).all()


def test_a_gvf_that_started_again_learns_again() -> None:
    learner = TrueOnlineTD(2, [0.25], 0.5, 0.9, 0.3)
    features = np.array([0, 1])
    while learner.resets[0] == 0:
        learner.step(features, [1.7e308])
    assert learner.step(features, [float("nan")]).tolist() == [0.5]
    for _ in range(200):
        prediction = learner.step(features, [0.5])
    assert prediction[0] == pytest.approx(1.0)


def test_a_gvf_whose_weights_went_bad_starts_again_only_once() -> None:
    learner = TrueOnlineTD(3, [0.25], 0.9, 0.9, 0.3)
    features = np.array([0, 1])
    learner.step(features, [0.1])
    learner._w[0, 1] = np.nan
    for _ in range(5):
        assert np.isfinite(learner.step(features, [0.1])).all()
    assert learner.resets[0] == 1


def test_a_trace_gone_bad_is_cleared_so_that_learning_can_go_on() -> None:
    learner = TrueOnlineTD(3, [0.25], 0.9, 0.9, 0.3)
    learner.step(np.array([0, 1]), [0.1])
    learner._e[1] = np.inf
    for _ in range(5):
        learner.step(np.array([0, 1]), [0.1])
    assert learner.resets[0] == 1
    assert np.isfinite(learner.weights).all()


def test_a_caller_may_change_the_predictions_it_was_given() -> None:
    learner, undisturbed = TrueOnlineTD(3, [0.25], 0.9, 0.9, 0.3), TrueOnlineTD(3, [0.25], 0.9, 0.9, 0.3)
    for features in ([0, 1], [1, 2], [0, 2], [1, 2]):
        learner.step(np.array(features), [1.0]).fill(99)
        undisturbed.step(np.array(features), [1.0])
    assert learner.weights.tolist() == undisturbed.weights.tolist()


def test_a_trace_that_fades_never_becomes_subnormal() -> None:
    learner = TrueOnlineTD(4, [0.0], 0.9, 0.9, 0.3)
    learner.step(np.array([0]), [1.0])
    for _ in range(4000):
        learner.step(np.array([1]), [1.0])
    assert learner._e[0] == 0


def test_the_weights_cannot_be_changed_from_outside() -> None:
    learner = TrueOnlineTD(4, [0.0], 0.9, 0.9, 0.3)
    with pytest.raises(ValueError, match="read-only"):
        learner.weights[0, 0] = 1


@pytest.mark.parametrize(("gamma", "lam", "alpha"), [(1.1, 0, 0.1), (0, -0.1, 0.1), (0, 0, 0), (0, 0, 2)])
def test_parameters_out_of_range_are_refused(gamma: float, lam: float, alpha: float) -> None:
    with pytest.raises(ValueError, match="must be 0 to 1"):
        TrueOnlineTD(4, [0.0], gamma, lam, alpha)
