"""Learners and assist between a reading and a wish: old readings, gaps, toggles, bugs."""

import math
from collections.abc import Collection
from weakref import WeakKeyDictionary

import pytest

from bentod.config_learn import Learn
from bentod.config_tables import Assist
from bentod.control.groups import Groups
from bentod.errors import BadRequest, Refused
from bentod.frames import EmgFrame, State, Value, Velocity
from bentod.learn.horde import HasTime, Horde, unhurried
from bentod.learn.pupils import Together
from bentod.learn.signals import Percept
from bentod.mind import Helped, Mind
from tests.fakes import PERIOD, SPECS, at

BOTH = ("shoulder", "elbow")
LEARN = Learn(joints=BOTH, timescales=(10.0, 20.0))
ASSIST = Assist(group="arm", timescale=20.0)
SHOULDER, ELBOW = 0, 1
NO_EMG = EmgFrame(False, False, "", 0, 0.0, 0, {}, 0)
TICKS: WeakKeyDictionary[Mind, int] = WeakKeyDictionary()
"""The newest tick of each mind."""


def mind_of(learn: Learn | None = LEARN, assist: Assist | None = ASSIST) -> Mind:
    return Mind(SPECS, 1 / PERIOD, Groups(SPECS, {"arm": BOTH}), learn, [assist] if assist else ())


def watch(mind: Mind, shoulder: float, elbow: float, steps: int = 1, stale: tuple[int, ...] = ()) -> None:
    """Show the same reading for a while."""
    for _ in range(steps):
        show(mind, at(shoulder, elbow, stale=stale))
        mind.learn()


def show(mind: Mind, state: State, has_time: HasTime = unhurried, missed: int = 0, gap: bool = False) -> None:
    """Begin the next tick, after `missed` ones; `gap`: the one before broke."""
    tick = TICKS.get(mind, -1) + 1 + missed
    TICKS[mind] = tick
    mind.predict(Percept(tick, tick * PERIOD, gap or missed > 0, state, NO_EMG, ()), has_time)


def helped_by(mind: Mind, state: State, moving: Collection[int]) -> Helped:
    """What the assists ask for while the operator moves the joints `moving`."""
    tick = TICKS.get(mind, 0)
    return mind.assist(Percept(tick, tick * PERIOD, False, state, NO_EMG, ()), moving)


@pytest.fixture
def cuts(monkeypatch: pytest.MonkeyPatch) -> list[Together]:
    """Grows whenever learners are told to forget the step before; there are those of two timescales."""
    cut: list[Together] = []
    monkeypatch.setattr(Together, "cut", lambda pupils: cut.append(pupils))
    return cut


def test_each_joint_is_predicted_at_each_timescale() -> None:
    mind = mind_of()
    watch(mind, 0.0, 0.0)
    assert mind.predictions(SHOULDER).keys() == {"10", "20"}
    assert mind.predictions(ELBOW).keys() == {"10", "20"}


def test_before_anything_is_learned_a_joint_is_expected_near_its_minimum() -> None:
    mind = mind_of()
    watch(mind, 0.5, 0.5)
    assert mind.predictions(SHOULDER)["20"] == pytest.approx(-1.0, abs=0.1)


def test_a_joint_that_rests_is_soon_expected_where_it_is() -> None:
    mind = mind_of()
    watch(mind, 0.3, -0.4, steps=300)
    assert mind.predictions(SHOULDER)["20"] == pytest.approx(0.3, abs=0.05)
    assert mind.predictions(ELBOW)["20"] == pytest.approx(-0.4, abs=0.05)


def test_only_the_joints_that_are_asked_for_are_predicted() -> None:
    mind = mind_of(Learn(joints=BOTH, predict=("elbow",)))
    watch(mind, 0.0, 0.0)
    assert mind.predictions(SHOULDER) == {}
    assert mind.predictions(ELBOW).keys() == {"20"}


def test_the_features_need_fresh_readings_and_until_then_the_last_predictions_stand(
    cuts: list[Together],
) -> None:
    mind = mind_of()
    watch(mind, 0.0, 0.0, steps=10)
    before = mind.predictions(ELBOW)
    watch(mind, 0.9, 0.0, steps=5, stale=(SHOULDER,))
    assert mind.predictions(ELBOW) == before
    assert len(cuts) == 2 + 2 + 5 * 2  # twice in the first tick, then as long as blind


@pytest.mark.parametrize("missed", [3, 300])
def test_a_long_gap_between_two_readings_is_not_learned_from(cuts: list[Together], missed: int) -> None:
    mind = mind_of()
    watch(mind, 0.0, 0.0, steps=2)
    cuts.clear()
    show(mind, at(0.5, 0.5), missed=missed)
    mind.learn()
    assert len(cuts) == 2


