"""A daemon whose clients begin and end recordings, and mark what happens."""

import asyncio
from pathlib import Path

import pytest

from bentod.config import Config
from bentod.config_tables import Record
from bentod.endpoint import RpcError
from bentod.frames import Frame, Value
from bentod.record.reader import Recording
from tests.rig import PLAIN, quiet_config, running, sim_config, table, wait_for


def config(folder: Path, enabled: bool = True) -> Config:
    return sim_config(PLAIN).model_copy(update={"record": Record(folder=folder, enabled=enabled)})


def recorded(file: Value) -> tuple[list[Frame], list[tuple[str, str]]]:
    """Frames, and events as kind and sentence."""
    with Recording(Path(str(file))) as recording:
        assert recording.info.complete
        events = [(event.kind, event.text) for event in recording.events()]
        return list(recording.frames()), events


async def test_recordings_are_begun_and_ended_while_the_arm_goes_on(tmp_path: Path) -> None:
    async with running(config(tmp_path / "kept"), tmp_path / "bentod.sock") as arm:
        await arm.call("hello", "notebook")
        await arm.call("assist_set", k=0.07)
        first = table(await arm.call("get_recording"))
        second = table(await arm.call("recording_start", note="P01"))
        await asyncio.sleep(1)
        ended = table(await arm.call("recording_stop"))
        tick = (await wait_for(arm, lambda frame: True))["tick"]
        await wait_for(arm, lambda frame: frame["tick"] == int(str(tick)) + 5)
    assert (first["recording"], second["recording"], ended["recording"]) == (True, True, False)
    assert (second["note"], second["file"]) == ("P01", ended["file"])
    before, _ = recorded(first["file"])
    frames, events = recorded(second["file"])
    assert frames[0].tick == before[-1].tick + 1
    assert [frame.tick for frame in frames] == list(range(frames[0].tick, frames[-1].tick + 1))
    assert frames[-1].missed == before[0].missed == 0
    assert events[0] == ("recording", "notebook began a recording: P01")
    assert events[-1] == ("recording", "notebook ended the recording")
    assert any(kind == "assist" and "as the recording begins" in text for kind, text in events)


async def test_what_the_config_does_not_record_is_recorded_when_it_is_asked_for(tmp_path: Path) -> None:
    async with running(config(tmp_path / "kept", enabled=False), tmp_path / "bentod.sock") as arm:
        assert table(await arm.call("get_recording"))["recording"] is False
        with pytest.raises(RpcError, match="nothing is recorded"):
            await arm.call("recording_stop")
        begun = table(await arm.call("recording_start"))
        await asyncio.sleep(0.5)
        assert float(str(table(await arm.call("get_recording"))["duration_s"])) >= 0.5
    frames, _ = recorded(begun["file"])
    assert len(frames) >= 15


async def test_a_recording_that_cannot_begin_is_refused_with_the_reason(tmp_path: Path) -> None:
    (tmp_path / "kept").write_text("in the way")
    async with running(config(tmp_path / "kept", enabled=False), tmp_path / "bentod.sock") as arm:
        with pytest.raises(RpcError, match=r"nothing new is recorded: .*kept.* cannot be written"):
            await arm.call("recording_start")
        await wait_for(arm, lambda frame: frame["mode"] == "active")


async def test_a_mark_belongs_to_the_trial_that_runs_or_stands_for_itself(tmp_path: Path) -> None:
    async with (
        running(quiet_config(PLAIN), tmp_path / "bentod.sock") as arm,
        arm.listen("events") as events,
    ):
        await arm.call("hello", "notebook")
        assert await arm.call("mark", "door opened") is None
        await arm.call("trial_start", name="maze")
        assert table(await arm.call("mark", "contact"))["trial"] == 1
        told = [await anext(events) for _ in range(3)]
    assert [(event["kind"], event["text"], event["data"]) for event in told[:1]] == [
        ("mark", "notebook marked: door opened", {"mark": "door opened"})
    ]
    assert told[-1]["text"] == "trial 1 (maze) marked: contact"
