import pytest

from bentod.control.groups import Groups
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
