"""Known values are found: of a random walk, and of a movement over and over again."""

import numpy as np
import pytest
from numpy.typing import NDArray

from bentod.config_learn import Learn
from bentod.frames import JointSpec
from bentod.learn.group import Group
from bentod.learn.horde import unhurried
from bentod.learn.kernel import choose
from bentod.learn.lazy import Algorithm
from bentod.learn.predictor import Body, Predictor
from bentod.learn.returns import ideal_predictions
from bentod.learn.signals import Percept
from tests.fakes import PERIOD, at
from tests.learn.predictors import NO_EMG
from tests.learn.random_walk import STATES, walk

RATE_HZ = 30
SPEED = 0.2  # rad/s
END = np.array([], dtype=np.intp)


def learn_walk(group: Group, path: list[int]) -> None:
    """One episode, with a reward of 1 on the right, 1 on the left, and for the third GVF 1 or −1."""
    for state in path:
        outside = not 0 <= state < STATES
        right, left = float(state == STATES), float(state == -1)
        group.step(END if outside else np.array([state]), np.array([right, left, right - left]), 1.0, 0.9)
    group.cut()


@pytest.mark.parametrize("algorithm", ["td", "true_online"])
def test_the_values_of_the_19_state_random_walk_are_learned(algorithm: Algorithm) -> None:
    rng = np.random.default_rng(2)
    group = Group(np.zeros((STATES, 3)), np.zeros(3), algorithm, 0.1, choose())
    late = []
    for episode in range(30):
        path = list(walk(rng))
        learn_walk(group, path)
        # Its mirror image is as likely; together they leave less of the answer to luck.
        learn_walk(group, [STATES - 1 - state for state in path])
        if episode >= 15:
            late.append(group.weights_now())
    right = np.arange(1, STATES + 1) / (STATES + 1)
    known = np.column_stack([right, 1 - right, 2 * right - 1])
    assert np.sqrt(np.mean((np.mean(late, axis=0) - known) ** 2, axis=0)).max() < 0.09


def go(start: float, end: float) -> NDArray[np.float64]:
    return np.linspace(start, end, round(abs(end - start) / SPEED * RATE_HZ), endpoint=False)


def circuit() -> NDArray[np.float64]:
    """Shoulder out, elbow up, wait, elbow down, shoulder back, wait; rad, shape (steps, 2)."""
    out, up, wait = go(-0.4, 0.4), go(0.0, 0.6), np.zeros(RATE_HZ)
    shoulder = [out, 0 * up + 0.4, wait + 0.4, 0 * up + 0.4, go(0.4, -0.4), wait - 0.4]
    elbow = [0 * out, up, wait + 0.6, go(0.6, 0.0), 0 * out, wait]
    return np.column_stack([np.concatenate(shoulder), np.concatenate(elbow)])


def test_a_repeated_movement_is_soon_predicted_20_steps_ahead() -> None:
    repetitions = 4
    movement = np.tile(circuit(), (repetitions + 3, 1))
    specs = (JointSpec("shoulder", -0.8, 0.8, 0.5, 0.0, {}), JointSpec("elbow", -0.3, 1.2, 0.5, 0.0, {}))
    predictor = Predictor(Body(specs, (), {}, 1 / PERIOD), Learn(joints=("shoulder", "elbow")))
    predicted = []
    for tick, now in enumerate(movement[: repetitions * len(circuit())].tolist()):
        predictor.see(Percept(tick, tick * PERIOD, False, at(*now), NO_EMG, ()))
        predictor.step(unhurried)
        predicted.append([predictor.newest(f"{spec.name}.position@20") for spec in specs])
    ideal = ideal_predictions(movement, timescale=20)[: len(predicted)]
    errors = np.abs(np.array(predicted) - ideal).reshape(repetitions, -1, 2).mean(axis=1)
    assert (errors[-1] < 0.5 * errors[0]).all()
