"""A daemon records what it does, and the recording tells all of it again, learners included."""

import asyncio
from pathlib import Path

import pytest

from bentod import registry
from bentod.config import Config
from bentod.config_file import parse
from bentod.config_tables import Record
from bentod.endpoint import RpcError
from bentod.record.reader import Recording
from bentod.record.session import Header
from bentod.replay.relearn import Relearner, same_thoughts, ticks
from sim.clock import run
from tests.rig import PLAIN, number, running, sim_config, state, table, wait_for


def recorded(folder: Path, *changes: tuple[str, str]) -> Config:
    return sim_config(PLAIN, *changes).model_copy(update={"record": Record(folder=folder)})


def config_of(header: Header) -> Config:
    return parse(header.config, "the recording", registry)


@pytest.fixture(scope="module")
def session(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A minute in which a wearer used the arm and an experimenter ran trials and changed the assist."""
    folder = tmp_path_factory.mktemp("session")
    run(_minute(folder))
    return folder / "recordings"


async def _minute(folder: Path) -> None:
    async with running(recorded(folder / "recordings"), folder / "bentod.sock") as arm:
        await arm.call("hello", "experimenter")
        await arm.call("set_meta", {"participant": "P01"})
        await arm.call("trial_start", name="circuit", condition="dpcc")
        await asyncio.sleep(25)
        await arm.call("assist_set", k=0.1)
        await arm.call("trial_mark", "circuit")
        await asyncio.sleep(20)
        with pytest.raises(RpcError):
            await arm.call("go_home", joints="nose")
        await arm.call("trial_stop")
        await asyncio.sleep(10)
        assert table(await arm.call("get_recording"))["problem"] == ""


async def test_what_was_recorded_learns_again_bit_for_bit(session: Path) -> None:
    with Recording(session) as recording:
        relearner = Relearner(config_of(recording.header))
        told = list(ticks(recording.entries()))
    again = [relearner.step(tick) for tick in told]
    assert len(told) > 1600
    assert any(tick.frame.assist.engaged for tick in told)
    assert [
        tick.frame.tick
        for tick, other in zip(told, again, strict=True)
        if not same_thoughts(tick.frame, other)
    ] == []


async def test_another_parameter_leads_to_other_thoughts(session: Path) -> None:
    with Recording(session) as recording:
        config = config_of(recording.header)
        told = list(ticks(recording.entries()))
    assert config.learn
    other = config.model_copy(update={"learn": config.learn.model_copy(update={"step_size": 0.1})})
    again = [Relearner(other).step(tick) for tick in told[:50]]
    assert not all(same_thoughts(tick.frame, frame) for tick, frame in zip(told, again, strict=False))


async def test_a_recording_has_every_tick_every_sample_and_what_was_asked(session: Path) -> None:
    with Recording(session) as recording:
        assert recording.info.whole
        assert [span.trial.condition for span in recording.info.trials] == ["dpcc"]
        frames = list(recording.frames())
        blocks = list(recording.emg())
        commands = list(recording.commands())
        events = list(recording.events())
    assert [frame.tick for frame in frames] == list(range(len(frames)))
    assert sum(len(block.samples) for block in blocks) == pytest.approx(200 * len(frames) / 30, rel=0.02)
    asked = [(command.method, command.client, bool(command.error)) for command in commands]
    assert ("go_home", "experimenter", True) in asked
    assert [method for method, _, _ in asked][:3] == ["set_meta", "trial_start", "assist_set"]
    assert any(event.kind == "trial" and event.data["mark"] == "circuit" for event in events)
    assert frames[-1].meta == {"participant": "P01"}


async def test_subscribers_to_emg_get_every_sample(tmp_path: Path) -> None:
    async with running(recorded(tmp_path), tmp_path / "bentod.sock") as arm:
        next_index: int | None = None
        async with arm.listen("emg") as blocks:
            for _ in range(50):
                block = await anext(blocks)
                first, samples = block["first_index"], block["samples"]
                assert isinstance(first, int)
                assert isinstance(samples, list)
                assert next_index in (None, first)
                next_index = first + len(samples)


async def test_a_disk_that_cannot_be_written_ends_the_recording_and_nothing_else(tmp_path: Path) -> None:
    folder = tmp_path / "recordings"
    folder.write_text("in the way")
    async with running(recorded(folder), tmp_path / "bentod.sock") as arm:
        async with asyncio.timeout(600):  # of virtual time: the disk's thread knows no other than real time
            while not (problem := table(await arm.call("get_recording"))["problem"]):  # noqa: ASYNC110
                await asyncio.sleep(0.1)
        assert "The arm is not affected" in str(problem)
        tick = number(await state(arm), "tick")
        await wait_for(arm, lambda frame: frame["mode"] == "active" and number(frame, "tick") > tick + 30)
