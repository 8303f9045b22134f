"""All joints of a group pushed and pulled along a learned path (thesis 6.4)."""

import math
from dataclasses import replace
from itertools import count

import pytest

from bentod.assist.trajectory import Trajectory, open_assist
from bentod.contracts_assist import Assistance, AssistSettings
from bentod.errors import BadRequest
from bentod.frames import Freshness
from tests.assist.situations import ELBOW, PERIOD, SHOULDER, SPECS, Told, situation, velocities

SETTINGS = AssistSettings(manual=0.0)
AHEAD = Told((0.8, 0.2, 0.0))


def ready(settings: AssistSettings = SETTINGS) -> Trajectory:
    """One that has been sure for long enough."""
    assist = open_assist(SPECS, 30.0, settings)
    for now in (0.0, 0.5, 1.0):
        assist.wish(situation(AHEAD, now))
    assert assist.offers_together()
    return assist


def push(assist: Trajectory, effort: float, outlook: Told = AHEAD, **changes: object) -> Assistance:
    return assist.wish(replace(situation(outlook, effort=effort, together=True), **changes))  # type: ignore[arg-type]


def test_pushing_moves_all_joints_in_proportion_to_their_ways() -> None:
    helped = push(ready(), 0.5)
    assert velocities(helped) == pytest.approx({SHOULDER: 1.0, ELBOW: 0.25})
    assert helped.engaged
    assert helped.reason == "Pushed along the learned path: shoulder, elbow; confidence 0.90."


@pytest.mark.parametrize("effort", [0.1, 0.5, 1.0, 7.0])
@pytest.mark.parametrize("target", [(0.9, 0.2), (0.2, -0.9), (-1.4, 1.4)])
def test_the_joint_that_needs_longest_goes_at_the_effort_and_none_faster(
    effort: float, target: tuple[float, float]
) -> None:
    wished = velocities(push(ready(), effort, Told((*target, 0.0))))
    shares = [abs(wished[j]) / SPECS[j].max_velocity for j in (SHOULDER, ELBOW)]
    assert max(shares) == pytest.approx(min(effort, 1.0))
    assert wished[SHOULDER] * target[1] == pytest.approx(wished[ELBOW] * target[0])


def test_the_velocity_limit_of_the_settings_holds_for_every_joint() -> None:
    wished = velocities(push(ready(replace(SETTINGS, velocity_limit=0.3)), 1.0))
    assert max(map(abs, wished.values())) == pytest.approx(0.3)


def test_a_prediction_beyond_a_limit_leads_to_the_limit() -> None:
    helped = push(ready(), 1.0, Told((1.5, 99.0, 0.0)), state=situation(AHEAD, positions=(1.5, 1.5, 0)).state)
    assert helped.wishes == {}
    assert helped.reason == "All joints are where they are expected: nothing lies ahead."


def test_the_last_of_the_way_is_gone_slower_and_never_beyond_it() -> None:
    assist, position = ready(), 0.0
    for tick in range(90):
        here = situation(AHEAD, positions=(position, 0.2, 0.0)).state
        position += velocities(push(assist, 1.0, state=here, time=200 + tick / 30)).get(SHOULDER, 0) / 30
        assert position <= 0.8
    assert position == pytest.approx(0.8, abs=0.01)


def test_nothing_moves_without_effort_or_while_one_joint_is_selected() -> None:
    assist = ready()
    for helped in (
        push(assist, 0.0),
        push(assist, math.nan),
        assist.wish(situation(AHEAD, effort=1.0)),
        assist.wish(situation(AHEAD, effort=1.0, attended=SHOULDER)),
    ):
        assert (helped.wishes, helped.engaged) == ({}, False)


def test_pulling_goes_back_by_the_way_that_the_arm_came_round_its_corner() -> None:
    assist = ready()
    came = [(0.02 * i, 0.0) for i in range(30)] + [(0.6, 0.02 * i) for i in range(30)]
    for i, (shoulder, elbow) in enumerate(came):
        assist.wish(situation(AHEAD, 2 + i / 30, (shoulder, elbow, 0.0)))
    shoulder, elbow = came[-1]
    off_path, seen = 0.0, []
    for tick in count():
        helped = push(
            assist, -0.5, time=10 + tick * PERIOD, state=situation(AHEAD, 0, (shoulder, elbow, 0)).state
        )
        if not helped.wishes:
            break
        wished = velocities(helped)
        shoulder += wished.get(SHOULDER, 0.0) * PERIOD
        elbow += wished.get(ELBOW, 0.0) * PERIOD
        off_path = max(off_path, min(max(abs(shoulder - a), abs(elbow - b)) for a, b in came))
        seen.append(helped.reason)
        assert tick < 300
    assert seen[0] == "Pulled back along the way it came: elbow."
    assert seen[-1] == "Pulled back along the way it came: shoulder."
    assert helped.reason == "Pulled back as far as the way is remembered."
    assert max(abs(shoulder), abs(elbow)) < 0.06
    assert off_path < 0.05


