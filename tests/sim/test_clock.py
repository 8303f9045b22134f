import asyncio
import socket
import time

from sim.clock import EPOCH, VirtualClock


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
