"""Clearing errors of firmware 1; those of firmware 2 are in `test_firmware2`."""

from dataclasses import replace

from bentod.frames import Stop
from sim.clock import VirtualClock
from tests.drivers.dynamixel.arm import CONFIG, WRIST, opened, read, window, wrist, write
from tests.drivers.dynamixel.wire import Wire, status, word
from tests.fakes import cleared

ONE = replace(CONFIG, joints=(WRIST,))
HOLDING = replace(wrist(), torque=1)
OVERLOADED = window(3, limit=0, error=0x20)


def expect_restored(wire: Wire, after: bytes) -> None:
    wire.expect(write(3, 24, 0), status(3, error=0x20))
    wire.expect(read(3, 24, 1), status(3, 0, error=0x20))
    wire.expect(read(3, 14, 2), status(3, *word(900), error=0x20))
    wire.expect(write(3, 34, *word(900)), status(3))
    wire.expect(read(3, 34, 10), after)


async def test_an_overload_is_cleared_by_the_torque_limit_and_the_joint_stays_limp(
    wire: Wire, clock: VirtualClock
) -> None:
    async with opened(wire, clock, HOLDING, config=ONE) as joints:
        wire.expect(read(3, 34, 10), OVERLOADED)
        wire.expect(read(3, 11, 1), status(3, 80))
        expect_restored(wire, window(3, limit=900))
        assert await cleared(joints, [0]) == ()
        assert joints.torque() == (False,)
        await joints.write([Stop()])
    assert wire.finished()


async def test_an_alarm_that_stays_needs_a_power_cycle(wire: Wire, clock: VirtualClock) -> None:
    async with opened(wire, clock, HOLDING, config=ONE) as joints:
        wire.expect(read(3, 34, 10), OVERLOADED)
        wire.expect(read(3, 11, 1), status(3, 80))
        expect_restored(wire, OVERLOADED)
        (need,) = await cleared(joints, [0])
    assert need.startswith("Servo 3 (wrist_rotation) still reports Overload Error")
    assert need.endswith("it needs a power cycle.")


async def test_a_hot_servo_is_left_to_cool(wire: Wire, clock: VirtualClock) -> None:
    async with opened(wire, clock, HOLDING, config=ONE) as joints:
        wire.expect(read(3, 34, 10), status(3, 0, 0, 0, 8, 0, 0, 0, 0, 120, 84, error=0x04))
        wire.expect(read(3, 11, 1), status(3, 80))
        (need,) = await cleared(joints, [0])
    assert "is at 84 degrees Celsius, its limit is 80; let it cool" in need
    assert wire.finished()


async def test_a_servo_under_load_is_not_given_its_torque_back(wire: Wire, clock: VirtualClock) -> None:
    async with opened(wire, clock, HOLDING, config=ONE) as joints:
        wire.expect(read(3, 34, 10), window(3, limit=0, load=600, error=0x20))
        wire.expect(read(3, 11, 1), status(3, 80))
        (need,) = await cleared(joints, [0])
    assert "still carries 59% of its greatest load; take that off" in need
    assert wire.finished()


async def test_what_has_no_alarm_is_left_alone(wire: Wire, clock: VirtualClock) -> None:
    async with opened(wire, clock, HOLDING, config=ONE) as joints:
        wire.expect(read(3, 34, 10), window(3))
        assert await cleared(joints, [0]) == ()
        assert joints.torque() == (True,)
    assert wire.finished()


async def test_a_low_supply_needs_a_person(wire: Wire, clock: VirtualClock) -> None:
    async with opened(wire, clock, HOLDING, config=ONE) as joints:
        wire.expect(read(3, 34, 10), window(3, error=0x01))
        (need,) = await cleared(joints, [0])
    assert need == "Servo 3 (wrist_rotation) still reports Input Voltage Error; check its supply."


async def test_a_servo_that_is_silent_is_a_sentence_and_no_error(wire: Wire, clock: VirtualClock) -> None:
    async with opened(wire, clock, HOLDING, config=ONE) as joints:
        wire.expect(read(3, 34, 10), times=2)
        (need,) = await cleared(joints, [0])
    assert "does not answer" in need
