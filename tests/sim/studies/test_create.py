"""The simulated robot, its floor, and what it records while it turns."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from sim.studies.create import CLIFFS, FULL_SCALE, NAMES, THRESHOLDS, WHEELS_APART, Create
from sim.studies.drive import FASTEST, SLOWEST, drive
from sim.studies.floor import (
    BEIGE_TILE,
    BLACK_TAPE,
    BLACK_TILE,
    BLUE_TAPE,
    Floor,
    Sector,
    post,
    thesis_floor,
)
from sim.studies.measures import lead
from sim.studies.study import RATE_HZ

DT = 1 / RATE_HZ
BARE = Floor([Sector(0.0, BEIGE_TILE)], [])


def robot(floor: Floor = BARE, seed: int = 3) -> Create:
    return Create(floor, np.random.default_rng(seed))


def readings(floor: Floor, speed: float, steps: int) -> NDArray[np.float64]:
    """Binary signals of a robot that turns on the spot, shape (steps, 5)."""
    turning = robot(floor)
    turning.left, turning.right = -speed, speed
    rows = []
    for _ in range(steps):
        turning.step(DT)
        rows.append(turning.sense())
    return (np.array(rows) > np.array(THRESHOLDS)).astype(np.float64)


def test_wheels_against_each_other_turn_the_robot_on_the_spot_to_its_left() -> None:
    turning = robot()
    turning.left, turning.right = -0.13, 0.13
    for _ in range(60 * RATE_HZ):
        turning.step(DT)
    assert (turning.x, turning.y) == (0, 0)
    assert turning.heading == pytest.approx(2 * 0.13 / WHEELS_APART * 60, rel=0.02)


def test_one_wheel_faster_than_the_other_drives_a_circle_about_a_point_beside_the_robot() -> None:
    circling = robot()
    circling.left, circling.right = 0.1, 0.2
    centre = WHEELS_APART / 2 * 0.3 / 0.1  # m to its left, if nothing slips
    for _ in range(20 * RATE_HZ):
        circling.step(DT)
        assert math.hypot(circling.x, circling.y - centre) == pytest.approx(centre, rel=0.1)


def test_equal_wheels_drive_straight_on() -> None:
    driving = robot()
    driving.left = driving.right = 0.2
    driving.step(2.0)
    assert (driving.x, driving.y, driving.heading) == pytest.approx((0.4, 0, 0))


def test_every_threshold_tells_beige_from_all_that_is_darker_whatever_the_noise() -> None:
    for reflectance in (BLACK_TAPE, BLACK_TILE, BLUE_TAPE, BEIGE_TILE):
        standing = robot(Floor([Sector(0.0, reflectance)], []))
        signals = np.array([standing.sense()[:4] for _ in range(300)])
        assert ((signals > THRESHOLDS[:4]) == (reflectance == BEIGE_TILE)).all()
        assert signals.min() >= 0
        assert signals.max() <= FULL_SCALE


def test_sensors_differ_in_sensitivity_so_each_needs_a_threshold_of_its_own() -> None:
    assert len(set(THRESHOLDS)) == len(NAMES)
    blue, beige = (Floor([Sector(0.0, reflectance)], []) for reflectance in (BLUE_TAPE, BEIGE_TILE))
    strongest = max(robot(blue).sense()[:4])
    weakest = min(robot(beige).sense()[:4])
    assert strongest < min(THRESHOLDS[:4]) < max(THRESHOLDS[:4])
    assert weakest < max(robot(beige).sense()[:4])


def test_a_surface_is_passed_by_left_first_and_by_right_last_as_late_as_they_sit_apart() -> None:
    speed = 0.12  # m/s
    seen = readings(thesis_floor(), speed, 60 * RATE_HZ)
    turning = 2 * speed / WHEELS_APART
    bearings = [math.atan2(cliff.y, cliff.x) for cliff in CLIFFS]
    for first in range(3):
        apart = (bearings[first] - bearings[first + 1]) / turning
        late = lead(seen[:, first], seen[:, first + 1], 3 * RATE_HZ) / RATE_HZ
        assert late == pytest.approx(apart, abs=0.1)


def test_a_sensor_half_over_a_border_sees_half_of_either_surface() -> None:
    halves = Floor([Sector(0.0, 0.2), Sector(math.pi, 0.8)], [])
    assert halves.under(0.1, 1e-9, 0.01) == pytest.approx(0.5)
    assert halves.under(-0.1, 1e-9, 0.01) == pytest.approx(0.5)
    assert halves.under(0.1, 0.0025, 0.01) == pytest.approx(0.35, abs=1e-3)
    assert halves.under(0.1, 0.02, 0.01) == 0.2
    assert halves.under(0.1, -0.02, 0.01) == 0.8


@pytest.mark.parametrize("starts", [[], [0.1], [0.0, 2.0, 1.0], [0.0, 0.0], [0.0, 7.0]])
def test_a_floor_with_a_gap_is_refused(starts: list[float]) -> None:
    with pytest.raises(ValueError, match="Sectors must begin at 0"):
        Floor([Sector(start, 0.5) for start in starts], [])


def test_the_wall_sensor_sees_the_nearest_object_straight_ahead_and_none_beside() -> None:
    floor = Floor([Sector(0.0, 0.5)], [post(0, 0.5, 0.05), post(0, 0.3, 0.05), post(90, 0.3, 0.05)])
    assert floor.range(0.0, 0.0, 0.0) == pytest.approx(0.25)
    assert floor.range(0.0, 0.0, math.pi / 2) == pytest.approx(0.25)
    assert floor.range(0.0, 0.0, math.pi / 4) == math.inf
    assert robot(floor).sense()[4] > THRESHOLDS[4]
    away = robot(floor)
    away.heading = math.pi
    assert away.sense()[4] < THRESHOLDS[4]


def test_a_drive_takes_another_speed_every_two_minutes_always_to_the_left() -> None:
    speed = drive(BARE, 5, 4.5).speed
    at, other, last = speed[0], speed[120 * RATE_HZ], speed[240 * RATE_HZ]
    assert len({at, other, last}) == 3
    assert (speed[: 120 * RATE_HZ] == at).all()
    assert (speed[120 * RATE_HZ : 240 * RATE_HZ] == other).all()
    assert ((speed >= 2 * SLOWEST / WHEELS_APART) & (speed <= 2 * FASTEST / WHEELS_APART)).all()


def test_a_seed_decides_all_that_is_recorded() -> None:
    one, same, other = (drive(thesis_floor(), seed, 0.2).signals for seed in (1, 1, 2))
    assert np.array_equal(one, same)
    assert not np.array_equal(one, other)
