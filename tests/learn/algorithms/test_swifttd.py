import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as tried
from hypothesis import strategies as st

from bentod.contracts import Arrival, Vector
from bentod.learn.algorithms.swifttd import SwiftTD
from tests.learn.algorithms import oracles_adaptive
from tests.learn.algorithms.journeys import SIZE, Journey, journey, predictions, settings

seeds = st.integers(0, 2**32 - 1)


def step_sizes(taught: SwiftTD) -> Vector:
    return np.exp(taught.memory()["log_step_sizes"])


@tried(max_examples=20, deadline=None)
@given(seeds, st.floats(0.01, 1), st.floats(0, 5), st.floats(0.05, 1), st.booleans())
def test_no_step_takes_away_more_of_an_error_than_eta(
    seed: int, step_size: float, theta: float, eta: float, binary: bool
) -> None:
    options = {"theta": theta, "eta": eta}
    taught = SwiftTD(settings(step_size, options=options))
    at_once = SwiftTD(settings(step_size, options=options))
    experience = journey(seed, binary=binary)
    for phi, phi_next, arrival in experience.transitions():
        taught.step(np.array(phi), arrival)
        # The same step sizes with no history: what one error then changes in the prediction it came from.
        at_once.recall({**at_once.memory(), "log_step_sizes": taught.memory()["log_step_sizes"]})
        at_once.cut()
        value = at_once.step(np.array(phi), arrival)
        at_once.step(np.array(phi_next), Arrival(value + 1.0, 0.0, 0.0))
        taken = float(at_once.memory()["weights"] @ np.array(phi)) - value
        assert taken <= eta * (1 + 1e-9)
        assert (step_sizes(taught) <= eta * (1 + 1e-9)).all()


def test_step_sizes_never_fall_below_eta_min() -> None:
    # An implementation in circulation compares α with ln η_min, which is below 0, and never finds it small.
    taught = SwiftTD(settings(0.1, size=1, active=1, options={"theta": 1.0, "eta_min": 1e-6}))
    rng = np.random.default_rng(2)
    seen = []
    for _ in range(500):
        taught.step(np.ones(1), Arrival(rng.normal(), 0.0, 0.0))
        seen.append(step_sizes(taught)[0])
    assert min(seen) == pytest.approx(1e-6)


def test_step_sizes_that_are_too_large_together_decay_where_they_are_active_only() -> None:
    taught = SwiftTD(settings(1.0, active=2, options={"eta": 0.5, "theta": 0.0, "decay": 0.8}))
    for _ in range(2):
        taught.step(np.array([1.0, 1.0, 1.0, 0.0, 0.0]), Arrival(0.0, 0.0, 0.0))
    assert step_sizes(taught) == pytest.approx([0.4, 0.4, 0.4, 0.5, 0.5])


@tried(max_examples=10, deadline=None)
@given(seeds)
def test_its_slopes_are_the_derivatives_by_the_log_of_the_step_size(seed: int) -> None:
    drawn = journey(seed, steps=12, binary=False, gaps=False)
    experience = Journey([[0.6 * math.tanh(phi[0])] for phi in drawn.phis], drawn.arrivals)
    taught = SwiftTD(settings(0.3, size=1, active=1, initial=0.4, options={"theta": 0, "eta": 1}))
    targets = []
    taught.step(np.array(experience.phis[0]), Arrival(0, 0, 0))
    for _, phi_next, arrival in experience.transitions():
        value = float(taught.memory()["weights"] @ np.array(phi_next))
        targets.append(arrival.cumulant + arrival.gamma * value)
        taught.step(np.array(phi_next), arrival)
    beta, nudge = math.log(0.3), 1e-5
    after, before = (
        oracles_adaptive.descent(experience, 0.4, beta + side, targets) for side in (nudge, -nudge)
    )
    slopes = [(a - b) / (2 * nudge) for a, b in zip(after, before, strict=True)]
    last = experience.arrivals[-1]
    kept = taught.memory()
    assert kept["weight_slope"][0] == pytest.approx(slopes[0], rel=1e-5, abs=1e-7)
    assert kept["trace_slope"][0] == pytest.approx(slopes[1] * last.gamma * last.lam, rel=1e-5, abs=1e-7)


def test_a_first_step_size_above_the_bound_begins_at_the_bound() -> None:
    taught = SwiftTD(settings(1.0, active=1, options={"eta": 0.25}))
    assert step_sizes(taught) == pytest.approx([0.25] * SIZE)


def test_it_predicts_finitely_when_the_meta_step_size_is_absurd() -> None:
    taught = SwiftTD(settings(0.5, options={"theta": 10}))
    assert np.isfinite(predictions(taught, journey(8, steps=300))).all()
