"""What the arm's own questions, which assists follow, are answered from."""

import math

import pytest
from pydantic import ValidationError

from bentod.config_learn import ARM, Learn
from bentod.errors import ConfigError
from bentod.outlook import Expectation
from sim.studies.representations import SEEING, seeing
from tests.learn.predictors import live, new_predictor

JOINTS = ("shoulder", "elbow")
TABLES = tuple(seeing(name, JOINTS, "arm", 0.2, 0.5) for name in SEEING)


@pytest.mark.parametrize("name", SEEING)
def test_the_arms_own_questions_are_answered_from_the_representation_that_is_named(name: str) -> None:
    predictor = new_predictor(representation=name, representations=TABLES)
    assert {question.representation for question in predictor.horde.questions} == {name}
    told = live(predictor, 0, 40)[-1]
    assert told != live(new_predictor(), 0, 40)[-1]
    assert all(map(math.isfinite, told.values()))


def test_without_a_name_they_are_answered_as_in_the_thesis() -> None:
    questions = new_predictor(representations=TABLES).horde.questions
    assert {question.representation for question in questions} == {ARM}


def test_a_state_is_as_familiar_as_it_is_to_the_learners_that_are_followed() -> None:
    predictor = new_predictor(representation="intent", representations=TABLES)
    live(predictor, 0, 60)
    followed = Expectation(predictor, JOINTS, (5.0, 20.0), "intent")
    assert followed.familiarity() == predictor.familiarity("intent") > 0.1
    assert math.isnan(Expectation(predictor, JOINTS, (5.0, 20.0)).familiarity())


def test_a_representation_that_is_not_there_is_refused_with_the_nearest_name() -> None:
    with pytest.raises(ConfigError, match=r"learn\.representation: there is no 'intend'.*intent"):
        new_predictor(representation="intend", representations=TABLES)


def test_a_representation_without_joints_answers_nothing_and_is_refused() -> None:
    gvf = {"name": "x", "cumulant": "1", "timescale": 5, "representation": "intent"}
    with pytest.raises(ValidationError, match="representation: needs joints"):
        Learn.model_validate({"representation": "intent", "representations": TABLES, "gvfs": [gvf]})
