"""Clients: calls find their answers, streams stay new, and a lost daemon is a clear error."""

import asyncio
import os
import time
from collections.abc import AsyncIterator
from pathlib import Path

import pytest
import pytest_asyncio

from bentod.blocking import BlockingClient
from bentod.client import Client
from bentod.endpoint import Disconnected, RpcError, default_socket_path
from bentod.errors import BadRequest
from bentod.frames import Value
from bentod.messages import Notification
from bentod.serve.server import Server
from bentod.serve.session import Bounds, Session
from tests.serve.helpers import event, frame, serving


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "bentod.sock"


async def test_a_call_returns_the_result(path: Path) -> None:
    async with serving(path), Client.connect(path) as arm:
        assert await arm.call("double", 4) == 8
        assert await arm.call("double", number=5) == 10


async def test_calls_side_by_side_get_their_own_answers(path: Path) -> None:
    async with serving(path), Client.connect(path) as arm:
        assert await asyncio.gather(*(arm.call("wait", 1 / n) for n in range(1, 9))) == [
            1 / n for n in range(1, 9)
        ]


async def test_an_error_has_code_message_and_field(path: Path) -> None:
    async with serving(path), Client.connect(path) as arm:
        with pytest.raises(RpcError, match="The arm is paused") as caught:
            await arm.call("refuse")
        assert (caught.value.code, caught.value.field) == ("refused", "joint")


async def test_positions_and_names_do_not_mix(path: Path) -> None:
    async with serving(path), Client.connect(path) as arm:
        with pytest.raises(BadRequest):
            await arm.call("double", 1, number=2)


async def test_an_answer_that_nobody_waits_for_any_more_is_ignored(path: Path) -> None:
    async with serving(path), Client.connect(path) as arm:
        with pytest.raises(TimeoutError):
            await asyncio.wait_for(arm.call("wait", 2), 1)
        await asyncio.sleep(2)
        assert await arm.call("double", 1) == 2


async def publish(server: Server) -> None:
    for tick in range(10_000):
        server.publish_state(frame(tick))
        await asyncio.sleep(1 / 30)


@pytest_asyncio.fixture
async def ticking(path: Path) -> AsyncIterator[Server]:
    async with serving(path) as server, asyncio.TaskGroup() as group:
        publishing = group.create_task(publish(server))
        yield server
        publishing.cancel()


async def test_states_arrive_at_the_chosen_rate(ticking: Server) -> None:
    async with Client.connect(ticking.path) as arm:
        ticks = []
        async for one in arm.subscribe_state(rate_hz=10):
            ticks.append(one["tick"])
            if len(ticks) == 3:
                break
        assert isinstance(ticks[0], int)
        assert ticks == [ticks[0], ticks[0] + 3, ticks[0] + 6]


async def test_a_reader_that_leaves_is_unsubscribed(ticking: Server) -> None:
    async with Client.connect(ticking.path) as arm:
        async with arm.listen("state") as frames, arm.listen("state") as twins:
            await anext(frames)
            await anext(twins)
        await arm.call("double", 1)
        assert not ticking.sessions[0].wants_state(1e9)


async def test_a_busy_reader_gets_the_newest_state(ticking: Server) -> None:
    async with Client.connect(ticking.path) as arm, arm.listen("state") as frames:
        before = (await anext(frames))["tick"]
        await asyncio.sleep(10)
        after = (await anext(frames))["tick"]
        assert isinstance(before, int)
        assert isinstance(after, int)
        assert after >= before + 290


async def test_events_arrive_in_order_and_none_is_missed(path: Path) -> None:
    async with serving(path) as server, Client.connect(path) as arm, arm.listen("events") as events:
        for number in range(5):
            server.publish_event(event(number))
        heard = [await anext(events) for _ in range(5)]
        assert [one["data"] for one in heard] == [{"number": number} for number in range(5)]


