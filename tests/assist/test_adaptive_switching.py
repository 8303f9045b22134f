"""The order of toggling by predicted use (Edwards et al. 2016)."""

import math
from dataclasses import replace

import pytest

from bentod.assist.adaptive_switching import AdaptiveSwitching, open_assist
from bentod.config_learn import Gvf
from bentod.contracts_assist import TOGETHER, AssistSettings, Situation
from bentod.errors import BadRequest
from tests.assist.situations import ELBOW, SHOULDER, SPECS, WRIST, Told, situation

ALL = (SHOULDER, ELBOW, WRIST)


def needs(shoulder: float, elbow: float, wrist: float, together: float = 0.0) -> Told:
    told = {"shoulder": shoulder, "elbow": elbow, "wrist": wrist, "together": together}
    return Told(answers={f"arm.use.{name}": need for name, need in told.items()})


def at(outlook: Told, active: int = SHOULDER, **changes: object) -> Situation:
    return replace(situation(outlook, active=active, joints=ALL), **changes)  # type: ignore[arg-type]


def switching() -> AdaptiveSwitching:
    return open_assist(SPECS, 30.0, AssistSettings())


def test_the_most_needed_joint_comes_first_and_the_present_one_last() -> None:
    assist, now = switching(), at(needs(0.9, 0.1, 0.6, 0.3))
    helped = assist.wish(now)
    assert assist.order(now) == (WRIST, TOGETHER, ELBOW, SHOULDER)
    assert (helped.wishes, helped.engaged) == ({}, False)
    assert helped.reason == "The next toggle goes to wrist (0.60), then to elbow (0.10), by need."


def test_who_leaves_all_joints_gets_the_most_needed_one() -> None:
    assist, now = switching(), at(needs(0.2, 0.7, 0.1, 0.9), together=True)
    assist.wish(now)
    assert assist.order(now) == (ELBOW, SHOULDER, WRIST, TOGETHER)


def test_before_anything_is_known_the_order_is_that_of_the_list() -> None:
    assist, now = switching(), at(needs(0, 0, 0, 0), ELBOW)
    assist.wish(now)
    assert assist.order(now) == (WRIST, TOGETHER, SHOULDER, ELBOW)


def test_without_predictions_there_is_no_order() -> None:
    assist, now = switching(), at(needs(0.5, math.nan, 0.1))
    assert assist.wish(now).reason.startswith("Toggles go as the joints are listed")
    assert assist.order(now) is None


def test_the_order_stands_while_the_operator_toggles_on_and_is_made_anew_once_they_move() -> None:
    assist = switching()
    assist.wish(at(needs(0.9, 0.1, 0.6)))
    assist.toggled(100.0)
    turned = needs(0.9, 0.8, 0.0)
    helped = assist.wish(at(turned, WRIST))
    assert assist.order(at(turned, WRIST)) == (WRIST, ELBOW, TOGETHER, SHOULDER)
    assert helped.reason == "The next toggle goes to elbow (0.10), then to shoulder (0.90), by need."
    assist.wish(at(turned, WRIST, attended=WRIST))
    assert assist.order(at(turned, WRIST)) == (SHOULDER, ELBOW, TOGETHER, WRIST)


def test_pushing_all_joints_ends_a_sequence_of_toggles_too() -> None:
    assist = switching()
    assist.wish(at(needs(0.9, 0.1, 0.6)))
    assist.toggled(100.0)
    assist.wish(at(needs(0.1, 0.9, 0.6), together=True, effort=0.5))
    assert assist.order(at(needs(0, 0, 0))) == (ELBOW, WRIST, SHOULDER, TOGETHER)


def test_it_asks_how_much_each_joint_and_all_at_once_are_about_to_be_used() -> None:
    tables = [Gvf.model_validate(table) for table in switching().asks("arm", ["shoulder", "elbow"])]
    assert [table.name for table in tables] == ["arm.use.shoulder", "arm.use.elbow", "arm.use.together"]
    assert {(table.timescale, table.scaling) for table in tables} == {(60.0, "instantaneous")}


@pytest.mark.parametrize(("name", "value"), [("use_timescale", 1.0), ("effort", 1.0), ("efort", 0.1)])
def test_an_option_out_of_bounds_or_unknown_is_refused(name: str, value: float) -> None:
    with pytest.raises(BadRequest, match=name):
        switching().adjust(AssistSettings(options={name: value}))
