import logging
from dataclasses import replace

import pytest

from bentod.errors import BusError
from bentod.frames import Freshness, Stop
from drivers.dynamixel.joints import DynamixelJoints, open_over
from sim.clock import VirtualClock
from tests.drivers.dynamixel.arm import CONFIG, WRIST, expect_audit, longer, read, window, wrist
from tests.drivers.dynamixel.wire import Wire
from tests.fakes import cleared

ONE = replace(CONFIG, joints=(WRIST,))
GONE = "The adapter was unplugged."
HOLDING = replace(wrist(), torque=1)


class Socket:
    """Where the adapter is plugged in: a new line each time, or none."""

    def __init__(self) -> None:
        self.lines: list[Wire] = []
        self.absent = False
        self.servo = HOLDING
        self.tried = 0

    def connect(self) -> Wire:
        self.tried += 1
        if self.absent:
            raise BusError("There is no such port.")
        self.lines.append(Wire())
        expect_audit(self.lines[-1], self.servo)
        return self.lines[-1]


@pytest.fixture
def socket() -> Socket:
    return Socket()


async def ticks(joints: DynamixelJoints, clock: VirtualClock, count: int) -> list[str]:
    """Problems in so many ticks."""
    problems = []
    for _ in range(count):
        began = clock.now()
        problems.append((await joints.read()).problem)
        assert clock.now() - began < 0.5 / 30
        await joints.write([Stop()])
        await clock.sleep_until(began + 1 / 30)
    return problems


async def test_a_port_that_comes_back_is_opened_audited_and_used_again(
    socket: Socket, clock: VirtualClock, caplog: pytest.LogCaptureFixture
) -> None:
    async with open_over(socket.connect, ONE, clock) as joints:
        socket.absent = True
        socket.lines[0].lose(GONE)
        problems = await ticks(joints, clock, 60)
        assert problems[0] == f"{GONE} Reconnecting."
        assert problems[-1] == "There is no such port. Reconnecting."
        assert socket.tried < 8
        with caplog.at_level(logging.WARNING):
            socket.absent = False
            await clock.sleep_until(clock.now() + 1.5)
        assert "The servos are back, with torque on: wrist_rotation." in caplog.text
        socket.lines[1].expect(read(3, 34, 11), longer(window(3, position=2100), 0))
        state = await joints.read()
    assert state.problem == ""
    assert state.joints[0].freshness is Freshness.FRESH
    assert [line.closed for line in socket.lines] == [True, True]


async def test_torque_is_taken_as_it_is_found_and_not_asked_for(socket: Socket, clock: VirtualClock) -> None:
    async with open_over(socket.connect, ONE, clock) as joints:
        assert joints.torque() == (True,)
        socket.servo = wrist()
        socket.lines[0].lose(GONE)
        await joints.read()
        await clock.sleep_until(clock.now() + 0.1)
        assert joints.torque() == (False,)
        assert socket.lines[1].finished()


async def test_another_servo_in_its_place_is_not_accepted(socket: Socket, clock: VirtualClock) -> None:
    async with open_over(socket.connect, ONE, clock) as joints:
        socket.servo = replace(wrist(), number=310)
        socket.lines[0].lose(GONE)
        await joints.read()
        await clock.sleep_until(clock.now() + 0.05)
        assert "has model number 310 (an MX-64)" in (await joints.read()).problem


async def test_when_every_servo_is_silent_the_line_is_opened_anew(
    socket: Socket, clock: VirtualClock
) -> None:
    async with open_over(socket.connect, ONE, clock) as joints:
        socket.lines[0].dead = True
        while len(socket.lines) == 1:
            (problem,) = await ticks(joints, clock, 1)
        assert problem == "No servo answers any more; check the power of the arm. Reconnecting."
        assert clock.now() == pytest.approx(0.5, abs=0.1)
        await clock.sleep_until(clock.now() + 0.1)
        socket.lines[1].dead = True
        assert socket.lines[0].closed
        assert socket.lines[1].finished()
        assert await ticks(joints, clock, 1) == [""]


async def test_while_the_bus_is_being_found_again_nothing_is_asked_of_it(
    socket: Socket, clock: VirtualClock
) -> None:
    async with open_over(socket.connect, ONE, clock) as joints:
        socket.absent = True
        socket.lines[0].lose(GONE)
        await joints.read()
        with pytest.raises(BusError, match="Reconnecting"):
            await joints.set_torque([False])
        (need,) = await cleared(joints, [0])
        assert need.endswith("Reconnecting.")


async def test_leaving_ends_the_search(socket: Socket, clock: VirtualClock) -> None:
    async with open_over(socket.connect, ONE, clock) as joints:
        socket.absent = True
        socket.lines[0].lose(GONE)
        await ticks(joints, clock, 3)
    tried = socket.tried
    await clock.sleep_until(clock.now() + 5)
    assert socket.tried == tried
