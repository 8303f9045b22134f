"""A request to stop is heard and carried out, whoever makes it and whatever else is the matter with them."""

import asyncio
import logging
import os
import socket
from collections.abc import Iterator
from contextlib import AsyncExitStack, suppress
from pathlib import Path

import pytest

from bentod.client import Client
from bentod.config import Config
from bentod.endpoint import RpcError
from bentod.frames import Value
from bentod.messages import encode_notification, encode_request
from bentod.serve.server import KNOCKING, Server
from bentod.serve.session import Bounds, Session
from bentod.serve.spec import table
from tests.rig import PLAIN, joint, number, quiet_config, running, state
from tests.serve.doors import said, strict
from tests.serve.helpers import TOYS, plugged


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "bentod.sock"


@pytest.fixture
def deaf(path: Path) -> Iterator[socket.socket]:
    """A client that can be made to read nothing."""
    with socket.socket(socket.AF_UNIX) as connection:
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        yield connection


def config(requests_per_s: float = 2000.0) -> Config:
    found = quiet_config(PLAIN)
    return found.model_copy(
        update={"access": found.access.model_copy(update={"requests_per_s": requests_per_s})}
    )


async def fill(connection: socket.socket, path: Path, seconds: float) -> None:
    """Subscribe, and read nothing for so long."""
    connection.connect(str(path))
    connection.send(encode_request(1, "subscribe", ["state", 500.0]))
    await asyncio.sleep(seconds)


def wish(lease: float) -> bytes:
    return encode_request(2, "move", {"joint": "gripper", "velocity": 0.2, "lease_s": lease})


async def test_a_client_that_reads_nothing_can_still_stop_the_arm(path: Path, deaf: socket.socket) -> None:
    async with running(config(), path) as arm:
        await fill(deaf, path, 3)
        deaf.send(encode_request(2, "stop", []))
        await asyncio.sleep(0.1)
        assert (await state(arm))["mode"] == "paused"


async def test_what_a_client_asks_while_it_reads_nothing_is_not_done_later_either(
    path: Path, deaf: socket.socket
) -> None:
    async with running(config(), path) as arm:
        await fill(deaf, path, 3)
        deaf.send(wish(2.0))
        await asyncio.sleep(0.1)
        assert joint(await state(arm), "gripper")["holder"] == ""
        deaf.setblocking(False)
        for _ in range(100):
            with suppress(BlockingIOError):
                while deaf.recv(65536):
                    pass
            await asyncio.sleep(0.01)
        assert number(joint(await state(arm), "gripper"), "velocity") == 0.0
        deaf.send(wish(0.5))  # it reads again
        await asyncio.sleep(0.1)
        assert joint(await state(arm), "gripper")["holder"] != ""


async def late_wish(arm: Client) -> asyncio.Task[Value]:
    """A wish that has to wait for its turn, because too much was asked before it."""
    for _ in range(20):
        await arm.call("get_info")
    task = asyncio.create_task(arm.call("move", joint="gripper", velocity=0.2, lease_s=2.0))
    await asyncio.sleep(0.01)
    assert not task.done()
    return task


@pytest.mark.parametrize("halts", ["stop", "pause"])
async def test_a_wish_that_waits_for_its_turn_is_void_once_anybody_stops_or_pauses(
    path: Path, halts: str
) -> None:
    async with running(config(requests_per_s=5), path) as arm, Client.connect(path) as other:
        waiting = await late_wish(arm)
        await other.call(halts)
        await other.call("pause", on=False)
        with pytest.raises(RpcError, match="stopped, paused or released while this waited"):
            await waiting
        assert joint(await state(arm), "gripper")["holder"] == ""


async def test_a_wish_that_waits_for_its_turn_is_carried_out_if_nothing_happens(path: Path) -> None:
    async with running(config(requests_per_s=5), path) as arm:
        await (await late_wish(arm))
        assert joint(await state(arm), "gripper")["holder"] != ""


async def test_to_release_is_not_urgent_and_to_pause_is(path: Path) -> None:
    now = asyncio.get_running_loop().time
    async with running(config(requests_per_s=5), path) as arm:
        for _ in range(20):
            await arm.call("get_info")
        begin = now()
        await arm.call("pause")
        assert now() - begin < 0.1
        await arm.call("pause", None, False)
        assert now() - begin > 0.2


