"""What is told of questions in every tick, and when somebody asks."""

import math

import pytest

from bentod.learn.predictor import Predictor
from tests.learn.predictors import gvf, live, new_predictor, percept


@pytest.fixture(scope="module")
def predictor() -> Predictor:
    """Five seconds old, with one question beside those of the arm."""
    own = gvf(timescale=5.0, variance=True, interval=2)
    raw = {"name": "raw", "raw": ["elbow.position"]}
    predictor = new_predictor(gvfs=[own, gvf(name="real", representation="raw")], representations=[raw])
    live(predictor, 0, 150)
    return predictor


def test_a_frame_has_ones_own_predictions_and_estimates_of_all(predictor: Predictor) -> None:
    told = predictor.frame()
    assert list(told.predictions) == ["speed", "speed.variance", "real"]
    assert told.predictions["speed"] == predictor.newest("speed")
    assert told.surprise.keys() >= {"elbow.position@20", "speed"}
    assert told.error.keys() >= {"elbow.position@5", "speed"}
    assert told.older == {}


def test_who_does_not_estimate_a_confidence_tells_none(predictor: Predictor) -> None:
    told = predictor.frame().confidence
    assert {"elbow.position@20", "speed"} <= told.keys()
    assert "speed.variance" not in told
    assert all(0 <= confidence <= 1 for confidence in told.values())


def test_familiarity_is_told_of_binary_representations_only(predictor: Predictor) -> None:
    told = predictor.frame().familiarity
    assert told.keys() == {"arm"}
    assert 0 < told["arm"] < 1


def test_estimates_have_no_more_figures_than_they_are_worth(predictor: Predictor) -> None:
    told = predictor.frame()
    for value in (*told.confidence.values(), *told.surprise.values(), *told.familiarity.values()):
        assert value == round(value, 4)
    for value in told.error.values():
        assert value == float(f"{value:.4g}")


def test_before_anything_was_read_there_is_nothing_to_tell() -> None:
    fresh = new_predictor(gvfs=[gvf()])
    told = fresh.frame()
    assert (told.predictions, told.older, told.error, told.familiarity) == ({}, {}, {}, {})
    assert [entry["prediction"] for entry in fresh.describe()] == [None] * 5


def test_every_question_is_described_in_the_order_in_which_it_was_asked(predictor: Predictor) -> None:
    told = predictor.describe()
    assert [entry["name"] for entry in told] == [question.name for question in predictor.horde.questions]
    elbow = next(entry for entry in told if entry["name"] == "elbow.position@20")
    assert elbow["prediction"] == predictor.newest("elbow.position@20")
    assert (elbow["gamma"], elbow["algorithm"], elbow["resets"]) == (0.95, "true_online", 0)
    assert elbow["confidence"] == predictor.confidence("elbow.position@20")
    assert "lowest" not in elbow


def test_where_past_weights_are_kept_the_span_of_what_they_predict_is_described(predictor: Predictor) -> None:
    (speed,) = (entry for entry in predictor.describe() if entry["name"] == "speed")
    low, high = speed["lowest"], speed["highest"]
    assert isinstance(low, float)
    assert isinstance(high, float)
    assert low <= high


def test_an_error_is_described_as_a_share_of_how_far_the_returns_spread(predictor: Predictor) -> None:
    (elbow,) = (entry for entry in predictor.describe() if entry["name"] == "elbow.position@5")
    share = elbow["normalised_error"]
    assert isinstance(share, float)
    assert 0 < share < 2


def test_the_age_of_what_a_blind_arm_said_is_told_of_its_own_questions_too() -> None:
    fresh = new_predictor(gvfs=[gvf()])
    live(fresh, 0, 5)
    fresh.see(percept(5, stale=(1,)))
    fresh.step(lambda: True)
    told = fresh.frame()
    assert told.older == {question.name: 1.0 for question in fresh.horde.questions}
    assert math.isfinite(told.predictions["speed"])
