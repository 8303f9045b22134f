"""Unattended joints move as the operator is expected to move them, within the bounds of any assist."""

import math
from dataclasses import dataclass, replace

import pytest

from bentod.assist.effort import EffortAssist, effort_of, open_assist
from bentod.contracts_assist import Asking, Assistance, AssistSettings, Situation
from bentod.errors import BadRequest
from bentod.frames import JointSpec, Velocity
from tests.fakes import at

SHOULDER, ELBOW, WRIST = range(3)
NAMES = ("shoulder", "elbow", "wrist")
SPECS = tuple(JointSpec(name, -1.5, 1.5, 0.5, 0.0, {}) for name in NAMES)
SETTINGS = AssistSettings(timescale=20.0)


@dataclass(frozen=True)
class Expected:
    """Efforts that are expected, by joint."""

    efforts: dict[int, float]
    timescales: tuple[float, ...] = (20.0,)

    def answer(self, name: str) -> float:
        known = {effort_of("arm", NAMES[joint], 20): effort for joint, effort in self.efforts.items()}
        return known.get(name, math.nan)

    def position(self, joint: int, timescale: float) -> float:
        return math.nan

    confidence = surprise = position

    def familiarity(self) -> float:
        return math.nan


def situation(efforts: dict[int, float], attended: int | None = SHOULDER, time: float = 100.0) -> Situation:
    state = at(0.0, 0.0, 0.0, time=time)
    outlook = Expected(efforts)
    joints = (SHOULDER, ELBOW, WRIST)
    return Situation(time, 30.0, joints, SHOULDER, attended, 1.0, False, state, outlook, group="arm")


def ask(assist: EffortAssist, efforts: dict[int, float], attended: int | None = SHOULDER) -> Assistance:
    return assist.wish(situation(efforts, attended))


def test_a_joint_moves_at_the_share_of_its_speed_that_is_expected_to_be_asked() -> None:
    helped = ask(open_assist(SPECS, 30.0, SETTINGS), {SHOULDER: 1.0, ELBOW: 0.4, WRIST: -0.2})
    assert helped.wishes == {ELBOW: Velocity(0.2), WRIST: Velocity(-0.1)}
    assert helped.engaged
    assert (
        helped.reason == "Moves elbow (+40% effort), wrist (-20% effort) as the operator is expected to ask."
    )


def test_it_asks_what_will_be_asked_of_each_joint_and_only_while_that_is_active() -> None:
    assist = open_assist(SPECS, 30.0, SETTINGS)
    assert isinstance(assist, Asking)
    tables = assist.asks("arm", ("shoulder", "elbow"))
    assert [table["name"] for table in tables] == ["arm.effort_of.shoulder@20", "arm.effort_of.elbow@20"]
    assert tables[1]["cumulant"] == "'arm.effort' * 'arm.active.elbow'"


@pytest.mark.parametrize("attended", [None, 7])
def test_nothing_moves_unless_the_operator_moves_a_joint_of_the_group(attended: int | None) -> None:
    helped = ask(open_assist(SPECS, 30.0, SETTINGS), {ELBOW: 1.0}, attended)
    assert (helped.wishes, helped.engaged) == ({}, False)


def test_after_a_toggle_it_is_manual_for_a_while() -> None:
    assist = open_assist(SPECS, 30.0, SETTINGS)
    assist.toggled(100.0)
    assert assist.wish(situation({ELBOW: 1.0}, time=100.4)).reason == "Manual for 0.5 s after a toggle."
    assert assist.wish(situation({ELBOW: 1.0}, time=100.5)).wishes


def test_an_effort_that_nobody_can_make_is_no_faster_than_the_joint_or_the_settings_allow() -> None:
    assist = open_assist(SPECS, 30.0, SETTINGS)
    assert ask(assist, {ELBOW: 9.0, WRIST: -9.0}).wishes == {ELBOW: Velocity(0.5), WRIST: Velocity(-0.5)}
    assist.adjust(replace(SETTINGS, velocity_limit=0.1))
    assert ask(assist, {ELBOW: 9.0}).wishes == {ELBOW: Velocity(0.1)}


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_an_expectation_that_is_no_number_moves_nothing(value: float) -> None:
    helped = ask(open_assist(SPECS, 30.0, SETTINGS), {ELBOW: value})
    assert (helped.wishes, helped.engaged) == ({}, False)
    assert helped.reason == "Nobody knows yet what will be asked at 20 ticks."


def test_a_joint_sets_off_at_twice_the_speed_at_which_it_is_let_go() -> None:
    assist = open_assist(SPECS, 30.0, SETTINGS)
    moved = [bool(ask(assist, {ELBOW: effort}).wishes) for effort in (0.03, 0.06, 0.03, 0.01, 0.03)]
    assert moved == [False, True, True, False, False]


def test_the_gain_multiplies_what_is_expected_and_other_options_are_refused() -> None:
    assist = open_assist(SPECS, 30.0, replace(SETTINGS, options={"gain": 2.0}))
    assert ask(assist, {ELBOW: 0.3}).wishes == {ELBOW: Velocity(0.3)}
    for options in ({"gain": -1.0}, {"gain": math.nan}, {"pain": 1.0}):
        with pytest.raises(BadRequest) as caught:
            assist.adjust(replace(SETTINGS, options=options))
        assert caught.value.field == "options"
    assert ask(assist, {ELBOW: 0.3}).wishes == {ELBOW: Velocity(0.3)}
