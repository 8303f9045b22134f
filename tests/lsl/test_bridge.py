"""From a daemon's socket to streams, in virtual time and without liblsl."""

import asyncio
import json
import logging
from collections.abc import AsyncIterator, Callable, Sequence
from contextlib import AbstractAsyncContextManager, asynccontextmanager
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import cast

import numpy as np
import pytest
from click.testing import CliRunner

from bentod.cli.lsl import lsl
from bentod.client import Client
from bentod.endpoint import Disconnected, RpcError
from bentod.errors import BentodError, ConfigError
from bentod.frames import Value
from bentod.lsl import extra
from bentod.lsl.bridge import RETRY, Bridge
from bentod.lsl.sender import ForeignClock, Sender
from bentod.lsl.stream import Rows, Stream, Table
from bentod.lsl.times import Clocks
from tests.rig import PLAIN, running, sim_config, tables

OFFSET = 1000.0
"""s that LSL's clock shows more than ours."""


class FakeOutlet:
    def __init__(self, stream: Stream) -> None:
        self.stream = stream
        self.rows: list[Sequence[float] | str] = []
        self.times: list[float] = []
        self.open = True

    def push(self, rows: Rows, times: Sequence[float]) -> None:
        assert self.open
        assert len(rows) == len(times)
        self.rows += rows if isinstance(rows, list) else rows.tolist()
        self.times += times

    def close(self) -> None:
        self.open = False

    def column(self, label: str) -> list[float]:
        place = [channel.label for channel in self.stream.channels].index(label)
        return [float(row[place]) for row in self.rows]


class Network:
    """What would be on the network."""

    def __init__(self) -> None:
        self.outlets: list[FakeOutlet] = []

    def open(self, stream: Stream) -> FakeOutlet:
        self.outlets.append(FakeOutlet(stream))
        return self.outlets[-1]

    def __getitem__(self, name: str) -> FakeOutlet:
        found = [outlet for outlet in self.outlets if outlet.stream.name == name and outlet.open]
        assert len(found) == 1, [outlet.stream.name for outlet in self.outlets]
        return found[0]


def now() -> float:
    return asyncio.get_running_loop().time()


def new_sender(network: Network) -> Sender:
    return Sender(network.open, Clocks(lambda: now() + OFFSET, now))


@asynccontextmanager
async def bridged(
    connect: Callable[[], AbstractAsyncContextManager[Client]], network: Network, *topics: str
) -> AsyncIterator["asyncio.Task[None]"]:
    """A bridge under way; ended as Ctrl-C does it."""
    with Bridge(connect, new_sender(network), *([topics] if topics else [])) as bridge:
        task = asyncio.create_task(bridge.run())
        try:
            yield task
        finally:
            task.cancel()
            await asyncio.wait([task], timeout=5)
            assert task.done()
    assert not any(outlet.open for outlet in network.outlets)


async def test_streams_hold_what_a_subscriber_gets_at_the_same_times(tmp_path: Path) -> None:
    socket, network = tmp_path / "bentod.sock", Network()
    frames: list[Table] = []
    blocks: list[Table] = []
    async with running(sim_config(PLAIN), socket) as arm, bridged(partial(Client.connect, socket), network):
        await asyncio.sleep(3)
        async with asyncio.TaskGroup() as tasks:
            listeners = [
                tasks.create_task(_collect(arm, topic, into))
                for topic, into in (("state", frames), ("emg", blocks))
            ]
            await arm.call("trial_start", name="circuit", condition="dpcc")
            await asyncio.sleep(3)
            for listener in listeners:
                listener.cancel()
        await asyncio.sleep(0.5)
        state, emg, events = (network[name] for name in ("bentod state", "bentod EMG", "bentod events"))
    start = state.column("tick").index(cast("float", frames[0]["tick"]))
    span = slice(start, start + len(frames))
    assert len(frames) > 80
    assert state.column("tick")[span] == [frame["tick"] for frame in frames]
    assert state.times[span] == pytest.approx([cast("float", frame["time"]) + OFFSET for frame in frames])
    assert state.column("elbow_flexion.position")[span] == [
        tables(frame, "joints")[1]["position"] for frame in frames
    ]
    assert not np.isnan(state.column("elbow_flexion.prediction_20")).any()
    samples = [row for block in blocks for row in cast("list[list[float]]", block["samples"])]
    first = emg.rows.index(samples[0])
    assert emg.rows[first : first + len(samples)] == samples
    assert np.diff(emg.times) == pytest.approx(1 / 200)
    assert emg.times[first] == pytest.approx(cast("float", blocks[0]["time"]) + OFFSET)
    assert [channel.label for channel in emg.stream.channels] == ["flexor", "extensor", "other_forearm"]
    told = [json.loads(cast("str", row)) for row in events.rows]
    assert [event["data"]["condition"] for event in told if event["kind"] == "trial"] == ["dpcc"]


async def _collect(arm: Client, topic: str, into: list[Table]) -> None:
    async with arm.listen(topic, 500) as entries:
        async for entry in entries:
            into.append(entry)


