"""Help stays where the arm has been without it."""

import math
from itertools import pairwise, product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bentod.assist.confident import open_assist
from bentod.assist.ground import CELL, Ground
from bentod.assist.help import Help
from bentod.contracts_assist import AssistSettings, Situation
from tests.assist.situations import ELBOW, SHOULDER, SPECS, WRIST, Told, situation

REACHABLE = st.floats(-1.4, 1.4)
AT_ONCE = {"fade": 0.0, "introduction": 0.0, "first": 1.0, "acceleration": 100.0}


def at(*positions: float, attended: int | None = None, joints: tuple[int, ...] = (0, 1)) -> Situation:
    return situation(Told(), positions=positions, attended=attended, joints=joints)


def walked(ground: Ground, *corners: tuple[float, float]) -> Ground:
    for (x, y), (to_x, to_y) in pairwise(corners):
        for share in np.linspace(0, 1, 200):
            ground.note(at(x + share * (to_x - x), y + share * (to_y - y), 0.0))
    return ground


@given(REACHABLE, REACHABLE)
def test_where_nobody_has_been_a_joint_is_not_helped_to(x: float, y: float) -> None:
    assert Ground(SPECS).within(at(x, y, 0.0, attended=SHOULDER), ELBOW, 0.3, 0.3) == 0.0


@given(REACHABLE, REACHABLE, st.floats(-0.3, 0.3))
def test_what_is_left_of_help_never_ends_beyond_the_neighbours_of_known_cells(
    x: float, y: float, v: float
) -> None:
    ground = walked(Ground(SPECS), (-0.5, 0.0), (0.5, 0.0))
    left = ground.within(at(x, y, 0.0, attended=SHOULDER), ELBOW, v, 0.3)
    assert left == 0.0 or (math.copysign(1, left) == math.copysign(1, v) and abs(left) <= abs(v))
    if left:
        assert abs(y + left * 0.3) <= 2 * CELL
        assert abs(x) <= 0.5 + 2 * CELL


def test_a_joint_may_go_on_to_where_it_has_been() -> None:
    ground = walked(Ground(SPECS), (0.0, 0.0), (0.0, 0.5))
    here = at(0.0, 0.2, 0.0, attended=SHOULDER)
    assert ground.within(here, ELBOW, 0.3, 0.3) == 0.3
    assert ground.within(here, ELBOW, -0.3, 0.3) == -0.3


def test_near_its_edge_a_joint_goes_as_slowly_as_it_must() -> None:
    ground = walked(Ground(SPECS), (0.0, 0.0), (0.0, 0.5))
    speeds = [ground.within(at(0.0, y, 0.0, attended=SHOULDER), ELBOW, 0.3, 0.3) for y in (0.3, 0.46, 0.6)]
    assert speeds[0] == 0.3
    assert 0 < speeds[1] < 0.3
    assert speeds[2] == 0.0


def test_a_corner_that_was_never_cut_is_not_cut_by_help() -> None:
    ground = walked(Ground(SPECS), (0.0, 0.0), (0.4, 0.0), (0.4, 0.4))
    assert 0.3 * ground.within(at(0.2, 0.0, 0.0, attended=SHOULDER), ELBOW, 0.3, 0.3) <= 2 * CELL
    assert ground.within(at(0.2, 2 * CELL, 0.0, attended=SHOULDER), ELBOW, 0.3, 0.3) == 0.0


def test_each_two_joints_of_a_group_must_know_the_ground_together() -> None:
    ground = Ground(SPECS)
    group = (SHOULDER, ELBOW, WRIST)
    for y in np.linspace(0, 0.5, 300):
        ground.note(at(0.0, y, 0.0, joints=group))
    assert ground.within(at(0.0, 0.2, 0.0, attended=SHOULDER, joints=group), ELBOW, 0.3, 0.3) == 0.3
    turned = at(0.0, 0.2, 1.0, attended=SHOULDER, joints=group)
    assert ground.within(turned, ELBOW, 0.3, 0.3) == 0.0


def test_a_position_that_is_not_a_number_is_no_ground() -> None:
    ground = Ground(SPECS)
    ground.note(at(math.nan, 0.0, 0.0))
    assert ground.memory() == {}
    assert ground.within(at(math.nan, 0.0, 0.0, attended=SHOULDER), ELBOW, 0.3, 0.3) == 0.0


def test_what_is_known_goes_on_in_the_next_session() -> None:
    known = walked(Ground(SPECS), (0.0, 0.0), (0.0, 0.5))
    fresh = Ground(SPECS)
    fresh.recall(known.memory())
    for x, y in product(np.linspace(-0.1, 0.1, 9), np.linspace(-0.1, 0.6, 30)):
        here = at(x, y, 0.0, attended=SHOULDER)
        assert fresh.within(here, ELBOW, 0.3, 0.3) == known.within(here, ELBOW, 0.3, 0.3)


def test_of_joints_that_are_gone_nothing_is_known_any_more() -> None:
    ground = Ground(SPECS[:2])
    ground.recall({"shoulder/thumb": np.zeros((3, 2))})
    assert ground.memory() == {}


@pytest.mark.parametrize("cells", [np.zeros(4), np.full((2, 2), np.nan), np.zeros((2, 3))])
def test_what_is_no_list_of_cells_is_refused(cells: np.ndarray) -> None:
    with pytest.raises(ValueError, match="not a list of cells"):
        Ground(SPECS).recall({"shoulder/elbow": cells})


def test_help_remembers_its_ground_for_a_mode_that_is_chosen_later(caplog: pytest.LogCaptureFixture) -> None:
    settings = AssistSettings(k=0.1, options=AT_ONCE)
    first, second = (Help("arm", SPECS, 30.0, settings, lambda _: open_assist) for _ in range(2))
    first.change({"mode": "dpcc_confident", "options": dict(AT_ONCE)})
    for y in np.linspace(0.0, 0.5, 300):
        first.wish(situation(Told(sure=0.0), positions=(0.0, y, 0.0), attended=ELBOW, effort=0.5))
    second.recall(first.memory())
    second.change({"mode": "dpcc_confident", "options": dict(AT_ONCE)})
    assert second.memory().keys() == first.memory().keys() != set()
    second.recall({name: cells[:, :1] for name, cells in first.memory().items()})
    assert "is left out" in caplog.text
    assert second.memory().keys() == first.memory().keys()
