import tracemalloc

import numpy as np
import pytest
from hypothesis import assume, given, settings

from bentod.learn.group import Group
from bentod.learn.kernel import Kernel, choose
from bentod.learn.lazy import Algorithm, Real
from bentod.learn.lazy_compiled import missing
from bentod.learn.lazy_numpy import NumpyKernel
from bentod.learn.returns import ideal_predictions
from tests.learn import oracles
from tests.learn.journeys import (
    ALPHA,
    SIZE,
    Journeys,
    Seen,
    algorithms,
    follow,
    new_group,
    random_journeys,
    seeds,
)

KERNELS = [NumpyKernel(), *([] if missing() else [choose("compiled")])]
WEIGHTS = [(np.float64, 1e-8), (np.float32, 1e-3)]
BOTH: list[Algorithm] = ["td", "true_online"]

kernels = pytest.mark.parametrize("kernel", KERNELS, ids=lambda kernel: kernel.name.split()[0])
precisions = pytest.mark.parametrize(("dtype", "tolerance"), WEIGHTS, ids=["float64", "float32"])
rules = pytest.mark.parametrize("algorithm", BOTH)


def agrees(seen: Seen, journeys: Journeys, algorithm: Algorithm, tolerance: float) -> None:
    """Each GVF with the dense learner of its own, in units of the greatest number that this one meets."""
    for gvf in range(len(journeys.initial)):
        told = journeys.oracle(algorithm, gvf)
        values = [w @ phi for w, phi in zip(told.ws, journeys.phis, strict=True)]
        scale = max(1.0, np.abs(values).max(), np.abs(told.ws).max())
        close = {"rtol": 0, "atol": tolerance * scale}
        np.testing.assert_allclose(seen.predictions[:, gvf], values, **close)
        np.testing.assert_allclose(seen.deltas[:, gvf], told.deltas, **close)
        np.testing.assert_allclose(seen.weights[:, gvf], told.ws[-1], **close)
        np.testing.assert_allclose(seen.trace, told.zs[-1], rtol=0, atol=1e-8 * np.abs(told.zs).max())


def calm(journeys: Journeys, algorithm: Algorithm) -> bool:
    """Whether dense learners stay small; with accumulating traces near γλ = 1 not all do: a group resets."""
    told = [journeys.oracle(algorithm, gvf) for gvf in range(len(journeys.initial))]
    return all(float(np.abs(one.ws).max()) < 20 for one in told)


@kernels
@precisions
@settings(max_examples=25)
@given(seed=seeds, algorithm=algorithms)
def test_a_group_learns_what_dense_learners_of_one_gvf_each_do(
    kernel: Kernel, dtype: type[Real], tolerance: float, seed: int, algorithm: Algorithm
) -> None:
    journeys = random_journeys(seed)
    assume(calm(journeys, algorithm))
    agrees(follow(new_group(journeys, algorithm, kernel, dtype), journeys), journeys, algorithm, tolerance)


@kernels
@precisions
@rules
@pytest.mark.parametrize(("gamma", "lam"), [(1e-8, 1.0), (0.05, 0.9), (0.9, 0.9), (0.999, 1.0), (1.0, 0.999)])
def test_it_stays_exact_from_epoch_to_epoch(
    kernel: Kernel, dtype: type[Real], tolerance: float, algorithm: Algorithm, gamma: float, lam: float
) -> None:
    rng = np.random.default_rng(4)
    steps = 500
    # One feature at a time: with accumulating traces and λ near 1, more would diverge, in the oracle too.
    phis = np.eye(SIZE, dtype=np.bool_)[rng.integers(0, SIZE, steps)]
    gammas, lams = np.full(steps, gamma), np.full(steps, lam)
    gammas[::97] = 0.5
    rewards = rng.normal(size=(steps, 2)) * (1 - gamma)
    journeys = Journeys(phis, rewards, gammas, lams, np.array([0.0, 1.0]))
    agrees(follow(new_group(journeys, algorithm, kernel, dtype), journeys), journeys, algorithm, tolerance)