def test_a_tick_that_broke_is_not_learned_across(cuts: list[Together]) -> None:
    mind = mind_of()
    watch(mind, 0.0, 0.0, steps=2)
    cuts.clear()
    show(mind, at(0.5, 0.5), gap=True)
    mind.learn()
    assert len(cuts) == 2


@pytest.mark.parametrize("missed", [1, 2])
def test_a_missed_tick_or_two_are_bridged(cuts: list[Together], missed: int) -> None:
    mind = mind_of()
    watch(mind, 0.0, 0.0, steps=2)
    cuts.clear()
    show(mind, at(0.5, 0.5), missed=missed)
    mind.learn()
    assert not cuts


def test_an_arm_of_which_every_other_tick_is_missed_is_predicted_as_far_ahead_in_time() -> None:
    whole, every_other = mind_of(), mind_of()
    for tick in range(4000):
        state = at(math.sin(tick / 15), 0.0)
        show(whole, state)
        whole.learn()
        if tick % 2:
            show(every_other, state, missed=1)
            every_other.learn()
    for timescale in ("10", "20"):
        expected = whole.predictions(SHOULDER)[timescale]
        assert every_other.predictions(SHOULDER)[timescale] == pytest.approx(expected, abs=0.1)


def test_a_joint_that_is_only_predicted_teaches_nothing_while_its_reading_is_old() -> None:
    mind = mind_of(Learn(joints=("shoulder",), predict=BOTH))
    watch(mind, 0.4, 0.9, steps=300, stale=(ELBOW,))
    assert mind.predictions(SHOULDER)["20"] == pytest.approx(0.4, abs=0.05)
    assert mind.predictions(ELBOW)["20"] == pytest.approx(-1.0, abs=0.1)
    watch(mind, 0.4, 0.9, steps=300)
    assert mind.predictions(ELBOW)["20"] == pytest.approx(0.9, abs=0.05)


def test_readings_that_are_not_numbers_do_not_spoil_what_was_learned() -> None:
    mind = mind_of(Learn(joints=("shoulder",), predict=BOTH))
    watch(mind, 0.4, 0.5, steps=100)
    watch(mind, 0.4, math.nan, steps=10)
    assert math.isfinite(mind.predictions(ELBOW)["20"])


def test_the_unattended_joint_is_sent_to_where_it_is_expected_while_the_other_moves() -> None:
    mind = mind_of()
    watch(mind, 0.0, 0.2, steps=300)
    away = at(0.0, 0.6)
    helped = helped_by(mind, away, {SHOULDER})
    assert helped.frames[0].engaged
    velocity = (mind.predictions(ELBOW)["20"] - 0.6) * 30 * 0.025  # thesis (5.1)
    assert helped.wishes == {ELBOW: Velocity(velocity)}
    assert helped_by(mind, away, ()).wishes == {}


def test_the_wearers_own_joint_is_never_helped_even_if_a_client_moves_the_other() -> None:
    mind = mind_of()
    watch(mind, 0.0, 0.2, steps=300)
    assert SHOULDER not in helped_by(mind, at(0.5, 0.6), {SHOULDER, ELBOW}).wishes


def test_predictions_from_old_readings_move_nothing() -> None:
    mind = mind_of()
    watch(mind, 0.0, 0.2, steps=100)
    watch(mind, 0.0, 0.2, stale=(ELBOW,))
    helped = helped_by(mind, at(0.0, 0.6), {SHOULDER})
    assert (helped.wishes, helped.frames[0].engaged) == ({}, False)


def test_after_a_toggle_help_waits_for_as_long_as_was_agreed() -> None:
    mind = mind_of()
    watch(mind, 0.0, 0.2, steps=300)
    mind.toggled("arm", 10.0)
    assert (
        helped_by(mind, at(0.0, 0.6, time=10.4), {SHOULDER}).frames[0].reason
        == "Manual for 0.5 s after a toggle."
    )
    assert helped_by(mind, at(0.0, 0.6, time=10.6), {SHOULDER}).wishes


def test_without_tables_there_is_neither_prediction_nor_help() -> None:
    mind = mind_of(None, None)
    watch(mind, 0.0, 0.0)
    mind.toggled("arm", 0.0)
    assert mind.predictions(SHOULDER) == {}
    assert helped_by(mind, at(0.0, 0.0), {SHOULDER}).frames[0].reason == "The config has no [assist] table."
    assert mind.describe() == {"mode": "off"}
    with pytest.raises(Refused, match="no \\[assist\\] and \\[learn\\] tables"):
        mind.change({"k": 0.1})