async def test_the_first_event_starts_the_subscription(path: Path) -> None:
    async with serving(path) as server, Client.connect(path) as arm:
        events = arm.subscribe_events()
        hearing = asyncio.ensure_future(anext(events))
        await asyncio.sleep(0.1)
        server.publish_event(event(1))
        assert (await hearing)["kind"] == "group"
        await events.aclose()


async def test_a_lost_daemon_ends_all_calls_and_streams(path: Path) -> None:
    async with serving(path) as server, Client.connect(path) as arm, arm.listen("events") as events:
        waiting = [asyncio.ensure_future(arm.call("wait", 50)) for _ in range(3)]
        hearing = asyncio.ensure_future(anext(events))
        await asyncio.sleep(0.1)
        server.sessions[0].drop()
        for future in (*waiting, hearing):
            with pytest.raises(Disconnected, match="closed"):
                await future
        with pytest.raises(Disconnected):
            await arm.call("double", 1)


async def test_no_daemon_is_a_clear_error(path: Path) -> None:
    with pytest.raises(Disconnected, match=r"No daemon answers at .*No such file"):
        async with Client.connect(path):
            pass


async def test_a_client_sent_away_learns_why(path: Path) -> None:
    server = serving(path, bounds=Bounds(clients=1))
    async with server, Client.connect(path), Client.connect(path) as second:
        await asyncio.sleep(0.1)
        with pytest.raises(RpcError, match="no more fit"):
            await second.call("double", 1)


@pytest.mark.parametrize(
    ("variables", "path"),
    [
        (
            {"RUNTIME_DIRECTORY": "/run/bentod:/run/b", "XDG_RUNTIME_DIR": "/run/user/1"},
            "/run/bentod/bentod.sock",
        ),
        ({"XDG_RUNTIME_DIR": "/run/user/1"}, "/run/user/1/bentod/bentod.sock"),
        ({}, f"/tmp/bentod-{os.getuid()}/bentod.sock"),  # noqa: S108 - only the name is tested
    ],
)
def test_the_socket_is_where_the_system_keeps_such_things(
    monkeypatch: pytest.MonkeyPatch, variables: dict[str, str], path: str
) -> None:
    for name in ("RUNTIME_DIRECTORY", "XDG_RUNTIME_DIR"):
        monkeypatch.delenv(name, raising=False)
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    assert default_socket_path() == Path(path)


@pytest.mark.real_time
async def test_the_blocking_client_calls_and_hears(path: Path) -> None:
    def use() -> list[object]:
        with BlockingClient(path) as arm:
            arm.call("subscribe", topic="events")
            results: list[object] = [arm.call("double", 4), arm.call("tell"), *arm.notifications(0.05)]
            with pytest.raises(RpcError, match="paused"):
                arm.call("refuse")
            return results

    async def tell(session: Session) -> Value:
        """Publish an event before the answer."""
        server.publish_event(event(1))
        await asyncio.sleep(0.01)
        return None

    server = serving(path, tell)
    async with server:
        double, told, notification = await asyncio.to_thread(use)
    assert (double, told) == (8, None)
    assert isinstance(notification, Notification)
    assert notification.method == "event"


@pytest.mark.real_time
async def test_the_blocking_client_waits_for_a_bounded_time(path: Path) -> None:
    def use() -> Value:
        with BlockingClient(path, timeout_s=0.05) as arm:
            with pytest.raises(Disconnected, match=r"did not answer wait within 0\.05 s"):
                arm.call("wait", 0.1)
            time.sleep(0.1)
            return arm.call("double", 1)

    async with serving(path):
        assert await asyncio.to_thread(use) == 2


@pytest.mark.real_time
async def test_the_blocking_client_notices_a_lost_daemon(path: Path) -> None:
    async with serving(path) as server:
        arm = await asyncio.to_thread(BlockingClient, path)
        await asyncio.sleep(0.01)
        server.sessions[0].drop()
        with pytest.raises(Disconnected):
            await asyncio.to_thread(arm.call, "double", 1)
        arm.close()


def test_the_blocking_client_says_when_there_is_no_daemon(path: Path) -> None:
    with pytest.raises(Disconnected, match="No daemon answers"):
        BlockingClient(path)
