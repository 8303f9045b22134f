"""Servos that are not those of the config, or not set up as it has them: what the driver says of them."""

from collections.abc import AsyncIterator
from dataclasses import replace
from math import radians

import pytest

from bentod.contracts import ArmConfig
from bentod.errors import BadRequest, BusError
from bentod.frames import Freshness, Value
from sim.arm import Arm
from sim.bento import bento_joints, build_arm, build_bus
from sim.clock import VirtualClock
from sim.dynamixel.bus import Bus
from sim.joints import SimulatedJoints, open_joints
from sim.options import parse_options
from tests.fakes import cleared

NAMES = ("MX-64(2.0)", "MX-106", "AX-12A", "MX-28(2.0)", "MX-28")
REGISTER_FAULTS = ("wrong_model", "wrong_firmware", "id_clash", "narrow_limits")


def config(**options: Value) -> ArmConfig:
    joints = tuple(
        replace(spec, hardware={**spec.hardware, "model": model})
        for spec, model in zip(bento_joints(), NAMES, strict=True)
    )
    return ArmConfig(joints, 1 / 30, options)


def an_arm() -> tuple[Arm, Bus]:
    wanted = config()
    options = parse_options(wanted)
    arm = build_arm(wanted, options, 0.0)
    return arm, build_bus(arm, wanted, options)


@pytest.fixture
async def joints(clock: VirtualClock) -> AsyncIterator[SimulatedJoints]:
    async with open_joints(config(), clock) as opened:
        yield opened


async def run(joints: SimulatedJoints, clock: VirtualClock, seconds: float) -> None:
    end = clock.now() + seconds
    while clock.now() < end:
        began = clock.now()
        await joints.read()
        await clock.sleep_until(began + 1 / 30)


def eeprom(bus: Bus) -> list[tuple[int, ...]]:
    common = [unit.table.common for unit in bus.devices]
    return [
        tuple(unit.get(cell) for cell in (c.model, c.firmware, c.id, c.lowest, c.highest))
        for unit, c in zip(bus.devices, common, strict=True)
    ]


@pytest.mark.parametrize("joint", [None, 0, 2, 4])
@pytest.mark.parametrize("fault", REGISTER_FAULTS)
def test_a_fault_changes_registers_and_its_end_restores_them(fault: str, joint: int | None) -> None:
    arm, bus = an_arm()
    before = eeprom(bus)
    for _ in range(2):
        arm.inject(fault, joint, True)
    for index, (now, then) in enumerate(zip(eeprom(bus), before, strict=True)):
        assert (now != then) is (joint in (None, index))
    for _ in range(2):
        arm.inject(fault, joint, False)
    assert eeprom(bus) == before


def test_only_firmware_2_has_a_watchdog_to_trip() -> None:
    arm, _ = an_arm()
    arm.inject("watchdog", 0, True)
    assert arm.servos[0].tripped
    with pytest.raises(BadRequest, match="MX-106"):
        arm.inject("watchdog", 1, True)


async def test_limits_that_the_servo_holds_and_the_config_does_not_are_refused(clock: VirtualClock) -> None:
    with pytest.raises(BusError, match="elbow_flexion"):
        async with open_joints(config(limits_rad={"elbow_flexion": [-0.3, 0.8]}), clock):
            pass


async def test_a_start_outside_the_limits_is_not_armed(clock: VirtualClock) -> None:
    async with open_joints(config(start_rad={"gripper": 1.4}), clock) as joints:
        with pytest.raises(BusError, match="gripper"):
            await joints.set_torque([True] * 5)
        assert not joints.torque()[4]


@pytest.mark.parametrize("fault", ["wrong_model", "narrow_limits"])
async def test_another_servo_behind_the_cable_is_not_taken_for_the_one_before(
    joints: SimulatedJoints, clock: VirtualClock, fault: str
) -> None:
    joints.inject("cable", None, True)
    joints.inject(fault, 1, True)
    await run(joints, clock, 0.5)
    joints.inject("cable", None, False)
    await run(joints, clock, 5.0)
    state = await joints.read()
    assert "elbow_flexion" in state.problem
    joints.inject(fault, 1, False)
    await run(joints, clock, 5.0)
    assert (await joints.read()).problem == ""


async def test_two_servos_with_one_id_give_no_wrong_angle(
    joints: SimulatedJoints, clock: VirtualClock
) -> None:
    before = [joint.position for joint in (await joints.read()).joints]
    joints.inject("id_clash", 4, True)  # an MX-28 beside an MX-64(2.0): each hears its own protocol
    joints.inject("id_clash", 3, True)
    await run(joints, clock, 1.0)
    after = (await joints.read()).joints
    assert after[3].freshness is not Freshness.FRESH
    assert after[4].freshness is not Freshness.FRESH
    assert after[0].position == pytest.approx(before[0], abs=radians(0.2))


async def test_a_watchdog_that_tripped_is_told_and_can_be_cleared(
    joints: SimulatedJoints, clock: VirtualClock
) -> None:
    await joints.set_torque([True] * 5)
    joints.inject("watchdog", 3, True)
    await clock.sleep_until(clock.now() + 1.0)  # as when the host was held up
    await run(joints, clock, 1.0)
    assert (await joints.read()).joints[3].errors
    assert await cleared(joints, [3]) == ()
    await run(joints, clock, 1.0)
    assert (await joints.read()).joints[3].errors == ()


async def test_a_slow_usb_adapter_makes_a_round_take_longer(clock: VirtualClock) -> None:
    async def round_time(**options: Value) -> float:
        async with open_joints(config(reply_margin_s=0.02, **options), clock) as joints:
            began = clock.now()
            await joints.read()
            return clock.now() - began

    assert await round_time(usb_latency_s=0.016) > 0.016 > await round_time()
