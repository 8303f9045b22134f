import numpy as np
import pytest

from bentod.contracts import Arrival, Learner, Vector
from tests.learn.algorithms.journeys import learner, settings

BAIRD = np.vstack(
    [np.hstack([2 * np.eye(6), np.zeros((6, 1)), np.ones((6, 1))]), [[0, 0, 0, 0, 0, 0, 1, 2]]]
).astype(np.float64)
"""Features of Baird's seven states (Sutton & Barto 2018, Figure 11.1), shape (states, features)."""

GAMMA = 0.99


def wander(taught: Learner, steps: int) -> None:
    """The behaviour goes to the seventh state once in seven, the policy asked about always: ρ is 7 or 0."""
    rng = np.random.default_rng(5)
    start = taught.memory()
    start["weights"][:] = [1, 1, 1, 1, 1, 1, 10, 1]
    taught.recall(start)
    for state in rng.integers(0, 7, steps).tolist():
        taught.step(BAIRD[state], Arrival(0.0, GAMMA, 0.0, 7.0 if state == 6 else 0.0))


def projected_bellman_error(w: Vector) -> float:
    """Root of the mean square, over the behaviour's even distribution of states."""
    bellman = GAMMA * (BAIRD[6] @ w) - BAIRD @ w
    projection = BAIRD @ np.linalg.pinv(BAIRD)
    return float(np.sqrt(np.mean((projection @ bellman) ** 2)))


def test_gtd_converges_on_bairds_counterexample() -> None:
    taught = learner("gtd", settings(0.025, size=8, active=5, options={"eta": 10}))
    wander(taught, 6000)
    weights = taught.memory()["weights"]
    assert taught.resets == 0
    assert projected_bellman_error(np.array([1, 1, 1, 1, 1, 1, 10, 1.0])) > 5
    assert projected_bellman_error(weights) < 0.5
    assert np.abs(weights).max() < 20


def test_td_diverges_on_bairds_counterexample() -> None:
    taught = learner("td", settings(0.025, size=8, active=5))
    wander(taught, 5000)
    assert taught.resets > 0 or np.abs(taught.memory()["weights"]).max() > 1000


@pytest.mark.parametrize("name", ["gtd", "td", "td_normalised"])
def test_another_policy_than_the_one_that_acts_is_learned_about(name: str) -> None:
    # The behaviour tosses a coin for a reward of 1 or −1; the policy asked about gets 1 four times in five.
    rng = np.random.default_rng(6)
    taught = learner(name, settings(0.02, size=1, active=1))
    answers = []
    for _ in range(3000):
        heads = rng.random() < 0.5
        arrival = Arrival(1.0 if heads else -1.0, 0.5, 0.5, 1.6 if heads else 0.4)
        answers.append(taught.step(np.ones(1), arrival))
    assert np.mean(answers[1000:]) == pytest.approx(1.2, abs=0.15)
