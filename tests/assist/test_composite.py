"""Several assists as one."""

from dataclasses import replace

import pytest

from bentod import registry
from bentod.assist.composite import combining
from bentod.contracts_assist import Assist, AssistSettings
from bentod.errors import BadRequest, ConfigError
from tests.assist.situations import ELBOW, SHOULDER, SPECS, Told, situation, velocities

USES = {"arm.use.shoulder": 0.2, "arm.use.elbow": 0.7, "arm.use.together": 0.0}
OUTLOOK = Told((0.8, 0.2, 0.0), answers=USES)
SETTINGS = AssistSettings(k=0.1, manual=0.0)


def opened(mode: str, settings: AssistSettings = SETTINGS) -> Assist:
    return combining(registry.open_assist)(mode)(SPECS, 30.0, settings)


def test_one_part_moves_and_another_orders_and_one_sentence_tells_of_both() -> None:
    assist, now = opened("dpcc+adaptive_switching"), situation(OUTLOOK, attended=SHOULDER)
    helped = assist.wish(now)
    assert velocities(helped) == pytest.approx({ELBOW: 0.6})
    assert assist.order(now) == (ELBOW, -1, SHOULDER)
    assert helped.reason == (
        "Moves elbow to where the operator usually has it; the next toggle goes to elbow (0.70), by need."
    )


def test_all_joints_together_are_moved_by_the_part_that_offers_them() -> None:
    assist = opened("dpcc+trajectory", replace(SETTINGS, options={"trajectory-after": 0.0}))
    assert velocities(assist.wish(situation(OUTLOOK, attended=SHOULDER))) == pytest.approx({ELBOW: 0.6})
    assert assist.offers_together()
    pushed = assist.wish(situation(OUTLOOK, effort=0.5, together=True))
    assert velocities(pushed) == pytest.approx({SHOULDER: 1.0, ELBOW: 0.25})
    assert pushed.reason == "Pushed along the learned path: shoulder, elbow; confidence 0.90."
    lost = assist.wish(situation(replace(OUTLOOK, sure=0.1), effort=0.5, together=True))
    assert lost.wishes == {}


def test_a_change_that_one_part_refuses_changes_no_part() -> None:
    assist = opened("trajectory+adaptive_switching", replace(SETTINGS, options={"trajectory-after": 0.0}))
    wrong = {"trajectory-after": 9.0, "adaptive_switching-effort": 5.0}
    with pytest.raises(BadRequest, match="effort"):
        assist.adjust(replace(SETTINGS, options=wrong))
    assist.wish(situation(OUTLOOK))
    assert assist.offers_together()


def test_an_option_for_none_of_the_parts_is_refused() -> None:
    with pytest.raises(BadRequest, match="has no option 'after': begin it with what it is for"):
        opened("dpcc+trajectory", replace(SETTINGS, options={"after": 0.0}))


@pytest.mark.parametrize("mode", ["dpcc+dpcc", "dpcc+off", "dpcc+", "dpcc+nothing"])
def test_what_cannot_be_combined_is_refused(mode: str) -> None:
    with pytest.raises(ConfigError):
        opened(mode)
