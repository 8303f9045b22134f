import math

import numpy as np
import pytest

from bentod.contracts import Arrival, Learner
from bentod.learn.returns import ideal_predictions
from tests.learn.algorithms.journeys import learner, settings
from tests.learn.random_walk import STATES, walk

ALL = (
    "td",
    "td_replacing",
    "td_normalised",
    "true_online",
    "true_online_5",
    "gtd",
    "tidbd",
    "autostep",
    "swifttd",
)


def learn_walk(taught: Learner, path: list[int]) -> None:
    """One episode, with a reward of 1 for leaving on the right and −1 on the left."""
    for state in path:
        inside = 0 <= state < STATES
        phi = np.zeros(STATES)
        if inside:
            phi[state] = 1
        taught.step(phi, Arrival(0.0 if inside else math.copysign(1, state), float(inside), 0.9))
    taught.cut()


@pytest.mark.parametrize("name", ALL)
def test_the_values_of_the_19_state_random_walk_are_learned(name: str) -> None:
    rng = np.random.default_rng(4)
    taught = learner(name, settings(0.1, size=STATES, active=1))
    late = []
    for episode in range(30):
        path = list(walk(rng))
        learn_walk(taught, path)
        # Its mirror image is as likely; together they leave less of the answer to luck.
        learn_walk(taught, [STATES - 1 - state for state in path])
        if episode >= 15:
            late.append(taught.memory()["weights"])
    known = np.linspace(-1, 1, STATES + 2)[1:-1]
    assert np.sqrt(np.mean((np.mean(late, axis=0) - known) ** 2)) < 0.09


@pytest.mark.parametrize("name", ALL)
def test_the_returns_of_a_ring_are_learned_although_its_states_share_a_feature(name: str) -> None:
    signal = np.array([1.0, -2.0, 0.5, 3.0])
    taught = learner(name, settings(0.2, size=5, active=2))
    for t in range(500):
        phi = np.append(np.eye(4)[t % 4], 1.0)
        taught.step(phi, Arrival(0.25 * signal[t % 4], 0.75, 0.9))
    weights = taught.memory()["weights"]
    ideal = ideal_predictions(np.tile(signal, 50), timescale=4)[:4]
    assert weights[:4] + weights[4] == pytest.approx(ideal, abs=1e-4)
