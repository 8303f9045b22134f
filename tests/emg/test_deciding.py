"""From probabilities to decisions, one window after the other."""

from collections.abc import Sequence

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bentod.emg.classify.deciding import Decider, Deciding
from bentod.emg.classify.loudness import Range
from bentod.emg.recognition import REST, Decision
from bentod.errors import ConfigError

LABELS = ("close", "open", REST)
RANGES = {"close": Range(10e-6, 110e-6), "open": Range(0.0, 10e-6), REST: Range(0.0, 1e-6)}
LOUD = 1.0  # V, louder than anything in training
WORDS = {"c": "close", "o": "open", "r": REST}


def sure(label: str, of: float = 0.9) -> list[float]:
    rest = (1 - of) / (len(LABELS) - 1)
    return [of if name == label else rest for name in LABELS]


def decided(letters: str, deciding: Deciding) -> list[Decision]:
    """One window a letter, of which the classifier is sure; a capital: it is hardly sure."""
    decider = Decider(LABELS, RANGES, deciding)
    return [
        decider.decide(k, sure(WORDS[c.lower()], 0.9 if c.islower() else 0.5), LOUD)
        for k, c in enumerate(letters)
    ]


def said(decisions: Sequence[Decision]) -> str:
    return "".join(decision.label[0] for decision in decisions)


def speeds(decisions: Sequence[Decision]) -> list[float]:
    return [decision.speed for decision in decisions]


def test_without_filters_each_window_speaks_for_itself() -> None:
    assert said(decided("corcco", Deciding())) == "corcco"


def test_all_probabilities_come_out() -> None:
    (decision,) = decided("c", Deciding())
    assert decision.probabilities == pytest.approx({"close": 0.9, "open": 0.05, REST: 0.05})
    assert (decision.likely, decision.rejected, decision.reason) == ("close", False, "")


def test_a_class_that_is_not_sure_moves_nothing_and_is_still_told() -> None:
    before, rejected, after = decided("cCc", Deciding(reject_below=0.6))
    assert (rejected.label, rejected.speed, rejected.rejected) == (REST, 0.0, True)
    assert rejected.likely == "close"
    assert rejected.probabilities["close"] == pytest.approx(0.5)
    assert (before.label, after.label) == ("close", "close")


def test_rest_that_is_sure_is_not_rejected() -> None:
    (decision,) = decided("r", Deciding(reject_below=0.6))
    assert (decision.label, decision.rejected) == (REST, False)


def test_the_majority_of_windows_outvotes_a_single_one() -> None:
    assert said(decided("cccoccc", Deciding(votes=3))) == "rcccccc"


def test_a_vote_begins_with_rest() -> None:
    assert said(decided("ccccc", Deciding(votes=5))) == "rrccc"


def test_of_classes_with_as_many_votes_the_newest_wins() -> None:
    assert said(decided("co", Deciding(votes=3))) == "ro"


def test_a_rejected_window_stops_at_once_whatever_others_voted() -> None:
    assert said(decided("ccccCc", Deciding(votes=3, reject_below=0.6))) == "rcccrc"


def test_a_flutter_between_classes_changes_nothing() -> None:
    assert said(decided("cccocooccc", Deciding(flutter=3))) == "rrcccccccc"


def test_a_class_that_persists_takes_over() -> None:
    assert said(decided("cccooooo", Deciding(flutter=3))) == "rrcccooo"


def test_rest_takes_over_at_once() -> None:
    assert said(decided("cccrrcc", Deciding(flutter=3))) == "rrcrrrr"


def test_the_ramp_starts_slowly_and_falls_faster_than_it_rises() -> None:
    found = decided("cccccooc", Deciding(ramp=4, proportional=False))
    assert speeds(found) == [0.25, 0.5, 0.75, 1.0, 1.0, 0.25, 0.5, 0.25]


def test_a_single_wrong_window_costs_the_ramp_little() -> None:
    found = decided("ccccoc", Deciding(ramp=4, ramp_down=1, proportional=False))
    assert speeds(found) == [0.25, 0.5, 0.75, 1.0, 0.25, 1.0]


def test_rejected_windows_bring_the_ramp_down() -> None:
    found = decided("ccccCc", Deciding(ramp=4, reject_below=0.6, proportional=False))
    assert speeds(found) == [0.25, 0.5, 0.75, 1.0, 0.0, 0.75]


@pytest.mark.parametrize(
    ("loud", "speed"), [(0.0, 0.0), (20e-6, 0.0), (50e-6, 0.5), (65e-6, 0.75), (80e-6, 1.0), (1.0, 1.0)]
)
def test_speed_grows_between_10_and_70_percent_of_what_the_class_had_in_training(
    loud: float, speed: float
) -> None:
    decision = Decider(LABELS, RANGES).decide(0, sure("close"), loud)
    assert decision.speed == pytest.approx(speed, abs=1e-9)


def test_a_class_that_was_always_as_loud_moves_when_it_is() -> None:
    steady = Range(5e-6, 5e-6)
    assert [steady.speed(loud) for loud in (4e-6, 5e-6, 6e-6)] == [0.0, 1.0, 1.0]


def test_rest_has_no_speed_however_loud() -> None:
    assert speeds(decided("rr", Deciding(proportional=False))) == [0.0, 0.0]


def test_what_cannot_be_decided_rests_and_begins_anew() -> None:
    decider = Decider(LABELS, RANGES, Deciding(votes=3, flutter=2, ramp=2, proportional=False))
    for k in range(6):
        before = decider.decide(k, sure("close"), LOUD)
    refused = decider.refuse(6, "samples are missing")
    again = [decider.decide(7 + k, sure("close"), LOUD) for k in range(5)]
    assert (before.label, before.speed) == ("close", 1.0)
    assert refused == Decision(6, REST, 0.0, {}, REST, False, "samples are missing")
    assert said(again) == "rrccc"
    assert speeds(again) == [0.0, 0.0, 0.5, 1.0, 1.0]


def test_a_model_without_rest_rests_when_it_is_not_sure() -> None:
    decider = Decider(("close", "open"), RANGES, Deciding(reject_below=0.8, ramp=3))
    assert decider.decide(0, [0.6, 0.4], LOUD).label == REST


@settings(max_examples=50, deadline=None)
@given(
    st.text("corCOR", max_size=40),
    st.builds(
        Deciding,
        reject_below=st.sampled_from([0.0, 0.6]),
        votes=st.sampled_from([1, 3, 5]),
        flutter=st.integers(1, 4),
        ramp=st.integers(0, 5),
        ramp_down=st.integers(1, 3),
        proportional=st.booleans(),
    ),
)
def test_speed_is_a_share_and_rest_or_rejection_never_has_any(letters: str, deciding: Deciding) -> None:
    for decision in decided(letters, deciding):
        assert 0 <= decision.speed <= 1
        assert decision.label == REST or not decision.rejected
        assert decision.speed == 0 or decision.label != REST


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ({"reject_below": 1.5}, "reject_below is 1.5; it must be from 0 to 1"),
        ({"reject_below": float("nan")}, "reject_below is nan"),
        ({"votes": 4}, "votes is 4; .* make it odd"),
        ({"votes": 33}, "votes is 33; it must be from 1 to 31"),
        ({"flutter": 0}, "flutter is 0; it must be from 1 to 20"),
        ({"ramp": -1}, "ramp is -1"),
        ({"ramp_down": 0}, "ramp_down is 0"),
    ],
)
def test_settings_out_of_bounds_are_told(values: dict[str, float], sentence: str) -> None:
    with pytest.raises(ConfigError, match=sentence):
        Deciding(**values)  # type: ignore[arg-type]
