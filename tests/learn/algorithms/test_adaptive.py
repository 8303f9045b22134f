"""Learners that choose a step size for each feature."""

import numpy as np
import pytest

from bentod.contracts import Arrival, Vector
from tests.learn.algorithms.journeys import learner, settings

OPTIONS = {"tidbd": {"theta": 0.1}, "autostep": {"theta": 0.05}, "swifttd": {"theta": 0.003, "eta": 1.0}}
RELEVANT, NOISE = slice(0, 3), slice(3, 10)


def step_sizes_after_tracking(name: str, scale: float = 1.0) -> tuple[Vector, Vector]:
    """Before and after: three of ten features make the cumulant, with weights that drift; the rest do not."""
    rng = np.random.default_rng(1)
    taught = learner(name, settings(0.1, size=10, active=5, options=OPTIONS[name]))
    first = np.exp(taught.memory()["log_step_sizes"])
    weights, phi = np.zeros(3), np.zeros(10)
    for _ in range(2000):
        goal = scale * (float(weights @ phi[RELEVANT]) + rng.normal())
        phi = (rng.random(10) < 0.5).astype(np.float64)
        taught.step(phi, Arrival(goal, 0.0, 0.0))
        weights += 0.1 * rng.normal(size=3)
    return first, np.exp(taught.memory()["log_step_sizes"])


@pytest.mark.parametrize("name", OPTIONS)
def test_step_sizes_grow_for_what_matters_and_fall_for_what_does_not(name: str) -> None:
    first, last = step_sizes_after_tracking(name)
    assert (last[RELEVANT] > 2 * first[RELEVANT]).all()
    assert (last[NOISE] < 0.8 * first[NOISE]).all()


def test_autostep_does_not_care_for_the_unit_of_the_cumulant() -> None:
    assert step_sizes_after_tracking("autostep", 1000.0)[1] == pytest.approx(
        step_sizes_after_tracking("autostep")[1], rel=1e-3
    )


@pytest.mark.parametrize("name", ["tidbd", "swifttd", "autostep"])
def test_step_sizes_fall_when_there_is_only_noise(name: str) -> None:
    rng = np.random.default_rng(3)
    taught = learner(name, settings(0.5, size=4, active=4, options=OPTIONS[name]))
    for _ in range(1500):
        taught.step((rng.random(4) < 0.5).astype(np.float64), Arrival(rng.normal(), 0.0, 0.0))
    assert (np.exp(taught.memory()["log_step_sizes"]) < 0.7 * 0.5 / 4).all()
