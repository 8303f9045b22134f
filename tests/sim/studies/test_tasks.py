"""Way points and the angle maze, without anybody in them."""

import pytest

from sim.people.scene import Point
from sim.studies.maze import CENTRE, EXPOSED, HALF_WIDTH, PLAY, REST, Maze
from sim.studies.waypoints import DWELL, LEGS, ONE, TOLERANCE, Waypoints

TICK = 1 / 30


def rests(task: Maze | Waypoints) -> bool:
    return task.resting


class Tour:
    """Puts the arm somewhere and lets time pass."""

    def __init__(self, task: Maze | Waypoints) -> None:
        self.task = task
        self.time = 0.0

    def stay(self, position: Point, seconds: float = TICK) -> int:
        """Circuits that ended meanwhile."""
        end, ended = self.time + seconds - TICK / 2, 0
        while self.time < end:
            ended += self.task.step(self.time, position)
            self.time += TICK
        return ended


def test_a_circuit_of_the_maze_rests_at_the_green_barrier_and_at_the_yellow_one() -> None:
    maze = Maze()
    tour = Tour(maze)
    tour.stay(CENTRE[0], REST - 2 * TICK)
    assert rests(maze)
    tour.stay(CENTRE[0], 4 * TICK)
    assert not rests(maze)
    tour.stay(CENTRE[-1])
    assert (rests(maze), maze.leg) == (True, 1)
    tour.stay(CENTRE[-1], REST + 3 * TICK)
    assert not rests(maze)
    assert tour.stay(CENTRE[0]) == 1
    assert (rests(maze), maze.leg, maze.circuits) == (True, 0, 1)


@pytest.mark.parametrize("off", [-1.2 * EXPOSED, 1.2 * EXPOSED])
def test_a_barrier_is_felt_only_in_its_middle(off: float) -> None:
    maze = Maze(resting=False)
    tour = Tour(maze)
    tour.stay((CENTRE[-1][0], CENTRE[-1][1] + off), 1.0)
    tour.stay(CENTRE[1], REST)
    tour.stay((CENTRE[-1][0] - 0.01, CENTRE[-1][1] + off), 1.0)
    assert maze.leg == 0


def test_a_touch_that_goes_on_or_bounces_is_one_contact_and_a_later_one_another() -> None:
    maze = Maze()
    tour = Tour(maze)
    inside, outside = (0.0, 0.05), (HALF_WIDTH + 0.001, 0.05)
    tour.stay(outside, 1.0)
    tour.stay(inside, 0.1)
    tour.stay(outside, 0.1)
    assert maze.contacts == 1
    tour.stay(inside, 1.0)
    assert (maze.contacts, maze.touching) == (1, False)
    tour.stay(outside)
    assert (maze.contacts, maze.touching) == (2, True)


def test_the_middle_of_the_corridor_is_clear_of_walls() -> None:
    for position in CENTRE:
        assert Maze().clearance(position) == pytest.approx(HALF_WIDTH)


def test_the_mirrored_maze_is_the_same_to_the_other_side() -> None:
    there, here = Maze(mirrored=True, resting=False), Maze(resting=False)
    for x, y in [(-0.1, 0.2), (0.02, 0.1), (-0.25, 0.36)]:
        assert there.clearance((-x, y)) == pytest.approx(here.clearance((x, y)))
        mirrored, plain = there.way((-x, y), 0, 0.0, 0.01), here.way((x, y), 0, 0.0, 0.01)
        assert mirrored.gain == pytest.approx(plain.gain)
        assert mirrored.distance == pytest.approx(-plain.distance)


def test_one_joint_at_a_time_needs_at_least_five_toggles_to_the_yellow_barrier() -> None:
    position, margin, turns = CENTRE[0], 0.013, 0
    joint, maze = 1, Maze(resting=False)
    while maze.leg == 0 and turns < 20:
        way = maze.way(position, joint, 0.0, margin)
        x, y = position
        position = (x + way.distance, y) if joint == 0 else (x, y + way.distance)
        maze.step(10.0 + turns, position)
        joint, turns = 1 - joint, turns + 1
    assert maze.leg == 1
    assert turns - 1 == 5
    assert maze.contacts == 0


