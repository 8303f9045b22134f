import math

import numpy as np
import pytest

from bentod.contracts import Arrival, Vector
from bentod.learn.algorithms import variance
from tests.learn.algorithms.journeys import learner, settings

GAMMA = 0.8
NOISE = np.array([0.0, 1.0, 0.5])  # σ of the reward on leaving each state of a ring of three


def known_variance(lam: float) -> Vector:
    """Var of the λ-return from each state: the noise of its reward, then (γλ)² of what comes after."""
    after = np.roll(np.eye(3), 1, axis=1)
    return np.linalg.solve(np.eye(3) - (GAMMA * lam) ** 2 * after, NOISE**2)


@pytest.mark.parametrize("lam", [1.0, 0.6])
def test_the_variance_of_the_return_is_learned_beside_its_value(lam: float) -> None:
    rng = np.random.default_rng(7)
    value, spread = (learner("true_online", settings(0.02, size=3, active=1)) for _ in range(2))
    late = []
    for t in range(5000):
        reward = 1.0 + NOISE[(t - 1) % 3] * rng.normal()
        phi, arrival = np.eye(3)[t % 3], Arrival(reward, GAMMA, lam)
        value.step(phi, arrival)
        spread.step(phi, variance.companion(value.delta, arrival, 0.9))
        if t >= 2000:
            late.append(spread.memory()["weights"])
    assert value.memory()["weights"] == pytest.approx(np.full(3, 5.0), abs=0.5)
    assert np.mean(late, axis=0) == pytest.approx(known_variance(lam), rel=0.15, abs=0.05)


def test_what_the_value_did_not_learn_from_the_variance_does_not_either() -> None:
    arrival = variance.companion(math.nan, Arrival(1.0, 0.9, 0.5), 0.7)
    assert math.isnan(arrival.cumulant)
    assert (arrival.gamma, arrival.lam) == pytest.approx((0.45**2, 0.7))


def test_a_variance_below_zero_is_no_spread() -> None:
    assert (variance.spread(-0.1), variance.spread(4.0)) == (0.0, 2.0)