async def test_a_daemon_that_is_started_again_goes_on_in_the_same_streams(tmp_path: Path) -> None:
    socket, network = tmp_path / "bentod.sock", Network()
    async with bridged(partial(Client.connect, socket), network):
        await asyncio.sleep(1)
        assert network.outlets == []  # nothing is known of the arm yet
        for _ in range(2):
            async with running(sim_config(PLAIN), socket):
                await asyncio.sleep(2.5)
        assert sorted(outlet.stream.name for outlet in network.outlets) == [
            "bentod EMG",
            "bentod events",
            "bentod state",
        ]
        ticks = network["bentod state"].column("tick")
    assert sum(later < earlier for earlier, later in pairwise(ticks)) == 1


async def test_another_arm_on_the_same_socket_gets_streams_of_its_own(tmp_path: Path) -> None:
    socket, network = tmp_path / "bentod.sock", Network()
    other = sim_config(PLAIN).model_copy(update={"arm": "Other arm"})
    async with bridged(partial(Client.connect, socket), network, "state", "events"):
        for config in (sim_config(PLAIN), other):
            async with running(config, socket):
                await asyncio.sleep(2.5)
        ids = {outlet.stream.source_id: outlet.open for outlet in network.outlets}
    assert ids == {
        "Bento Arm (simulated)/state": False,
        "Bento Arm (simulated)/events": False,
        "Other arm/state": True,
        "Other arm/events": True,
    }


STAY = 30.0
"""s until a FakeArm leaves."""


class FakeArm:
    """A daemon of another version, in which not everything is to be had."""

    def __init__(self, *entries: Table, lacks: tuple[str, ...] = ()) -> None:
        self.entries = entries
        self.lacks = lacks

    async def call(self, method: str, **_: Value) -> Value:
        if method in self.lacks:
            raise RpcError("bad_request", f"there is no method '{method}'")
        return {"arm": "Old arm", "rate_hz": 30.0} if method == "get_info" else None

    @asynccontextmanager
    async def listen(self, topic: str, _rate_hz: float) -> AsyncIterator[AsyncIterator[Table]]:
        if topic in self.lacks:
            raise RpcError("bad_request", f"topic is '{topic}'")
        yield self._told(topic)

    async def _told(self, topic: str) -> AsyncIterator[Table]:
        for entry in self.entries if topic == "events" else ():
            yield entry
        await asyncio.sleep(STAY)
        raise Disconnected("It left.")

    @asynccontextmanager
    async def connect(self) -> AsyncIterator[Client]:
        yield cast("Client", self)


def event(time: float) -> Table:
    return {"time": time, "kind": "trial", "text": "", "data": {}}


async def test_who_ends_it_in_the_moment_in_which_the_daemon_leaves_is_heard() -> None:
    async with bridged(FakeArm(event(1.0)).connect, Network()):
        await asyncio.sleep(STAY)


async def test_a_topic_that_the_daemon_lacks_is_left_out_and_said(caplog: pytest.LogCaptureFixture) -> None:
    network, arm = Network(), FakeArm(event(1.0), lacks=("emg", "emg_get"))
    with caplog.at_level(logging.INFO):
        async with bridged(arm.connect, network):
            await asyncio.sleep(10)
            assert network["bentod events"].times == [1.0 + OFFSET]
    assert "no stream of emg: topic is 'emg'" in caplog.text


@pytest.mark.parametrize("time", [-500.0, 500.0, float("nan")])
async def test_times_of_another_clock_are_refused_not_passed_on(time: float) -> None:
    network = Network()
    async with bridged(FakeArm(event(time)).connect, network) as task:
        with pytest.raises(ForeignClock, match=r"machine's clock; the bound is 60 s"):
            await task
        assert network["bentod events"].rows == []


@asynccontextmanager
async def failing(error: BentodError | None, tries: list[float]) -> AsyncIterator[Client]:
    tries.append(now())
    if error:
        raise error
    yield cast("Client", None)


async def test_the_daemon_is_looked_for_less_and_less_often_but_for_ever() -> None:
    tries: list[float] = []
    async with bridged(partial(failing, Disconnected("No daemon answers."), tries), Network()):
        await asyncio.sleep(60)
    waits = np.diff(tries)
    assert waits[0] == pytest.approx(2 * RETRY[0])
    assert waits[-1] == pytest.approx(RETRY[1])
    assert max(waits) <= RETRY[1] + 1e-6
    assert len(tries) < 25


async def test_a_socket_that_somebody_else_could_serve_ends_it() -> None:
    error = ConfigError("The socket belongs to another user.", "socket")
    async with bridged(partial(failing, error, []), Network()) as task:
        with pytest.raises(ConfigError, match="another user"):
            await task


def test_without_pylsl_the_extra_is_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    def missing(target: str) -> object:
        raise ConfigError(f"{target} cannot be loaded: No module named 'pylsl'")

    monkeypatch.setattr(extra, "resolve", missing)
    ended = CliRunner().invoke(lsl, ["--socket", str(tmp_path / "bentod.sock")])
    assert ended.exit_code == 1
    assert "pip install 'bentod[lsl]'" in ended.output


def test_a_daemon_of_another_machine_is_refused() -> None:
    ended = CliRunner().invoke(lsl, ["--socket", "tls://arm.lab:4776"])
    assert ended.exit_code == 2
    assert "on the arm's own machine" in ended.output
