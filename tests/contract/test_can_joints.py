"""What every arm must do, done by motor controllers on CAN: the suite of `test_joints`, and what differs."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import replace
from math import degrees

import pytest

from bentod.contracts import ArmConfig, Clock
from bentod.errors import BusError
from bentod.frames import Freshness, Stop, Value, Velocity
from drivers.can.bus import open_joints as open_real_joints
from drivers.can.bus import open_link
from sim.can.joints import SimulatedCanJoints, build_axes, open_joints
from sim.can.network import Network
from sim.can.options import bus_options, parse_options
from tests.contract import test_joints as suite
from tests.contract.test_joints import (
    ELBOW,
    FREE,
    GRIPPER,
    PERIOD,
    SHOULDER,
    WRIST_ROTATION,
    BreakableJoints,
    Opener,
    Rig,
    positions,
    rig,
)
from tests.drivers.can.multicast import GROUP, free_port, multicast
from tests.fakes import cleared

__all__ = ["rig"]

DIFFERENT = {
    "test_a_servo_in_trouble_is_still_read_and_says_so",
    "test_a_pulled_cable_loses_every_joint_and_says_why",
    "test_a_cable_that_is_plugged_in_again_finds_the_same_arm",
    "test_nobody_talking_any_more_lets_a_motion_end_soon",
}
"""Errors have the names of the controller's manual, and come with its heartbeat. A cable can be pulled
between a controller's frame and the reading of it, which is then as fresh as any. And a controller that
hears nothing any more lets its motor go: a joint that gravity pulls at falls."""

globals().update(
    {name: test for name, test in vars(suite).items() if name.startswith("test_") and name not in DIFFERENT}
)

GEARS = (8.0, -25.0, 1.0, 100.0, -1.5)


def on_can(config: ArmConfig, **hardware: Value) -> ArmConfig:
    """The same arm on motor controllers with gears of all kinds."""
    joints = tuple(
        replace(spec, hardware={"node": 3 * i, "gear_ratio": gear, "offset_rad": 0.1 * i, **hardware})
        for i, (spec, gear) in enumerate(zip(config.joints, GEARS, strict=True))
    )
    return replace(config, joints=joints)


@asynccontextmanager
async def over_multicast(config: ArmConfig, clock: Clock) -> AsyncIterator[BreakableJoints]:
    """Driver and controllers on a bus of python-can. What is sent is there at once, before time passes."""
    if why := multicast():
        pytest.skip(f"no multicast on this machine: {why}")
    table: dict[str, Value] = {
        **config.options,
        "interface": "udp_multicast",
        "channel": GROUP,
        "udp_port": free_port(),
    }
    config = replace(on_can(config), options=table)
    options = parse_options(config)
    driven = replace(config, options=bus_options(options))
    async with open_link(options) as link:
        network = Network(build_axes(config, options), options.seed, link.send)
        link.listen(network.hear, _fail)
        try:
            async with open_real_joints(driven, clock) as joints:
                yield SimulatedCanJoints(joints, network)
        finally:
            network.close()


def _fail(reason: str) -> None:
    raise AssertionError(reason)


def _opener(**hardware: Value) -> Opener:
    @asynccontextmanager
    async def opener(config: ArmConfig, clock: Clock) -> AsyncIterator[BreakableJoints]:
        async with open_joints(on_can(config, **hardware), clock) as joints:
            yield joints

    return opener


@pytest.fixture(
    params=[
        pytest.param(_opener(), id="velocities kept by the controller"),
        pytest.param(_opener(bounded=True), id="velocities as moves to the limit"),
        pytest.param(over_multicast, id="over udp_multicast"),
    ]
)
def opener(request: pytest.FixtureRequest) -> Opener:
    found: Opener = request.param
    return found


@pytest.mark.parametrize(
    ("fault", "complaint"),
    [
        ("overload", "CURRENT_LIMIT_VIOLATION"),
        ("overheat", "MOTOR_OVER_TEMP"),
        ("low_voltage", "DC_BUS_UNDER_VOLTAGE"),
    ],
)
async def test_a_controller_in_trouble_is_still_read_and_says_so(
    rig: Rig, fault: str, complaint: str
) -> None:
    rig.joints.inject(fault, GRIPPER, True)
    joint = (await rig.run(0.3)).joints[GRIPPER]
    assert joint.freshness is Freshness.FRESH
    assert joint.errors == (complaint,)


async def test_a_pulled_cable_loses_every_joint_and_nothing_can_be_switched(rig: Rig) -> None:
    await rig.torque_on()
    rig.want({SHOULDER: Velocity(0.2)})
    await rig.run(0.5)
    rig.joints.inject("cable", None, True)
    state = await rig.run(1.0)
    assert all(joint.freshness is Freshness.LOST for joint in state.joints)
    assert not any(joint.freshness is Freshness.FRESH for seen in rig.states[1:] for joint in seen.joints)
    assert state.problem.endswith(".")
    with pytest.raises(BusError, match=r"shoulder_rotation \(node 0\) did not confirm"):
        await rig.joints.set_torque([False] * 5)


async def test_nobody_talking_any_more_makes_every_joint_limp(rig: Rig) -> None:
    await rig.torque_on()
    rig.want({SHOULDER: Velocity(0.3), WRIST_ROTATION: Velocity(-0.3), GRIPPER: Velocity(0.3)})
    await rig.run(0.8)
    await rig.clock.sleep_until(rig.clock.now() + 0.6)
    stopped = positions(await rig.joints.read())
    await rig.clock.sleep_until(rig.clock.now() + 3.0)
    left = positions(await rig.joints.read())
    assert [left[i] for i in FREE] == pytest.approx([stopped[i] for i in FREE], abs=0.001)
    assert rig.joints.torque() == (False,) * 5


async def test_a_mended_cable_brings_every_joint_back_disarmed_by_its_watchdog(rig: Rig) -> None:
    await rig.torque_on()
    rig.joints.inject("cable", None, True)
    await rig.run(1.0)
    rig.joints.inject("cable", None, False)
    state = await rig.run(0.5)
    assert all(joint.freshness is Freshness.FRESH for joint in state.joints)
    assert state.problem == ""
    assert rig.joints.torque() == (False,) * 5
    assert {joint.errors for joint in state.joints} == {("WATCHDOG_TIMER_EXPIRED",)}


async def test_a_servo_that_lost_its_heartbeat_is_not_believed_though_its_position_comes(rig: Rig) -> None:
    await rig.torque_on()
    rig.joints.inject("heartbeat", GRIPPER, True)
    state = await rig.run(1.0)
    assert state.joints[GRIPPER].freshness is Freshness.LOST
    assert 0.9 < state.joints[GRIPPER].age < 1.2
    assert state.joints[SHOULDER].freshness is Freshness.FRESH
    rig.joints.inject("heartbeat", GRIPPER, False)
    assert (await rig.run(0.2)).joints[GRIPPER].freshness is Freshness.FRESH


async def test_an_error_stays_until_it_is_cleared_and_its_cause_is_gone(rig: Rig) -> None:
    await rig.torque_on()
    rig.joints.inject("overheat", GRIPPER, True)
    await rig.run(0.3)
    assert rig.joints.torque() == (True, True, True, True, False)
    with pytest.raises(BusError, match=r"\(node 12\) reports MOTOR_OVER_TEMP: clear its errors"):
        await rig.joints.set_torque([True] * 5)
    assert await rig.joints.clear_errors([GRIPPER]) == (
        "gripper (node 12) still reports MOTOR_OVER_TEMP: remove the cause, then clear again.",
    )
    rig.joints.inject("overheat", GRIPPER, False)
    assert (await rig.run(0.3)).joints[GRIPPER].errors == ("MOTOR_OVER_TEMP",)
    assert await rig.joints.clear_errors([GRIPPER]) == ()
    assert (await rig.run(0.3)).joints[GRIPPER].errors == ()
    await rig.joints.set_torque([True] * 5)


async def test_errors_of_a_silent_joint_are_not_said_to_be_cleared(rig: Rig) -> None:
    rig.joints.inject("silent", ELBOW, True)
    (told,) = await cleared(rig.joints, [ELBOW])
    assert told == "elbow_flexion (node 3) did not answer: its errors may not be cleared."


async def test_a_stop_is_reported_with_its_travel_and_bounce(rig: Rig) -> None:
    await rig.torque_on()
    rig.want({GRIPPER: Velocity(-0.5)})
    moving = await rig.run(0.5)
    rig.want({GRIPPER: Stop()})
    stop = (await rig.run(1.0)).joints[GRIPPER].stop
    assert stop is not None
    assert moving.time <= stop.time <= moving.time + 2 * PERIOD
    assert 0 < degrees(stop.travel) < 3
    assert 0 <= degrees(stop.bounce) < 0.3
