"""The drawn arm has the dimensions, axes and limits that are known of the Bento Arm."""

import math
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from bentod import registry
from bentod.config_file import load
from sim.bento import DOWN, bento_joints
from sim.servo_models import MX_SCALE
from tests.dashboard.kinematics import BENTO, Matrix, pose, read_joints
from tests.rig import CONFIGS

JOINTS = read_joints(BENTO)
BY_NAME = {joint.name: joint for joint in JOINTS}
TICK = MX_SCALE.angle(2049)
"""rad, the finest that a servo tells apart."""

SHIPPED = sorted(CONFIGS.glob("*.toml"))


def at(link: str, **angles: float) -> Matrix:
    """Where a link is, m, shape (3,)."""
    place: Matrix = pose(JOINTS, angles)[link][:3, 3]
    return place


def test_at_zero_every_joint_is_where_the_arms_dimensions_put_it() -> None:
    expected = {
        "upper_arm": (0.1006, 0, 0.2180),
        "forearm": (0.1312, 0, 0.1243),
        "wrist": (0.2845, 0, 0.1243),
        "hand": (0.3251, 0, 0.1243),
        "finger": (0.4089, 0.012, 0.1243),
        "grip": (0.4822, 0.002, 0.1243),
    }
    for link, place in expected.items():
        np.testing.assert_allclose(at(link), place, atol=1e-9, err_msg=link)
    assert at("grip")[0] - at("forearm")[0] == pytest.approx(0.351)


def test_each_joint_turns_its_hand_the_way_that_its_axis_says() -> None:
    quarter = math.pi / 2
    np.testing.assert_allclose(at("wrist", shoulder_rotation=quarter), (0.1006, 0.1839, 0.1243), atol=1e-9)
    np.testing.assert_allclose(at("wrist", elbow_flexion=quarter), (0.1312, 0, 0.2776), atol=1e-9)
    np.testing.assert_allclose(at("finger", wrist_rotation=quarter), (0.4089, 0, 0.1363), atol=1e-9)
    np.testing.assert_allclose(at("finger", wrist_flexion=quarter), (0.3251, 0.012, 0.2081), atol=1e-9)
    np.testing.assert_allclose(at("grip", gripper=quarter), (0.4189, 0.0853, 0.1243), atol=1e-9)


def test_joints_turned_together_compose_from_the_shoulder_outwards() -> None:
    both = at("grip", shoulder_rotation=math.pi / 2, elbow_flexion=math.pi / 2)
    np.testing.assert_allclose(both, (0.1006 - 0.002, 0.0306, 0.1243 + 0.351), atol=1e-9)


def test_gravity_pulls_the_simulated_elbow_to_where_the_drawn_forearm_is_lowest() -> None:
    heights = {angle: at("grip", elbow_flexion=angle)[2] for angle in np.linspace(-math.pi, math.pi, 721)}
    assert min(heights, key=lambda angle: heights[angle]) == pytest.approx(DOWN)


def test_the_fingers_close_towards_the_lower_limit_and_open_towards_the_upper() -> None:
    gripper = BY_NAME["gripper"]
    gap = [at("grip", gripper=angle)[1] for angle in (gripper.lower, 0.0, 0.5, gripper.upper)]
    assert gap == sorted(gap)


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.name)
def test_a_shipped_config_fits_the_drawn_arm(path: Path) -> None:
    for spec in load(path, registry).joints:
        assert spec.name in BY_NAME, spec.name
        drawn = BY_NAME[spec.name]
        assert (spec.min_rad, spec.max_rad) == (drawn.lower, drawn.upper), spec.name
        assert spec.max_velocity_rad_s == drawn.velocity, spec.name


def test_the_simulated_servos_reach_all_of_the_drawn_range() -> None:
    drawn = {joint.name for joint in JOINTS if joint.upper > joint.lower}
    assert drawn == {spec.name for spec in bento_joints()}
    for spec in bento_joints():
        joint = BY_NAME[spec.name]
        assert spec.minimum - TICK <= joint.lower < joint.upper <= spec.maximum + TICK, spec
        assert joint.velocity <= spec.max_velocity + 0.01, spec


def test_the_arm_is_drawn_from_primitives_and_says_whose_dimensions_they_are() -> None:
    robot = ElementTree.parse(BENTO).getroot()  # noqa: S314 -- our own
    shapes = {shape.tag for shape in robot.iterfind(".//geometry/*")}
    assert shapes == {"box", "cylinder", "sphere"}
    assert "BLINC Lab, University of Alberta" in BENTO.read_text().replace("\n  ", " ")
