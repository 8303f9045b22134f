from collections.abc import Iterator

import numpy as np
import pytest
from numpy.typing import NDArray

from bentod.frames import Prediction
from bentod.learn.horde import Horde, Question
from bentod.learn.representation import Representation
from bentod.learn.returns import ideal_predictions
from bentod.learn.true_online import TrueOnlineTD

RATE_HZ = 30
SPEED = 0.2  # rad/s
END = np.array([], dtype=np.intp)


def walk(states: int, rng: np.random.Generator) -> Iterator[int]:
    """A random walk from the middle state, up to and including the terminal −1 or `states`."""
    state = states // 2
    while 0 <= state < states:
        yield state
        state += 1 if rng.random() < 0.5 else -1
    yield state


def learn_walk(learner: TrueOnlineTD, states: int, path: list[int]) -> None:
    """One episode with a reward of 1 for leaving on the right and −1 on the left."""
    for state in path:
        outside = not 0 <= state < states
        reward = float(np.sign(state)) if outside else 0.0
        learner.step(END if outside else np.array([state]), [reward])
    learner.cut()


@pytest.mark.parametrize(("states", "episodes", "lam"), [(5, 1000, 0.4), (19, 200, 0.9)])
def test_the_values_of_a_random_walk_are_learned(states: int, episodes: int, lam: float) -> None:
    rng = np.random.default_rng(2)
    learner = TrueOnlineTD(states, [0.0], 1.0, lam, 0.05)
    late = []
    for episode in range(episodes):
        path = list(walk(states, rng))
        learn_walk(learner, states, path)
        # Its mirror image is as likely; together they leave less of the answer to luck.
        learn_walk(learner, states, [states - 1 - state for state in path])
        if episode >= episodes // 2:
            late.append(learner.weights[:, 0].copy())
    known = np.linspace(-1, 1, states + 2)[1:-1]
    assert np.sqrt(np.mean((np.mean(late, axis=0) - known) ** 2)) < 0.05


def test_the_values_of_a_ring_are_learned_exactly() -> None:
    learner = TrueOnlineTD(4, [0.0], 0.75, 0.9, 0.2)
    signal = np.array([1.0, -2.0, 0.5, 3.0])
    for t in range(4000):
        learner.step(np.array([t % 4]), [0.25 * signal[t % 4]])
    ideal = ideal_predictions(np.tile(signal, 50), timescale=4)[:4]
    assert learner.weights[:, 0] == pytest.approx(ideal, abs=1e-9)


def go(start: float, end: float) -> NDArray[np.float64]:
    return np.linspace(start, end, round(abs(end - start) / SPEED * RATE_HZ), endpoint=False)


def circuit() -> NDArray[np.float64]:
    """Shoulder out, elbow up, wait, elbow down, shoulder back, wait; rad, shape (steps, 2)."""
    out, up, wait = go(-0.4, 0.4), go(0.0, 0.6), np.zeros(RATE_HZ)
    shoulder = [out, 0 * up + 0.4, wait + 0.4, 0 * up + 0.4, go(0.4, -0.4), wait - 0.4]
    elbow = [0 * out, up, wait + 0.6, go(0.6, 0.0), 0 * out, wait]
    return np.column_stack([np.concatenate(shoulder), np.concatenate(elbow)])


def positions_of(predictions: tuple[Prediction, ...]) -> list[float]:
    return [prediction.position for prediction in predictions]


def test_a_repeated_movement_is_soon_predicted_20_steps_ahead() -> None:
    repetitions = 10
    movement = np.tile(circuit(), (repetitions + 3, 1))
    representation = Representation([(-0.8, 0.8), (-0.3, 1.2)])
    questions = [Question(0, 20), Question(1, 20)]
    horde = Horde(questions, representation.size, representation.active, initial=[-0.8, -0.3])
    predicted = [
        positions_of(horde.step(representation.features(now), now))
        for now in movement[: repetitions * len(circuit())].tolist()
    ]
    ideal = ideal_predictions(movement, timescale=20)[: len(predicted)]
    errors = np.abs(np.array(predicted) - ideal).reshape(repetitions, -1, 2).mean(axis=1)
    assert (errors[-1] < 0.4 * errors[0]).all()
