"""Fifty subscribers at 30 Hz, some of them as bad as subscribers get: the others miss nothing."""

import asyncio
import logging
from contextlib import AsyncExitStack
from itertools import pairwise
from pathlib import Path

import pytest

from bentod.messages import Notification, Response
from bentod.serve.server import Server
from bentod.serve.session import Bounds
from tests.serve.helpers import Plug, frame, plugged, serving

RATE_HZ = 30
SECONDS = 10
FRAMES = RATE_HZ * SECONDS
GOOD = 47
LONG = "x" * 6000
"""As long as the frame of an arm."""


async def subscribed(stack: AsyncExitStack, path: Path) -> Plug:
    """A subscriber at every tick."""
    plug = await stack.enter_async_context(plugged(path))
    plug.ask(0, "subscribe", "state", RATE_HZ)
    assert await plug.next() == Response(0, None, None)
    return plug


async def listen(plug: Plug, ticks: list[int], times: list[float]) -> None:
    """Note every frame and when it came."""
    while (message := await plug.next()) is not None:
        match message:
            case Notification("state", [{"tick": int(tick)}]):
                ticks.append(tick)
                times.append(asyncio.get_running_loop().time())


async def read_a_byte_a_second(plug: Plug) -> None:
    transport = plug.writer.transport
    connection = plug.writer.get_extra_info("socket")
    transport.pause_reading()  # type: ignore[attr-defined]
    while True:
        await asyncio.sleep(1)
        connection._sock.recv(1)


async def publish(server: Server, replaced: dict[int, int]) -> None:
    """Every frame in its turn; notes what each client was too slow for while it is there."""
    for tick in range(FRAMES):
        server.publish_state(frame(tick, meta=LONG))
        replaced |= {session.id: session.replaced_frames for session in server.sessions}
        await asyncio.sleep(1 / RATE_HZ)


async def test_nobody_notices_the_stuck_the_slow_and_the_broken(
    path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    replaced: dict[int, int] = {}
    async with serving(path, bounds=Bounds(clients=64)) as server, AsyncExitStack() as stack:
        good = [await subscribed(stack, path) for _ in range(GOOD)]
        stuck, slow, broken = [await subscribed(stack, path) for _ in range(3)]
        assert len(server.sessions) == 50
        stuck.writer.transport.pause_reading()  # type: ignore[attr-defined]
        heard: list[tuple[list[int], list[float]]] = [([], []) for _ in good]
        tasks = [asyncio.ensure_future(listen(plug, *lists)) for plug, lists in zip(good, heard, strict=True)]
        tasks.append(asyncio.ensure_future(read_a_byte_a_second(slow)))
        asyncio.get_running_loop().call_later(1.01, _break_in_mid_frame, broken)
        await publish(server, replaced)
        left = {session.id for session in server.sessions}
        for task in tasks:
            task.cancel()

    assert all(ticks == list(range(FRAMES)) for ticks, _ in heard), "every frame, once, in order"
    gaps = [later - sooner for _, times in heard for sooner, later in pairwise(times)]
    assert max(gaps) == pytest.approx(1 / RATE_HZ, abs=1e-6)
    assert left == set(range(1, GOOD + 1)), "the three are gone"
    assert [replaced[id_] for id_ in range(1, GOOD + 1)] == [0] * GOOD
    dropped = [record.getMessage() for record in caplog.records if record.levelno == logging.WARNING]
    assert all(replaced[id_] > 3 * RATE_HZ for id_ in (48, 49))
    (text,) = dropped  # both are one user's, and that is told once
    assert "it has not read for 5 s" in text
    assert f"has missed {replaced[48]} frames and 0 events" in text


def _break_in_mid_frame(plug: Plug) -> None:
    plug.writer.get_extra_info("socket")._sock.recv(100)
    plug.writer.transport.abort()


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "bentod.sock"
