from dataclasses import replace

import pytest

from bentod.errors import BusError
from bentod.frames import Stop
from sim.clock import VirtualClock
from tests.drivers.dynamixel.arm import (
    BULK,
    CONFIG,
    WRIST,
    elbow,
    expect_torque_off,
    expect_torque_on,
    opened,
    read,
    window,
    wrist,
    write,
)
from tests.drivers.dynamixel.wire import Wire, status

ONE = replace(CONFIG, joints=(WRIST,))
HOLDING = (replace(elbow(), torque=1), replace(wrist(), torque=1))


async def test_a_joint_is_pinned_where_it_is_before_it_is_switched_on(
    wire: Wire, clock: VirtualClock
) -> None:
    async with opened(wire, clock) as joints:
        expect_torque_on(wire, 3, position=2060)
        await joints.set_torque([False, True])
        assert joints.torque() == (False, True)
    assert wire.finished()


async def test_a_stop_after_switching_on_keeps_the_pin(wire: Wire, clock: VirtualClock) -> None:
    async with opened(wire, clock, wrist(), config=ONE) as joints:
        expect_torque_on(wire, 3, position=2060)
        await joints.set_torque([True])
        wire.expect(read(3, 34, 10), window(3, position=2056, load=150))
        await joints.read()
        wire.expect("FF FF FE 09 83 1E 04 03 0C 08 05 00 37")
        await joints.write([Stop()])
    assert wire.finished()


async def test_gains_are_set_while_the_joint_is_limp(wire: Wire, clock: VirtualClock) -> None:
    hardware = {**WRIST.hardware, "p_gain": 16, "goal_acceleration_rad_s2": 4.494}
    config = replace(CONFIG, joints=(replace(WRIST, hardware=hardware),))
    async with opened(wire, clock, wrist(), config=config) as joints:
        wire.expect(read(3, 34, 10), window(3))
        wire.expect(write(3, 28, 16), status(3))
        wire.expect(write(3, 73, 30), status(3))
        wire.expect(write(3, 30, 0x00, 0x08, 5, 0), status(3))
        wire.expect(write(3, 24, 1), status(3))
        wire.expect(read(3, 24, 1), status(3, 1))
        await joints.set_torque([True])
    assert wire.finished()


async def test_off_comes_before_on_and_what_is_so_already_is_left_alone(
    wire: Wire, clock: VirtualClock
) -> None:
    async with opened(wire, clock, elbow(), replace(wrist(), torque=1)) as joints:
        await joints.set_torque([False, True])
        expect_torque_off(wire, 3)
        expect_torque_on(wire, 2)
        await joints.set_torque([True, False])
        assert joints.torque() == (True, False)
    assert wire.finished()


async def test_a_joint_that_is_not_read_anew_is_not_switched_on(wire: Wire, clock: VirtualClock) -> None:
    async with opened(wire, clock, wrist(), config=ONE) as joints:
        wire.expect(read(3, 34, 10), times=2)
        with pytest.raises(BusError, match=r"Servo 3 \(wrist_rotation\) does not answer"):
            await joints.set_torque([True])
        assert joints.torque() == (False,)
    assert wire.finished()


async def test_a_joint_far_outside_its_limits_is_not_switched_on(wire: Wire, clock: VirtualClock) -> None:
    async with opened(wire, clock, replace(wrist(), position=3200), config=ONE) as joints:
        wire.expect(read(3, 34, 10), window(3, position=3200))
        with pytest.raises(BusError, match=r"at 101\.2 degrees, 11\.2 degrees outside its limit of 90\.1"):
            await joints.set_torque([True])
    assert wire.finished()


async def test_a_joint_just_outside_its_limits_is_pinned_at_them(wire: Wire, clock: VirtualClock) -> None:
    async with opened(wire, clock, replace(wrist(), position=3080), config=ONE) as joints:
        wire.expect(read(3, 34, 10), window(3, position=3080))
        wire.expect(write(3, 28, 32), status(3))
        wire.expect(write(3, 73, 0), status(3))
        wire.expect(write(3, 30, 0x01, 0x0C, 5, 0), status(3))  # 3073
        wire.expect(write(3, 24, 1), status(3))
        wire.expect(read(3, 24, 1), status(3, 1))
        await joints.set_torque([True])
    assert wire.finished()


