from collections.abc import Callable

import numpy as np
import pytest

from bentod.learn.horde import Horde, Question
from tests.learn import oracles
from tests.learn.oracles import Stream

SIZE, ACTIVE = 8, 3
QUESTIONS = [Question(1, 20), Question(0, 4), Question(0, 20), Question(1, 4)]
INITIAL = [-1.5, 0.3, -0.2, 2.0]


def new_horde() -> Horde:
    return Horde(QUESTIONS, SIZE, ACTIVE, INITIAL)


def journey(steps: int) -> tuple[list[list[int]], list[list[float]]]:
    """Features (always three, bias included) and the positions of two joints."""
    rng = np.random.default_rng(9)
    tiles = [sorted(rng.choice(SIZE - 1, 2, replace=False).tolist()) for _ in range(steps)]
    return [[*pair, SIZE - 1] for pair in tiles], rng.normal(size=(steps, 2)).tolist()


def dense(features: list[int]) -> oracles.Vector:
    phi = np.zeros(SIZE)
    phi[features] = 1
    return phi


def test_before_anything_is_learned_the_initial_angle_is_predicted() -> None:
    predictions = new_horde().step(np.array([0, 3, 7]), [0.0, 0.0])
    assert [(p.joint, p.timescale) for p in predictions] == [(q.joint, q.timescale) for q in QUESTIONS]
    assert [p.position for p in predictions] == pytest.approx(INITIAL)


@pytest.mark.parametrize("place", range(len(QUESTIONS)))
def test_each_question_is_answered_as_the_thesis_would(place: int) -> None:
    features, positions = journey(60)
    horde = new_horde()
    for phi, now in zip(features, positions, strict=True):
        predictions = horde.step(np.array(phi), now)
    question = QUESTIONS[place]
    gamma = 1 - 1 / question.timescale
    rewards = [(1 - gamma) * now[question.joint] for now in positions[1:]]
    stream = Stream([dense(phi) for phi in features], rewards, [0.3 / ACTIVE] * 59)
    w = oracles.equations_5_2_to_5_4(stream, np.full(SIZE, INITIAL[place] / ACTIVE), gamma, 0.95)[-1]
    answer = predictions[place]
    assert (answer.joint, answer.timescale) == (question.joint, question.timescale)
    assert answer.position == pytest.approx(float(w @ stream.phis[-1]), abs=1e-12)


def test_a_joint_that_cannot_be_read_is_predicted_but_teaches_nothing() -> None:
    horde, undisturbed = new_horde(), new_horde()
    features, positions = journey(20)
    for phi, (first, second) in zip(features, positions, strict=True):
        mine = horde.step(np.array(phi), [first, float("nan")])
        theirs = undisturbed.step(np.array(phi), [first, second])
    assert [p.position for p in mine if p.joint == 1] == pytest.approx([-1.5, 2.0])
    assert [p for p in mine if p.joint == 0] == [p for p in theirs if p.joint == 0]
    assert horde.resets == (0, 0, 0, 0)


def test_a_learner_gone_bad_starts_again_and_is_counted_in_question_order() -> None:
    horde, undisturbed = new_horde(), new_horde()
    horde.step(np.array([0, 3, 7]), [0.0, 0.0])
    undisturbed.step(np.array([0, 3, 7]), [0.0, 0.0])
    horde._groups[1].learner._w[1, 3] = np.nan
    mine = horde.step(np.array([0, 3, 7]), [0.1, 0.1])
    theirs = undisturbed.step(np.array([0, 3, 7]), [0.1, 0.1])
    assert horde.resets == (0, 0, 1, 0)
    assert mine[2].position == pytest.approx(INITIAL[2])
    assert [mine[i] for i in (0, 1, 3)] == [theirs[i] for i in (0, 1, 3)]


def test_after_a_cut_the_gap_is_not_learned_from() -> None:
    horde = new_horde()
    horde.step(np.array([0, 3, 7]), [0.0, 0.0])
    horde.cut()
    predictions = horde.step(np.array([0, 3, 7]), [9.0, 9.0])
    assert [p.position for p in predictions] == pytest.approx(INITIAL)


def after(answers: list[bool]) -> Callable[[], bool]:
    """There is time for as long as `answers` says."""
    return iter(answers).__next__


def test_the_shortest_timescale_learns_while_there_is_time_and_the_others_only_predict() -> None:
    horde, undisturbed, ignorant = new_horde(), new_horde(), new_horde()
    features, positions = journey(20)
    for phi, now in zip(features, positions, strict=True):
        ignorant.cut()
        mine = horde.step(np.array(phi), now, after([True, False]))
        theirs = undisturbed.step(np.array(phi), now)
        first = ignorant.step(np.array(phi), now)
    assert [p for p in mine if p.timescale == 4] == [p for p in theirs if p.timescale == 4]
    assert [p for p in mine if p.timescale == 20] == [p for p in first if p.timescale == 20]
    assert (horde.shed, undisturbed.shed) == (20, 0)


def test_what_was_not_learned_for_lack_of_time_is_as_if_an_episode_began_there() -> None:
    hurried, cut = new_horde(), new_horde()
    features, positions = journey(60)
    for step, (phi, now) in enumerate(zip(features, positions, strict=True)):
        mine = hurried.step(np.array(phi), now, lambda step=step: step % 7 != 3)  # type: ignore[misc]
        if step % 7 == 3:
            cut.cut()
        theirs = cut.step(np.array(phi), now)
        assert mine == theirs
    assert hurried.shed == 2 * 9


def test_groups_that_take_their_steps_one_after_another_learn_what_they_learn_together() -> None:
    apart, together = new_horde(), new_horde()
    features, positions = journey(30)
    for phi, now in zip(features, positions, strict=True):
        long = apart.step(np.array(phi), now, timescales=[20])
        short = apart.step(np.array(phi), now, timescales=[4])
        theirs = together.step(np.array(phi), now)
        assert long == (theirs[0], theirs[2])
        assert short == (theirs[1], theirs[3])


@pytest.mark.parametrize("step_size", [0.0, -1.0, 1.1])
def test_a_step_size_that_would_overshoot_is_refused(step_size: float) -> None:
    with pytest.raises(ValueError, match="step size"):
        Horde(QUESTIONS, SIZE, ACTIVE, INITIAL, step_size=step_size)


def test_every_question_needs_an_initial_angle() -> None:
    with pytest.raises(ValueError, match="4 questions need as many initial angles, not 1"):
        Horde(QUESTIONS, SIZE, ACTIVE, [0.0])
