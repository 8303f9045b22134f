"""Classes of contractions that move several joints: what they ask, and that others come first."""

import pytest

from bentod.control.groups import Groups
from bentod.control.operators import Asked
from bentod.frames import JointSpec, Velocity
from tests.fakes import SPECS, Bench

GROUPS = Groups(
    [JointSpec(name, -1.0, 1.0, top, 0.0, {}) for name, top in (("turn", 1.0), ("bend", 0.5), ("grip", 2.0))],
    {"hand": ["turn", "bend", "grip"], "grip": ["grip"]},
)


def test_effort_scales_every_joint_of_a_synergy_by_its_share_and_top_speed() -> None:
    wishes = GROUPS.wishes({"hand": 0.5}, {"hand": {"turn": 1.0, "bend": -0.4}})
    assert wishes == {0: Velocity(0.5), 1: Velocity(-0.1)}


def test_no_effort_asks_nothing_and_groups_without_moves_move_their_active_joint() -> None:
    assert GROUPS.wishes({"hand": 0.0, "grip": -0.5}, {"hand": {"turn": 1.0}}) == {2: Velocity(-1.0)}


@pytest.mark.parametrize("share", [3.0, -3.0])
def test_nothing_is_faster_than_the_joint(share: float) -> None:
    ((_, wish),) = GROUPS.wishes({"hand": 1.0}, {"hand": {"grip": share}}).items()
    assert isinstance(wish, Velocity)
    assert abs(wish.velocity) == 2.0


def asked(effort: float) -> dict[str, Asked]:
    return {"emg": Asked({"arm": effort}, moves={"arm": {"shoulder": 0.5, "elbow": -0.5}})}


async def test_a_recognised_class_moves_joints_that_are_not_active() -> None:
    desk = Bench().desk
    desk.operate(asked(0.0))
    top = SPECS[0].max_velocity
    assert desk.operate(asked(1.0))["emg"] == {0: Velocity(0.5 * top), 1: Velocity(-0.5 * top)}
    assert desk.driver(desk.groups.group("arm")) == ("emg", 1.0)


async def test_a_released_joint_waits_until_the_class_was_at_rest() -> None:
    desk = Bench().desk
    desk.pause((1,), True)
    desk.pause((1,), False)
    assert desk.operate(asked(1.0))["emg"] == {}
    desk.operate(asked(0.0))
    assert desk.operate(asked(1.0))["emg"].keys() == {0, 1}


async def test_classes_move_nothing_while_all_joints_are_selected_together() -> None:
    desk = Bench().desk
    desk.operate(asked(0.0))
    desk.groups.group("arm").together = True
    desk.mind.offers_together = lambda group: True  # type: ignore[method-assign]
    assert desk.operate(asked(1.0))["emg"] == {}
    assert desk.driver(desk.groups.group("arm"))[1] == 0.0