@pytest.mark.parametrize(
    ("found", "alarm"),
    [
        (window(3, error=0x20), "Overload Error"),
        (window(3, error=0x04), "Overheating Error"),
        (window(3, limit=0), "Torque Limit 0 after Alarm Shutdown"),
    ],
)
async def test_a_servo_in_alarm_is_not_switched_on(
    found: bytes, alarm: str, wire: Wire, clock: VirtualClock
) -> None:
    async with opened(wire, clock, wrist(), config=ONE) as joints:
        wire.expect(read(3, 34, 10), found)
        with pytest.raises(BusError, match=f"reports {alarm}; take the load off"):
            await joints.set_torque([True])
    assert wire.finished()


async def test_an_order_that_is_not_confirmed_is_repeated(wire: Wire, clock: VirtualClock) -> None:
    async with opened(wire, clock, replace(wrist(), torque=1), config=ONE) as joints:
        wire.expect(write(3, 24, 0))
        expect_torque_off(wire, 3)
        await joints.set_torque([False])
        assert joints.torque() == (False,)
    assert wire.finished()


async def test_every_joint_is_switched_off_even_if_another_does_not_confirm(
    wire: Wire, clock: VirtualClock
) -> None:
    async with opened(wire, clock, *HOLDING) as joints:
        wire.expect(write(2, 24, 0), times=2)
        expect_torque_off(wire, 3)
        with pytest.raises(BusError, match=r"Servo 2 \(elbow_flexion\) did not confirm"):
            await joints.set_torque([False, False])
        assert joints.torque() == (True, False)
    assert wire.finished()


async def test_a_torque_that_was_not_confirmed_is_asked_for_in_the_next_round(
    wire: Wire, clock: VirtualClock
) -> None:
    async with opened(wire, clock, *HOLDING) as joints:
        wire.expect(write(2, 24, 0), times=2)
        with pytest.raises(BusError):
            await joints.set_torque([False, True])
        wire.expect(BULK, window(2), window(3))
        wire.expect(read(2, 24, 1), status(2, 0), times=2)
        await joints.read()
        assert joints.torque() == (False, True)
    assert wire.finished()


async def test_a_refused_order_is_told_in_the_manuals_words(wire: Wire, clock: VirtualClock) -> None:
    async with opened(wire, clock, wrist(), config=ONE) as joints:
        wire.expect(read(3, 34, 10), window(3))
        wire.expect(write(3, 28, 32), status(3, error=0x08))
        with pytest.raises(BusError, match="refused to have P Gain set to 20: Range Error"):
            await joints.set_torque([True])
    assert wire.finished()


async def test_a_condition_of_the_servo_does_not_make_an_order_refused(
    wire: Wire, clock: VirtualClock
) -> None:
    async with opened(wire, clock, replace(wrist(), torque=1), config=ONE) as joints:
        wire.expect(write(3, 24, 0), status(3, error=0x21))
        wire.expect(read(3, 24, 1), status(3, 0, error=0x21))
        await joints.set_torque([False])
        assert joints.torque() == (False,)


async def test_a_servo_that_confirms_but_does_not_obey_is_told_of(wire: Wire, clock: VirtualClock) -> None:
    async with opened(wire, clock, replace(wrist(), torque=1), config=ONE) as joints:
        wire.expect(write(3, 24, 0), status(3))
        wire.expect(read(3, 24, 1), status(3, 1))
        with pytest.raises(BusError, match="confirmed to switch its torque off and did not"):
            await joints.set_torque([False])
        assert joints.torque() == (True,)


async def test_on_a_line_that_is_gone_torque_fails_at_once_with_the_reason(
    wire: Wire, clock: VirtualClock
) -> None:
    async with opened(wire, clock, *HOLDING) as joints:
        wire.lose("The adapter was unplugged.")
        with pytest.raises(BusError, match=r"^The adapter was unplugged\.$"):
            await joints.set_torque([False, False])
