import asyncio
import socket
import time

import pytest

from sim.clock import EPOCH, DriftingClock, VirtualClock, VirtualLoop


async def test_an_hour_of_virtual_time_passes_at_once(clock: VirtualClock) -> None:
    began = time.monotonic()
    await asyncio.sleep(3600)
    assert clock.now() >= 3600
    assert clock.wall() >= EPOCH + 3600
    assert time.monotonic() - began < 5


async def test_sleepers_wake_at_their_own_deadlines_in_order(clock: VirtualClock) -> None:
    woken: list[float] = []

    async def sleep(deadline: float) -> None:
        await clock.sleep_until(deadline)
        woken.append(clock.now())

    await asyncio.gather(sleep(0.3), sleep(0.1), sleep(0.100_001), sleep(-1.0))
    assert woken == [0.0, 0.1, 0.100_001, 0.3]


async def test_bytes_in_a_socket_come_before_the_next_timer(clock: VirtualClock) -> None:
    ours, theirs = socket.socketpair()
    ours.setblocking(False)
    with ours, theirs:
        theirs.send(b"now")
        async with asyncio.timeout(1):
            assert await asyncio.get_running_loop().sock_recv(ours, 3) == b"now"
    assert clock.now() < 1


async def test_a_callback_that_computes_for_long_makes_everybody_late(clock: VirtualClock) -> None:
    loop = asyncio.get_running_loop()
    assert isinstance(loop, VirtualLoop)
    loop.call_at(0.1, loop.block, 0.2)
    await clock.sleep_until(0.15)
    assert clock.now() == pytest.approx(0.3)


async def test_a_drifting_clock_keeps_its_own_time_without_a_jump(clock: VirtualClock) -> None:
    own = DriftingClock(clock)
    own.drift = 0.01
    await own.sleep_until(10.1)
    assert clock.now() == pytest.approx(10.0)
    own.drift = -0.01
    assert own.now() == pytest.approx(10.1)
    await clock.sleep_until(20.0)
    assert own.now() == pytest.approx(20.0)
    assert own.wall() == clock.wall()
