from functools import partial

import numpy as np
import pytest

from bentod.learn.confidence.interval import Interval
from tests.learn.confidence.oracles import Vector

SIZE, GVFS = 8, 3


def test_the_bounds_are_percentiles_of_what_the_last_weights_predict() -> None:
    rng = np.random.default_rng(2)
    interval = Interval(SIZE, GVFS, 5, every=3, share=0.8)
    kept: list[Vector] = []
    for t in range(60):
        weights, features = rng.normal(size=(SIZE, GVFS)), np.flatnonzero(rng.random(SIZE) < 0.5)
        values = rng.normal(size=len(features)) if t % 2 else None
        bounds = interval.step(features, partial(np.copy, weights), values)
        if t % 3 == 0:
            kept = [*kept, weights][-5:]
        phi = np.zeros(SIZE)
        phi[features] = 1 if values is None else values
        predictions = [phi @ w for w in kept]
        expected = np.percentile(predictions, [10, 90], axis=0) if len(kept) > 1 else np.nan
        np.testing.assert_allclose(bounds, np.broadcast_to(expected, (2, GVFS)), rtol=0, atol=1e-12)


def test_it_narrows_where_weights_have_settled_and_stays_wide_where_not() -> None:
    rng = np.random.default_rng(3)
    interval = Interval(SIZE, 1, 20, every=1)
    weights = np.zeros((SIZE, 1))
    for _ in range(100):
        weights[:4] += 0.2 * (1 - weights[:4])
        weights[4:] = rng.normal(size=(4, 1))
        low, high = interval.step(np.array([0, 1]), lambda: weights)
    assert high[0] - low[0] < 1e-6
    assert low[0] == pytest.approx(2)
    low, high = interval.step(np.array([4, 5]), lambda: weights)
    assert high[0] - low[0] > 1


def test_weights_are_asked_for_only_when_they_are_to_be_kept() -> None:
    asked = []

    def weights() -> Vector:
        asked.append(1)
        return np.zeros((SIZE, 1))

    interval = Interval(SIZE, 1, 4, every=10)
    for _ in range(25):
        interval.step(np.array([0]), weights)
    assert len(asked) == 3


def test_a_new_gvf_has_no_interval_until_two_of_its_weights_were_kept() -> None:
    interval = Interval(SIZE, 2, 3, every=1)
    weights = np.arange(float(SIZE * 3)).reshape(SIZE, 3)
    for t in range(4):
        interval.step(np.array([0]), lambda t=t: weights[:, :2] + t)  # type: ignore[misc]
    interval.take(np.array([1]))
    interval.grow(1)
    low, high = interval.step(np.array([0]), lambda: weights[:, :2] + 4)
    assert np.isfinite(low[0])
    assert np.isnan(low[1])
    assert np.isnan(high[1])
    low, high = interval.step(np.array([0]), lambda: weights[:, :2] + 6)
    assert low[1] == pytest.approx(5.05)
    assert high[1] == pytest.approx(6.95)
    interval.forget(np.array([0]))
    low, high = interval.step(np.array([0]), lambda: weights[:, :2] + 6)
    assert np.isnan(low[0])
    assert high[1] > low[1]


@pytest.mark.parametrize(("count", "every", "share"), [(1, 1, 0.9), (2, 0, 0.9), (2, 1, 0.0)])
def test_settings_that_make_no_sense_are_refused(count: int, every: int, share: float) -> None:
    with pytest.raises(ValueError, match="An interval needs"):
        Interval(SIZE, 1, count, every, share)