@kernels
@settings(max_examples=10)
@given(seed=seeds)
def test_true_online_is_the_forward_view_at_every_step(kernel: Kernel, seed: int) -> None:
    rng = np.random.default_rng(seed)
    steps, gamma, lam = 12, rng.random(), rng.random()
    phis = rng.random((steps, SIZE)) < 0.4
    rewards = rng.normal(size=(steps, 1))
    journeys = Journeys(phis, rewards, np.full(steps, gamma), np.full(steps, lam), rng.normal(size=1))
    dense = list(phis.astype(np.float64))
    stream = oracles.Stream(dense, rewards[1:, 0].tolist(), [ALPHA] * (steps - 1))
    forward = oracles.online_lambda_return(stream, np.full(SIZE, journeys.initial[0]), gamma, lam)
    group = new_group(journeys, "true_online", kernel, np.float64)
    for t, w in enumerate(forward):
        follow(group, journeys, t, t + 1)
        np.testing.assert_allclose(group.weights_now()[:, 0], w, rtol=0, atol=1e-10)


@rules
def test_equal_gvfs_have_equal_answers(algorithm: Algorithm) -> None:
    journeys = random_journeys(3, gvfs=4)
    journeys.rewards[:] = journeys.rewards[:, :1]
    journeys.initial[:] = 0.5
    predictions = follow(new_group(journeys, algorithm, choose(), np.float64), journeys).predictions
    assert (predictions == predictions[:, :1]).all()


@kernels
@rules
def test_after_a_cut_it_learns_as_a_new_group_with_the_old_weights(
    kernel: Kernel, algorithm: Algorithm
) -> None:
    for seed in range(12):
        journeys = random_journeys(seed)
        group = new_group(journeys, algorithm, kernel, np.float64)
        follow(group, journeys, end=40)
        kept = group.weights_now()
        group.cut()
        np.testing.assert_allclose(group.weights_now(), kept, rtol=0, atol=1e-9)
        assert not group.trace_now().any()
        other = new_group(journeys, algorithm, kernel, np.float64)
        other.set_weights(range(len(journeys.initial)), kept)
        mine, theirs = follow(group, journeys, first=40), follow(other, journeys, first=40)
        assert np.isnan(mine.deltas[0]).all()
        np.testing.assert_allclose(mine.predictions, theirs.predictions, rtol=0, atol=1e-9)
        np.testing.assert_allclose(mine.weights, theirs.weights, rtol=0, atol=1e-9)


@kernels
@precisions
@rules
def test_what_is_recalled_goes_on_where_it_was(
    kernel: Kernel, dtype: type[Real], tolerance: float, algorithm: Algorithm
) -> None:
    for seed in range(10):
        journeys = random_journeys(seed)
        told, recalled = (
            new_group(journeys, algorithm, choose(), np.float64),
            new_group(journeys, algorithm, kernel, dtype),
        )
        follow(told, journeys, end=31)
        follow(recalled, journeys, end=seed)  # whatever it was doing before
        recalled.recall(told.memory())
        for name, array in recalled.memory().items():
            np.testing.assert_allclose(array, told.memory()[name], rtol=tolerance, atol=tolerance)
        mine, theirs = follow(recalled, journeys, first=31), follow(told, journeys, first=31)
        np.testing.assert_allclose(mine.predictions, theirs.predictions, rtol=tolerance, atol=tolerance)


def test_a_group_that_was_cut_is_recalled_as_one() -> None:
    journeys = random_journeys(2)
    told, recalled = (new_group(journeys, "true_online", choose(), np.float64) for _ in range(2))
    follow(told, journeys, end=20)
    told.cut()
    recalled.recall(told.memory())
    assert np.isnan(follow(recalled, journeys, 20, 21).deltas).all()


