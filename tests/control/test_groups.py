import pytest

from bentod.contracts_assist import TOGETHER
from bentod.control.groups import Group, Groups
from bentod.errors import BadRequest
from bentod.frames import JointSpec, Velocity


def _groups() -> Groups:
    specs = [
        JointSpec(name, -1.0, 1.0, speed, 0.0, {}) for name, speed in (("a", 0.5), ("b", 2.0), ("c", 1.0))
    ]
    return Groups(specs, {"arm": ["b", "a"], "all": ["a", "b", "c"]})


def test_the_first_joint_of_the_list_is_active_at_the_start() -> None:
    assert _groups().group("arm").active == 1


def test_toggling_goes_round_the_list_in_both_directions() -> None:
    group = _groups().group("all")
    seen = []
    for steps in (1, 1, 1, -1):
        group.toggle(steps)
        seen.append(group.active)
    assert seen == [1, 2, 0, 2]


def test_an_effort_moves_the_active_joint_at_that_share_of_its_own_top_speed() -> None:
    groups = _groups()
    assert groups.wish("arm", 0.5) == {1: Velocity(1.0)}
    groups.group("arm").toggle(1)
    assert groups.wish("arm", -1.0) == {0: Velocity(-0.5)}


def test_no_effort_asks_for_nothing_and_too_much_is_cut() -> None:
    assert _groups().wish("arm", 0.0) == {}
    assert _groups().wish("arm", 7.0) == {1: Velocity(2.0)}


def test_a_joint_can_be_made_active_by_name_if_it_is_in_the_group() -> None:
    groups = _groups()
    assert groups.activate("arm", "a").active == 0
    with pytest.raises(BadRequest, match="has no joint 'c'"):
        groups.activate("arm", "c")
    with pytest.raises(BadRequest, match="no group 'leg'"):
        groups.group("leg")


def _toured(
    group: Group, toggles: int, order: tuple[int, ...] | None, offered: bool, steps: int = 1
) -> list[int]:
    seen = []
    for _ in range(toggles):
        group.toggle(steps, order, offered)
        seen.append(TOGETHER if group.together else group.active)
    return seen


@pytest.mark.parametrize(
    ("order", "expected"),
    [
        (None, [1, 2, TOGETHER, 0, 1]),
        ((2, 1, 0), [TOGETHER, 2, 1, 0, TOGETHER]),
        ((2, TOGETHER, 1, 0), [2, TOGETHER, 1, 0, 2]),
        ((2, 7, 2), [1, TOGETHER, 2, 0, 1]),
    ],
)
def test_all_joints_at_once_have_their_place_in_the_ring_while_they_are_offered(
    order: tuple[int, ...] | None, expected: list[int]
) -> None:
    assert _toured(_groups().group("all"), 5, order, offered=True) == expected
    back = _toured(_groups().group("all"), 5, order, offered=True, steps=-1)
    assert back[:4] == [*expected[:3][::-1], 0]
    alone = [entry for entry in expected[:4] if entry != TOGETHER]
    assert _toured(_groups().group("all"), 3, order, offered=False) == alone


def test_all_joints_at_once_can_be_left_although_they_are_no_longer_offered() -> None:
    group = _groups().group("all")
    assert _toured(group, 3, None, offered=True)[-1] == TOGETHER
    assert _toured(group, 1, None, offered=False, steps=-1) == [2]
    assert _toured(group, 3, None, offered=False) == [0, 1, 2]


def test_no_effort_asks_anything_of_one_joint_while_all_are_selected() -> None:
    groups = _groups()
    groups.group("all").together = True
    assert groups.wish("all", 1.0) == {}
    assert groups.wishes({"all": 1.0, "arm": 0.5}) == {1: Velocity(1.0)}


def test_making_a_joint_active_by_name_leaves_all_at_once() -> None:
    groups = _groups()
    groups.group("arm").together = True
    told = groups.describe()
    assert isinstance(told, list)
    assert told[0] == {"name": "arm", "joints": ["b", "a"], "active": "b", "together": True}
    assert not groups.activate("arm", "b").together
