from dataclasses import replace

import pytest

from bentod.contracts import ArmConfig
from bentod.errors import BusError, ConfigError
from drivers.can.options import parse_hardware, parse_options
from sim.bento import bento_joints
from sim.can.joints import open_joints
from sim.clock import VirtualClock

GRIPPER = bento_joints()[4]


def test_a_bus_is_a_socketcan_one_unless_it_says_otherwise() -> None:
    options = parse_options({})
    assert (options.interface, options.channel, options.bitrate) == ("socketcan", "can0", 500_000)


@pytest.mark.parametrize("ratio", [0.0, 0.001, -0.009, 1e9])
def test_a_gear_has_a_ratio_that_can_be_divided_by(ratio: float) -> None:
    with pytest.raises(ConfigError, match="Controller of joint gripper: gear_ratio"):
        parse_hardware(replace(GRIPPER, hardware={"node": 1, "gear_ratio": ratio}))


def test_a_key_that_is_not_known_is_an_error() -> None:
    with pytest.raises(ConfigError, match="CAN bus: bit_rate"):
        parse_options({"bit_rate": 500_000})


async def test_two_joints_on_one_node_are_refused(clock: VirtualClock) -> None:
    joints = tuple(replace(spec, hardware={"node": 4}) for spec in bento_joints()[:2])
    with pytest.raises(ConfigError, match="every joint needs a node of its own"):
        async with open_joints(ArmConfig(joints, 1 / 30, {}), clock):
            pass


async def test_a_start_is_given_only_to_joints_that_are_there(clock: VirtualClock) -> None:
    config = ArmConfig((replace(GRIPPER, hardware={"node": 4}),), 1 / 30, {"start_rad": {"elbow": 0.1}})
    with pytest.raises(ConfigError, match="start_rad: no joint 'elbow' is on it"):
        async with open_joints(config, clock):
            pass


async def test_a_joint_outside_its_limits_is_not_switched_on(clock: VirtualClock) -> None:
    config = ArmConfig((replace(GRIPPER, hardware={"node": 4}),), 1 / 30, {"start_rad": {"gripper": 1.4}})
    async with open_joints(config, clock) as joints:
        with pytest.raises(BusError, match=r"stands at 80\.2 degrees, 14\.1 degrees outside its limits"):
            await joints.set_torque([True])
        assert joints.torque() == (False,)