@pytest.mark.parametrize("name", ["weights", "trace", "v", "v_old", "features", "resets", "peak", "reach"])
def test_a_memory_that_does_not_fit_is_refused_and_changes_nothing(name: str) -> None:
    journeys = random_journeys(2)
    group = new_group(journeys, "td", choose(), np.float64)
    follow(group, journeys, end=20)
    memory = group.memory()
    memory[name] = np.append(memory[name].ravel(), SIZE)
    with pytest.raises(ValueError, match="of this size"):
        group.recall(memory)
    del memory[name]
    with pytest.raises(ValueError, match="of this size"):
        group.recall(memory)
    np.testing.assert_array_equal(group.weights_now(), group.memory()["weights"])


def test_the_memory_is_a_copy() -> None:
    journeys = random_journeys(2)
    group, other = (new_group(journeys, "td", choose(), np.float64) for _ in range(2))
    follow(group, journeys, end=20)
    follow(other, journeys, end=20)
    for array in group.memory().values():
        array.fill(7)
    np.testing.assert_array_equal(follow(group, journeys, 20).weights, follow(other, journeys, 20).weights)


@kernels
@rules
def test_a_gvf_that_overflows_or_explodes_begins_again_and_the_others_do_not(
    kernel: Kernel, algorithm: Algorithm
) -> None:
    journeys = random_journeys(1, gvfs=3)
    journeys.gammas[:] = 0.99
    journeys.rewards[:] = np.nan_to_num(journeys.rewards)
    undisturbed = follow(new_group(journeys, algorithm, kernel, np.float64), journeys)
    journeys.rewards[20:50, 1] = 1.7e308
    group = new_group(journeys, algorithm, kernel, np.float64)
    seen = follow(group, journeys)
    assert np.isfinite(seen.predictions).all()
    assert np.isfinite(seen.weights).all()
    assert group.resets[1] > 0
    assert group.resets[[0, 2]].tolist() == [0, 0]
    np.testing.assert_array_equal(seen.predictions[:, [0, 2]], undisturbed.predictions[:, [0, 2]])


@kernels
def test_a_gvf_that_diverges_begins_again_long_before_it_overflows(kernel: Kernel) -> None:
    rng = np.random.default_rng(1)
    group = Group(np.zeros((12, 1)), np.array([0.25]), "td", 1 / 12, kernel)
    greatest = 0.0
    for _ in range(200):
        if group.resets[0]:
            break
        # Accumulating traces that never fade overshoot.
        arrived = np.flatnonzero(rng.random(12) < 0.5)
        greatest = max(greatest, abs(group.step(arrived, rng.uniform(-1, 1, 1), 1.0, 1.0)[0]))
    assert group.resets.tolist() == [1]
    assert 100 < greatest < 1000 * (12 * 0.25 + 200)
    assert (group.weights_now() == 0.25).all()
    assert np.isnan(group.delta[0])


@kernels
def test_a_gvf_that_is_set_anew_leaves_the_others_alone(kernel: Kernel) -> None:
    journeys = random_journeys(8, gvfs=3)
    group, other = (new_group(journeys, "true_online", kernel, np.float64) for _ in range(2))
    follow(group, journeys, end=30)
    follow(other, journeys, end=30)
    group.reset([1])
    np.testing.assert_allclose(group.weights_now()[:, 1], journeys.initial[1], rtol=1e-12)
    mine, theirs = follow(group, journeys, 30), follow(other, journeys, 30)
    np.testing.assert_array_equal(mine.predictions[:, [0, 2]], theirs.predictions[:, [0, 2]])
    assert group.resets.tolist() == [0, 0, 0]