def test_learning_goes_on_while_assist_is_switched_off() -> None:
    mind = mind_of()
    mind.change({"mode": "off"})
    watch(mind, 0.3, -0.4, steps=300)
    assert mind.predictions(SHOULDER)["20"] == pytest.approx(0.3, abs=0.05)
    off = helped_by(mind, at(0.3, 0.6), {SHOULDER})
    assert (off.wishes, off.frames[0].mode) == ({}, "off")
    mind.change({"mode": "dpcc"})
    assert helped_by(mind, at(0.3, 0.6), {SHOULDER}).wishes


def test_a_learner_that_breaks_is_left_alone_and_the_reason_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    mind = mind_of()
    watch(mind, 0.0, 0.2, steps=10)

    def break_down(horde: Horde, *step: object) -> None:
        raise ZeroDivisionError("oops")

    with monkeypatch.context() as patch:
        patch.setattr(Horde, "step", break_down)
        watch(mind, 0.0, 0.2)
    watch(mind, 0.0, 0.2, steps=10)
    helped = helped_by(mind, at(0.0, 0.6), {SHOULDER})
    assert helped.wishes == {}
    assert helped.frames[0].reason == "Learning broke and is off: ZeroDivisionError: oops"


def test_the_timescale_that_the_assist_follows_learns_first_and_the_longest_last() -> None:
    mind = mind_of(Learn(joints=BOTH, timescales=(10.0, 40.0, 20.0)))
    for _ in range(300):
        show(mind, at(0.3, -0.4))
        mind.learn(iter([True, False]).__next__)
    assert mind.shed == 300
    expected = {"10": 0.3, "40": -1.0, "20": 0.3}  # where it is; the joint's minimum, as before any learning
    assert mind.predictions(SHOULDER) == pytest.approx(expected, abs=0.1)


def test_with_no_time_at_all_the_assist_still_follows_what_was_learned() -> None:
    mind = mind_of()
    watch(mind, 0.0, 0.2, steps=300)
    show(mind, at(0.0, 0.6), lambda: False)
    helped = helped_by(mind, at(0.0, 0.6), {SHOULDER})
    assert helped.frames[0].engaged
    assert helped.wishes.keys() == {ELBOW}
    assert mind.shed == 1


def test_another_timescale_for_the_assist_is_learned_first_from_then_on() -> None:
    mind = mind_of()
    mind.change({"timescale": 10.0})
    show(mind, at(0.0, 0.0))
    assert mind.predictions(ELBOW).keys() == {"10"}
    mind.learn()
    assert list(mind.predictions(ELBOW)) == ["10", "20"]


def test_nothing_is_learned_from_an_old_reading_after_the_write_either(cuts: list[Together]) -> None:
    mind = mind_of()
    watch(mind, 0.0, 0.0)
    before = mind.predictions(ELBOW)
    watch(mind, 0.9, 0.9, stale=(SHOULDER,))
    assert mind.predictions(ELBOW) == before


def test_the_time_for_learning_is_a_share_of_the_period() -> None:
    assert mind_of(Learn(joints=BOTH, budget=0.5)).budget == pytest.approx(0.5 * PERIOD)


def test_what_is_not_changed_stays() -> None:
    mind = mind_of()
    before = mind.describe()
    mind.change({"k": 0.1, "timescale": 10.0})
    assert mind.describe() == before | {"k": 0.1, "timescale": 10.0}
    mind.change({"velocity_limit_rad_s": 0.2, "manual_after_toggle_s": 0.0})
    assert mind.describe() == before | {
        "k": 0.1,
        "timescale": 10.0,
        "velocity_limit_rad_s": 0.2,
        "manual_after_toggle_s": 0.0,
    }


def test_a_velocity_limit_holds_from_then_on() -> None:
    mind = mind_of()
    watch(mind, 0.0, -0.9, steps=300)
    mind.change({"velocity_limit_rad_s": 0.05})
    assert helped_by(mind, at(0.0, 0.6), {SHOULDER}).wishes == {ELBOW: Velocity(-0.05)}


@pytest.mark.parametrize(
    ("changes", "field"), [({"timescale": 15.0}, "timescale"), ({"k": 1.0}, "k"), ({"k": 0.0}, "k")]
)
def test_a_wrong_value_is_refused_by_name_and_changes_nothing(changes: dict[str, Value], field: str) -> None:
    mind = mind_of()
    before = mind.describe()
    with pytest.raises(BadRequest) as caught:
        mind.change({"mode": "off", **changes})
    assert caught.value.field == field
    assert mind.describe() == before