async def test_a_stop_has_the_last_word_of_all_that_comes_before_the_same_tick(path: Path) -> None:
    async with running(config(), path) as arm, Client.connect(path) as other:
        await asyncio.gather(other.call("stop"), arm.call("pause", on=False), other.call("stop"))
        assert (await state(arm))["mode"] == "paused"


async def test_a_thousand_stops_are_one_event_and_one_line(
    path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.INFO)
    async with running(config(), path) as arm, plugged(path) as plug:
        async with arm.listen("events") as events:
            plug.writer.write(encode_notification("stop", []) * 1000)
            plug.ask(1, "stop")
            assert await said(plug) == "None"
            await arm.call("pause")
            texts = [str((await anext(events))["text"]) for _ in range(2)]
        assert texts == [f"stopped by pid {os.getpid()}", "the arm paused"]
    assert caplog.text.count("stopped by pid") == 1


@pytest.mark.parametrize(
    "name", ["", "   ", "emg", "EMG", "The  Wearer", "home", "assist", "the daemon", "fault"]
)
async def test_nobody_goes_by_no_name_or_by_one_of_the_arms_own(path: Path, name: str) -> None:
    async with running(config(), path) as arm:
        with pytest.raises(RpcError, match="nobody's"):
            await arm.call("hello", name)
        await arm.call("hello", "the researcher")


def stoppable(path: Path, stopped: list[str], bounds: Bounds) -> Server:
    """A server of the toys and of a stop that takes until the next tick."""

    async def stop(session: Session) -> Value:
        """Stop."""
        await asyncio.sleep(1 / 30)
        stopped.append(session.client)
        return None

    return Server(table(observer=(*TOYS, stop)), path, bounds)


async def test_a_client_for_whom_there_is_no_room_may_stop_the_arm_and_nothing_else(path: Path) -> None:
    stopped: list[str] = []
    async with stoppable(path, stopped, Bounds(clients=1)) as server, plugged(path) as first:
        first.ask(1, "double", 1)
        await first.next()
        async with plugged(path) as second:
            second.ask(1, "double", 1)
            assert (
                await said(second)
                == "1 clients are connected; no more fit. This connection may only stop the arm."
            )
            second.ask(2, "stop")
            assert await said(second) == "None"
            assert await second.next() is None
        assert stopped == [f"pid {os.getpid()}"]
        assert len(server.sessions) == 1


async def test_a_client_for_whom_there_is_no_room_has_5_s_to_stop_the_arm(path: Path) -> None:
    async with stoppable(path, [], Bounds(clients=1)), plugged(path) as first, plugged(path) as second:
        first.ask(1, "double", 1)
        await first.next()
        assert await said(second) == "1 clients are connected; no more fit."
        assert 4.9 < asyncio.get_running_loop().time() < 5.1
        assert await second.next() is None


async def test_only_one_client_of_a_user_waits_without_a_place(path: Path) -> None:
    async with stoppable(path, [], Bounds(clients=1)), AsyncExitStack() as stack:
        first, _, third = [await stack.enter_async_context(plugged(path)) for _ in range(3)]
        assert await said(third) == "1 clients are connected; no more fit."
        assert asyncio.get_running_loop().time() < 1
        first.ask(1, "double", 1)
        assert await said(first) == "2.0"


async def test_a_crowd_at_the_door_cannot_keep_a_stop_out_for_longer_than_5_s(path: Path) -> None:
    stopped: list[str] = []
    async with stoppable(path, stopped, Bounds(clients=2)) as server, AsyncExitStack() as stack:
        for _ in range(3 * KNOCKING):
            await stack.enter_async_context(plugged(path))
        await asyncio.sleep(5.1)  # one of them had the user's last place
        last = await stack.enter_async_context(plugged(path))
        last.ask(1, "stop")
        await asyncio.sleep(0.1)
        assert stopped
        assert len(server._hosts) <= 2 + KNOCKING


async def test_stops_are_never_too_many_in_flight(path: Path) -> None:
    stopped: list[str] = []
    async with stoppable(path, stopped, Bounds(in_flight=2)), plugged(path) as plug:
        for id_ in range(30):
            plug.ask(id_, "stop")
        assert [await said(plug) for _ in range(30)] == ["None"] * 30


async def test_refusals_of_one_user_are_logged_now_and_then_however_often_it_connects(
    path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    async with strict(path):
        for _ in range(50):
            async with plugged(path) as plug:
                plug.ask(1, "move")
                await plug.next()
    assert sum("Refused move" in record.message for record in caplog.records) == 1