def test_a_signal_on_a_ring_is_predicted_exactly() -> None:
    group = Group(np.zeros((4, 1)), np.zeros(1), "true_online", 0.2, choose())
    signal = np.array([1.0, -2.0, 0.5, 3.0])
    for t in range(3000):
        group.step(np.array([t % 4]), 0.25 * signal[[t % 4]], 0.75, 0.9)
    ideal = ideal_predictions(np.tile(signal, 50), timescale=4)[:4]
    assert group.weights_now()[:, 0] == pytest.approx(ideal, abs=1e-9)


def test_a_caller_may_change_the_predictions_it_was_given() -> None:
    journeys = random_journeys(5)
    group, other = (new_group(journeys, "true_online", choose(), np.float64) for _ in range(2))
    for t in range(30):
        arrived = np.flatnonzero(journeys.phis[t])
        group.step(arrived, journeys.rewards[t], 0.9, 0.9).fill(99)
        other.step(arrived, journeys.rewards[t], 0.9, 0.9)
    np.testing.assert_array_equal(group.weights_now(), other.weights_now())


@kernels
def test_memory_does_not_grow_with_the_steps(kernel: Kernel) -> None:
    journeys = random_journeys(5, steps=200)
    group = new_group(journeys, "true_online", kernel, np.float64)
    follow(group, journeys)
    arrived = [np.flatnonzero(phi) for phi in journeys.phis]
    tracemalloc.start()
    try:
        before = 0
        for step in range(700):
            group.step(arrived[step % 200], journeys.rewards[step % 200], 0.9, 0.9)
            if step == 300:
                before = tracemalloc.get_traced_memory()[0]
        assert tracemalloc.get_traced_memory()[0] - before < 2000
    finally:
        tracemalloc.stop()


@kernels
@pytest.mark.parametrize("features", [[1, 1], [2, 1], [-1, 2], [3, SIZE], [5, 2, 7]])
def test_features_that_do_not_ascend_within_bounds_are_refused_and_teach_nothing(
    kernel: Kernel, features: list[int]
) -> None:
    journeys = random_journeys(5)
    group = new_group(journeys, "true_online", kernel, np.float64)
    follow(group, journeys, end=30)
    before = group.weights_now()
    with pytest.raises(ValueError, match=r"ascend within 0\.\.13"):
        group.step(np.array(features), journeys.rewards[0], 0.9, 0.9)
    np.testing.assert_allclose(group.weights_now(), before, rtol=0, atol=1e-12)


def test_more_active_features_than_alpha_bears_are_refused() -> None:
    group = Group(np.zeros((9, 1)), np.zeros(1), "td", 0.25, choose())
    assert group.step(np.arange(4), np.zeros(1), 0.9, 0.9).tolist() == [0]
    with pytest.raises(ValueError, match="overshoots with 5 active features: it bears 4"):
        group.step(np.arange(5), np.zeros(1), 0.9, 0.9)


@pytest.mark.parametrize(("gamma", "lam"), [(1.1, 0.0), (-0.1, 0.5), (0.5, 1.5), (float("nan"), 0.0)])
def test_gamma_and_lambda_out_of_range_are_refused(gamma: float, lam: float) -> None:
    group = Group(np.zeros((9, 1)), np.zeros(1), "td", 0.25, choose())
    with pytest.raises(ValueError, match="must be 0 to 1"):
        group.step(np.arange(4), np.zeros(1), gamma, lam)


@pytest.mark.parametrize("alpha", [0.0, -1.0, 1.1, float("nan")])
def test_a_step_size_that_would_overshoot_is_refused(alpha: float) -> None:
    with pytest.raises(ValueError, match="0 < α ≤ 1"):
        Group(np.zeros((9, 1)), np.zeros(1), "td", alpha, choose())


def test_weights_that_do_not_fit_are_refused() -> None:
    with pytest.raises(ValueError, match="initial weight for each GVF"):
        Group(np.zeros((9, 2)), np.zeros(3), "td", 0.1, choose())
    with pytest.raises(ValueError, match="each row of them contiguous"):
        Group(np.zeros((2, 9)).T, np.zeros(2), "td", 0.1, choose())