def test_a_leap_that_nobody_watched_is_not_gone_back_across() -> None:
    assist = ready()
    for i in range(20):
        assist.wish(situation(AHEAD, 2 + i / 30, (0.02 * i, 0.0, 0.0)))
    assist.wish(situation(AHEAD, 5.0, (1.2, 0.0, 0.0)))
    helped = push(assist, -1.0, state=situation(AHEAD, 6, (1.2, 0.0, 0.0)).state)
    assert helped.wishes == {}
    assert helped.reason == "Pulled back as far as the way is remembered."


def test_what_is_remembered_of_the_way_is_bounded() -> None:
    assist = ready()
    for i in range(6000):
        assist.wish(situation(AHEAD, 2 + i / 30, (math.sin(i / 20), math.cos(i / 20), 0.0)))
    assert assist.told()["way_back"] == 2048


def test_it_is_offered_once_it_was_sure_for_a_while_and_until_it_is_clearly_not() -> None:
    assist = open_assist(SPECS, 30.0, SETTINGS)
    offers = []
    for now, sure in (
        (0.0, 0.8),
        (0.9, 0.8),
        (0.95, 0.7),
        (1.0, 0.8),
        (1.9, 0.8),
        (2.0, 0.8),
        (2.1, 0.7),
        (2.2, 0.64),
    ):
        assist.wish(situation(replace(AHEAD, sure=sure), now))
        offers.append(assist.offers_together())
    assert offers == [False, False, False, False, False, True, True, False]


@pytest.mark.parametrize("doubt", [{"sure": 0.5}, {"known": 0.3}, {"sure": math.nan}, {"known": math.nan}])
def test_lost_confidence_stops_all_joints_at_once_and_says_so(doubt: dict[str, float]) -> None:
    assist = ready()
    assert push(assist, 1.0).wishes
    helped = push(assist, 1.0, replace(AHEAD, **doubt))  # type: ignore[arg-type]
    assert (helped.wishes, assist.offers_together()) == ({}, False)
    assert helped.reason.startswith("All joints stop and fall back to one. The way is not known well enough")


def test_doubt_does_not_stop_who_pulls_back_but_ends_the_offer_when_they_rest() -> None:
    assist = ready()
    for i in range(30):
        assist.wish(situation(AHEAD, 2 + i / 30, (0.02 * i, 0.0, 0.0)))
    here = situation(AHEAD, positions=(0.6, 0.0, 0.0)).state
    assert velocities(push(assist, -1.0, replace(AHEAD, sure=0.1), state=here)) == {SHOULDER: -2.0}
    push(assist, 0.0, replace(AHEAD, sure=0.1), state=here)
    assert not assist.offers_together()


@pytest.mark.parametrize("effort", [1.0, -1.0])
@pytest.mark.parametrize("bad", [math.nan, math.inf])
def test_a_prediction_that_is_not_finite_stops_pushing_and_pulling_at_once(bad: float, effort: float) -> None:
    assist = ready()
    for i in range(30):
        assist.wish(situation(AHEAD, 2 + i / 30, (0.02 * i, 0.0, 0.0)))
    here = situation(AHEAD, positions=(0.6, 0.0, 0.0)).state
    assert push(assist, effort, state=here).wishes
    assert push(assist, effort, Told((0.8, bad, 0.0)), state=here).wishes == {}
    assert not assist.offers_together()


def test_a_joint_that_was_not_read_stops_all_of_them() -> None:
    stale = situation(AHEAD, freshness=Freshness.STALE).state
    assert push(ready(), 1.0, state=stale).wishes == {}


def test_a_joint_that_somebody_moves_by_itself_stops_the_others() -> None:
    helped = push(ready(), 1.0, attended=ELBOW)
    assert (helped.wishes, helped.reason) == ({}, "Waits: elbow is moved by itself.")


def test_it_waits_for_a_while_after_a_toggle() -> None:
    assist = ready(replace(SETTINGS, manual=0.5))
    assist.toggled(100.0)
    assert push(assist, 1.0, time=100.4).reason == "Waits 0.5 s after a toggle."
    assert push(assist, 1.0, time=100.5).wishes


@pytest.mark.parametrize(("name", "value"), [("confidence", 1.1), ("after", -1), ("confidance", 0.5)])
def test_an_option_out_of_bounds_or_unknown_is_refused_and_changes_nothing(name: str, value: float) -> None:
    assist = ready()
    with pytest.raises(BadRequest, match=name) as refusal:
        assist.adjust(replace(SETTINGS, options={name: value}))
    assert refusal.value.field == name
    assert push(assist, 1.0).wishes
