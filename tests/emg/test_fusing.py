"""Likelihoods and predictions weighed together: equation (6.6), and what a prediction may not do."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bentod.config_adaptation import Fusion
from bentod.emg.classify.pipeline import Pipeline
from bentod.emg.fusing import Foreseen, fuse
from bentod.emg.recognition import REST, Fused
from tests.emg.gestures import model, session

LABELS = ("close", "open", REST)
SHARES = st.lists(st.floats(0.001, 1), min_size=3, max_size=3).map(lambda one: [x / sum(one) for x in one])


def test_the_weighed_likelihood_is_that_of_the_equation() -> None:
    found = fuse(LABELS, (0.6, 0.3, 0.1), Foreseen({"close": 0.1, "open": 0.3}, 0.8), Fusion(beta=0.5))
    assert found.weight == pytest.approx(0.4)
    assert found.likelihoods["close"] == pytest.approx(0.4 * 0.9 * 0.25 + 0.6 * 0.6)
    assert found.likelihoods["open"] == pytest.approx(0.4 * 0.9 * 0.75 + 0.6 * 0.3)
    assert found.likelihoods[REST] == pytest.approx(0.1)


def test_a_prediction_decides_between_movements_that_the_muscles_leave_open() -> None:
    found = fuse(LABELS, (0.5, 0.45, 0.05), Foreseen({"close": 0.0, "open": 0.5}, 1.0), Fusion())
    assert (found.unaided, found.likely, found.changed) == ("close", "open", True)


def test_muscles_that_are_sure_outweigh_the_surest_prediction() -> None:
    found = fuse(LABELS, (0.95, 0.04, 0.01), Foreseen({"close": 0.0, "open": 1.0}, 1.0), Fusion())
    assert (found.likely, found.changed) == ("close", False)


def test_a_classifier_that_is_surer_than_right_can_be_softened() -> None:
    known, foreseen = (0.98, 0.019, 0.001), Foreseen({"close": 0.0, "open": 1.0}, 1.0)
    assert not fuse(LABELS, known, foreseen, Fusion(beta=0.4)).changed
    softened = fuse(LABELS, known, foreseen, Fusion(beta=0.4, softness=8.0))
    assert softened.changed
    assert sum(softened.likelihoods.values()) == pytest.approx(1)


def test_a_prediction_moves_nothing_that_rests() -> None:
    found = fuse(LABELS, (0.3, 0.3, 0.4), Foreseen({"close": 1.0}, 1.0), Fusion(beta=0.5))
    assert (found.weight, found.likely) == (0.0, REST)


@pytest.mark.parametrize(
    "foreseen",
    [
        Foreseen({}, 1.0),
        Foreseen({"close": 0.0, "open": 0.0}, 1.0),
        Foreseen({"close": math.nan, "open": 0.4}, 1.0),
        Foreseen({"open": 0.4}, math.nan),
        Foreseen({"open": 0.4}, 0.0),
        Foreseen({"open": 0.4}, -3.0),
    ],
)
def test_what_is_not_foreseen_or_not_believed_counts_nothing(foreseen: Foreseen) -> None:
    found = fuse(LABELS, (0.6, 0.3, 0.1), foreseen, Fusion(beta=0.5))
    assert found.weight == 0.0
    assert list(found.likelihoods.values()) == [0.6, 0.3, 0.1]


@given(SHARES, st.lists(st.floats(-1, 2), min_size=2, max_size=2), st.floats(-1, 2), st.floats(0, 0.5))
def test_whatever_is_predicted_likelihoods_add_up_and_rest_is_as_likely(
    shares: list[float], use: list[float], confidence: float, beta: float
) -> None:
    found = fuse(
        LABELS, shares, Foreseen(dict(zip(LABELS, use, strict=False)), confidence), Fusion(beta=beta)
    )
    assert sum(found.likelihoods.values()) == pytest.approx(1)
    assert min(found.likelihoods.values()) >= 0
    assert found.likelihoods[REST] == pytest.approx(shares[2])
    assert 0 <= found.weight <= beta


def decided(pipeline: Pipeline) -> list[tuple[str, str, Fused | None]]:
    samples = session(1, 0.6, seed=4).pieces[0].samples
    return [(one.label, one.likely, one.fused) for one in pipeline.step(0, samples)]


def test_without_predictions_a_decision_is_the_same_and_says_that_it_owes_nothing() -> None:
    plain = decided(Pipeline(model()))
    fused = decided(
        Pipeline(model(), None, lambda labels, known: fuse(labels, known, Foreseen({}, 0.0), Fusion()))
    )
    assert [one[:2] for one in plain] == [one[:2] for one in fused]
    assert all(one[2] is None for one in plain)
    assert all(one[2] is not None and one[2].weight == 0 for one in fused)


def test_a_decision_that_a_prediction_changed_says_so_and_keeps_what_the_muscles_said() -> None:
    def insist(labels: tuple[str, ...], known: list[float]) -> Fused:
        alone = dict(zip(labels, known, strict=True))
        most = max(alone, key=alone.__getitem__)
        return Fused(0.5, {label: float(label == "turn") for label in labels}, most)

    pipeline = Pipeline(model(), None, insist)  # type: ignore[arg-type]
    samples = session(1, 0.6, seed=4).pieces[0].samples[120:240]  # of closing
    one = pipeline.step(0, samples)[-1]
    assert one.likely == one.label == "turn"
    assert one.fused is not None
    assert one.fused.changed
    assert max(one.probabilities, key=one.probabilities.__getitem__) == one.fused.unaided == "close"