def test_a_joint_that_comes_along_opens_the_way_through_the_diagonal() -> None:
    maze, bend = Maze(resting=False), CENTRE[1]
    alone = maze.way(bend, 1, 0.0, 0.013)
    along = maze.way(bend, 1, -0.22 / 0.30, 0.013)
    assert along.gain > 3 * alone.gain


def test_a_way_that_only_leads_off_a_wall_is_called_back() -> None:
    maze = Maze(resting=False)
    assert maze.way((-0.02, 0.19), 1, 0.0, 0.01).back
    assert not maze.way(CENTRE[1], 1, 0.0, 0.01).back


def test_a_circuit_of_way_points_goes_1_2_3_2_1_and_dwells_at_each() -> None:
    task = Waypoints()
    tour = Tour(task)
    ended = 0
    for target in LEGS:
        assert not rests(task)
        tour.stay(target)
        assert rests(task)
        ended += tour.stay(target, DWELL + 2 * TICK)
    assert ended == 1
    assert LEGS[-1] == ONE
    assert task.leg == 0


def test_a_way_point_is_reached_within_a_degree_of_both_angles() -> None:
    task = Waypoints()
    x, y = LEGS[0]
    Tour(task).stay((x + 1.1 * TOLERANCE, y))
    assert not rests(task)
    Tour(task).stay((x + 0.9 * TOLERANCE, y - 0.9 * TOLERANCE))
    assert rests(task)


def test_a_leg_to_a_way_point_is_gone_one_joint_after_the_other() -> None:
    task = Waypoints()
    assert task.way(ONE, 0, 0.0, 0.0).gain == 0
    assert task.way(ONE, 1, 0.0, 0.0).distance == pytest.approx(LEGS[0][1] - ONE[1])
    assert task.way((ONE[0], LEGS[0][1]), 0, 0.0, 0.0).distance > 0


def test_the_spot_ahead_lies_on_the_centre_line_in_the_direction_of_the_leg() -> None:
    there, back = Maze(resting=False), Maze(resting=False, leg=1)
    assert there.ahead(CENTRE[0], 0.04) == pytest.approx((0.0, 0.04))
    assert back.ahead(CENTRE[1], 0.04) == pytest.approx((0.0, 0.02))
    assert there.clearance(there.ahead((-0.1, 0.2), 0.1)) == pytest.approx(HALF_WIDTH)
    x, y = Maze(mirrored=True).ahead((0.1, 0.2), 0.1)
    assert (-x, y) == pytest.approx(there.ahead((-0.1, 0.2), 0.1))


def test_after_a_break_a_whole_rest_comes_first() -> None:
    maze = Maze(resting=False)
    tour = Tour(maze)
    tour.stay(CENTRE[0], 100.0)
    maze.resume()
    tour.stay(CENTRE[0], REST - 2 * TICK)
    assert rests(maze)
    tour.stay(CENTRE[0], 4 * TICK)
    assert not rests(maze)


def test_limits_with_room_for_both_mazes_hold_either() -> None:
    for single in (Maze().limits, Maze(mirrored=True).limits):
        for (low, high), (lowest, highest) in zip(single, Maze(both=True).limits, strict=True):
            assert lowest <= low
            assert high <= highest


def test_a_rod_that_goes_far_behind_a_wall_presses_and_one_at_its_surface_only_touches() -> None:
    maze = Maze()
    tour = Tour(maze)
    tour.stay((HALF_WIDTH + 0.001, 0.03))
    assert (maze.touching, maze.pressing) == (True, False)
    tour.stay((HALF_WIDTH + PLAY + 0.001, 0.03))
    assert maze.pressing
