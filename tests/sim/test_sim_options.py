from math import pi, radians

import pytest

from bentod.contracts import ArmConfig
from bentod.errors import ConfigError
from bentod.frames import Value
from drivers.dynamixel.options import Options as BusOptions
from sim.bento import bento_joints, build_arm
from sim.clock import VirtualClock
from sim.joints import open_joints
from sim.options import Options, bus_options, parse_options
from sim.servo import Servo


def config(**options: Value) -> ArmConfig:
    return ArmConfig(bento_joints(), 1 / 30, options)


def servos(**options: Value) -> dict[str, Servo]:
    wanted = config(**options)
    arm = build_arm(wanted, parse_options(wanted), 0.0)
    return {spec.name: servo for spec, servo in zip(wanted.joints, arm.servos, strict=True)}


def test_a_config_of_the_real_arm_is_one_of_the_simulated_arm() -> None:
    options = parse_options(config(port="/dev/ttyUSB0", baud=57_600, stop="thesis"))
    assert BusOptions.model_validate(bus_options(options)).stop == "thesis"


def test_a_simulated_arm_needs_no_options() -> None:
    assert parse_options(config()) == Options()


@pytest.mark.parametrize(
    ("key", "value", "complaint"),
    [
        ("sed", 1, "sed"),
        ("gravity_nm", {"elbow_flexion": 99.0}, "gravity_nm.elbow_flexion"),
        ("gravity_nm", {"tail": 0.1}, "no joint 'tail'"),
        ("start_rad", {"tail": 0.1}, "no joint 'tail'"),
        ("limits_rad", {"tail": [0.1, 0.2]}, "no joint 'tail'"),
        ("limits_rad", {"gripper": [0.1]}, "limits_rad.gripper"),
        ("usb_latency_s", 1.0, "usb_latency_s"),
        ("temperature", float("nan"), "temperature"),
    ],
)
def test_what_makes_no_sense_is_named(key: str, value: Value, complaint: str) -> None:
    with pytest.raises(ConfigError, match=complaint):
        parse_options(config(**{key: value}))


def test_the_bento_arm_is_as_its_makers_ship_it() -> None:
    limits = [(spec.name, spec.minimum, spec.maximum, spec.max_velocity) for spec in bento_joints()]
    assert limits[1] == (
        "elbow_flexion",
        *(pytest.approx(radians(a), abs=0.002) for a in (-23.2, 45.9, 30.8)),
    )
    assert [spec.hardware["id"] for spec in bento_joints()] == [1, 2, 3, 4, 5]


def test_gravity_is_the_bento_arms_unless_it_is_told() -> None:
    arm = servos(gravity_nm={"shoulder_rotation": 0.5})
    pulls = {name: servo.link.gravity for name, servo in arm.items()}
    assert (pulls["shoulder_rotation"], pulls["elbow_flexion"], pulls["wrist_flexion"]) == (0.5, 0.67, 0.12)
    assert arm["elbow_flexion"].link.rest == -pi / 2


def test_a_joint_may_start_outside_its_limits() -> None:
    elbow = servos(start_rad={"elbow_flexion": 1.2}, stand=False)["elbow_flexion"]
    assert elbow.position == 1.2
    for _ in range(3000):
        elbow.step(0.001)
    assert -0.45 < elbow.position < -0.4


def test_joints_start_at_home_in_a_room_as_warm_as_told() -> None:
    arm = servos(temperature=31.0, start_rad={"gripper": 0.4})
    assert (arm["gripper"].position, arm["elbow_flexion"].position) == (0.4, 0.0)
    assert all(servo.temperature == servo.ambient == 31.0 for servo in arm.values())


@pytest.mark.parametrize("baud", [9_600, 57_142, 1_000_000, 2_250_000, 3_000_000])
async def test_the_servos_are_provisioned_for_the_configs_baud_rate(baud: int) -> None:
    async with open_joints(config(baud=baud), VirtualClock()) as joints:
        assert (await joints.read()).problem == ""
