"""A recording of a whole daemon, played by the real player to real clients in virtual time."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import pytest
from click.testing import CliRunner

from bentod import registry
from bentod.cli.replay import lines, replay
from bentod.client import Client
from bentod.config_file import parse
from bentod.config_tables import Record
from bentod.endpoint import RpcError
from bentod.frames import Frame
from bentod.messages import pack
from bentod.record.reader import Recording
from bentod.replay.comparison import compared
from bentod.replay.player import Span
from bentod.replay.relearn import Relearner, Thought, ticks
from bentod.replay.stage import Stage
from sim.clock import VirtualClock, run
from tests.rig import PLAIN, number, running, sim_config, table


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Ten seconds of the simulated arm, recorded."""
    place = tmp_path_factory.mktemp("stage")
    run(_ten_seconds(place))
    return place / "recordings"


async def _ten_seconds(place: Path) -> None:
    config = sim_config(PLAIN).model_copy(update={"record": Record(folder=place / "recordings")})
    async with running(config, place / "live.sock") as arm:
        await arm.call("assist_set", k=0.05)
        await asyncio.sleep(10)


@asynccontextmanager
async def playing(folder: Path, *, learn: bool = False) -> AsyncIterator[tuple[Stage, Client, Recording]]:
    """The recording behind a socket, paused at its beginning, and a client of it."""
    with Recording(folder) as recording:
        config = parse(recording.header.config, "the recording", registry)
        tape = Thought(recording, Relearner(config)) if learn else recording
        span = Span(recording.info.start, recording.info.end)
        stage = Stage(tape, span, config, VirtualClock(), folder.parent / "replay.sock")
        stage.player.pause(True)
        async with stage.server, Client.connect(folder.parent / "replay.sock") as client:
            task = asyncio.create_task(stage.player.run())
            try:
                yield stage, client, recording
            finally:
                task.cancel()


async def test_clients_get_every_frame_as_it_was_live_and_then_the_replay_is_over(folder: Path) -> None:
    async with playing(folder) as (stage, client, recording):
        told = [frame async for frame in _frames(client, stage, len(list(recording.frames())))]
        frames = list(recording.frames())
    assert [frame["tick"] for frame in told] == [frame.tick for frame in frames]
    assert [pack(frame) for frame in told[:50]] == [pack(frame) for frame in frames[:50]]


async def _frames(client: Client, stage: Stage, count: int) -> AsyncIterator[dict[str, object]]:
    async with client.listen("state", rate_hz=500) as frames:
        stage.player.pause(False)
        async with asyncio.timeout(60):
            for _ in range(count):
                yield dict(await anext(frames))


@pytest.mark.parametrize("learn", [False, True])
async def test_clients_ask_what_they_would_ask_of_the_arm_and_move_nothing(folder: Path, learn: bool) -> None:
    async with playing(folder, learn=learn) as (_, client, recording):
        await client.call("replay_seek", 5.0)
        await asyncio.sleep(0.1)
        info = table(await client.call("get_info"))
        assert info["arm"] == recording.header.arm
        frame = table(await client.call("get_state"))
        assert number(table(await client.call("replay_get")), "position_s") == pytest.approx(5.0, abs=0.04)
        groups = await client.call("group_list")
        assert isinstance(groups, list)
        assert len(groups) == 2
        for method, named in (
            ("pause", {"on": False}),
            ("torque", {}),
            ("go_home", {}),
            ("assist_set", {"k": 0.1}),
        ):
            with pytest.raises(RpcError, match="this is a recording"):
                await client.call(method, **named)
        await client.call("replay_pause", False)
        await asyncio.sleep(1)
        assert number(table(await client.call("get_state")), "tick") > number(frame, "tick") + 20
        await client.call("stop")
        await asyncio.sleep(0.1)
        assert table(await client.call("replay_get"))["paused"] is True


async def test_what_is_compared_with_itself_is_equal_in_every_tick(folder: Path) -> None:
    with Recording(folder) as recording:
        config = parse(recording.header.config, "the recording", registry)
        found = compared(ticks(recording.entries()), Relearner(config))
        frames = len(list(recording.frames()))
    assert (found.ticks, found.equal, found.first_other) == (frames, frames, -1)
    assert all(error.live == error.again for error in found.errors)
    assert f"{frames} of {frames} ticks" in lines(found)[0]


async def test_seeking_while_it_learns_again_learns_nothing_across_the_gap(folder: Path) -> None:
    with Recording(folder) as recording:
        config = parse(recording.header.config, "the recording", registry)
        entries = Thought(recording, Relearner(config)).entries(recording.info.start + 5)
        first = next(entry for entry in entries if isinstance(entry, Frame))
    assert first.gap


def test_the_command_says_what_is_wrong_in_a_sentence(tmp_path: Path) -> None:
    done = CliRunner().invoke(replay, [str(tmp_path / "none.mcap")])
    assert (done.exit_code, "does not exist" in done.output) == (1, True)
    assert CliRunner().invoke(replay, [str(tmp_path), "--serve"]).exit_code == 2
    assert "neither above 0 nor max" in CliRunner().invoke(replay, [str(tmp_path), "--speed", "-1"]).output


async def test_the_command_compares_with_other_parameters(folder: Path) -> None:
    same = await asyncio.to_thread(CliRunner().invoke, replay, [str(folder), "--learn"])
    assert "times real time" in same.output
    assert "The first that was not" not in same.output
    other = await asyncio.to_thread(
        CliRunner().invoke, replay, [str(folder), "--learn", "--set", "learn.step_size=0.1"]
    )
    assert "The first that was not is tick 1." in other.output
    wrong = await asyncio.to_thread(
        CliRunner().invoke, replay, [str(folder), "--learn", "--set", "learn.step_sise=0.1"]
    )
    assert (wrong.exit_code, "step_size" in wrong.output) == (1, True)


async def test_a_player_is_told_by_its_methods(folder: Path) -> None:
    async with playing(folder) as (_, client, _recording):
        told = await client.call("list_methods")
    assert isinstance(told, list)
    names = [str(table(method)["name"]) for method in told]
    assert {"move", "replay_get", "replay_seek"} < set(names)
    assert len(names) == len(set(names))
