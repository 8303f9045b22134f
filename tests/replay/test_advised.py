"""A session whose learners were advised is thought again bit for bit, or not at all."""

import asyncio
from dataclasses import dataclass
from pathlib import Path

import pytest

from bentod import registry
from bentod.config_file import parse
from bentod.config_tables import Record
from bentod.errors import ConfigError
from bentod.frames import Frame, Value
from bentod.learn.snapshot import Snapshot, read, taken, write
from bentod.record.reader import Recording
from bentod.replay.relearn import Relearner, same_thoughts, ticks
from bentod.replay.stage import standing_by
from sim.clock import run
from tests.rig import PLAIN, running, sim_config

ELBOW = "elbow_flexion.position@20"
ADVISED = f"""
adviser = "old"

[[learn.advisers]]
name = "old"
snapshot = "SNAPSHOT"

[[learn.representations]]
name = "heard"
[[learn.representations.tiles]]
inputs = ['norm(advice("old", "{ELBOW}"), -1, 1)', "norm(elbow_flexion.position)"]
memory = 256

[[learn.gvfs]]
name = "heard"
cumulant = "elbow_flexion.velocity"
timescale_s = 0.5
representation = "heard"

[assist]
"""
ADDED: dict[str, Value] = {
    "name": "late",
    "cumulant": 'advice("old", "shoulder_rotation.position@10")',
    "timescale": 5,
}


@dataclass(frozen=True)
class Sessions:
    """A recording of a session with an adviser, and the snapshot that advised it."""

    recording: Path
    snapshot: Path


@pytest.fixture(scope="module")
def sessions(tmp_path_factory: pytest.TempPathFactory) -> Sessions:
    folder = tmp_path_factory.mktemp("advised")
    run(_session(folder, "first"))
    with Recording(folder / "first") as recording:
        again = relearner(recording)
        for tick in ticks(recording.entries()):
            again.step(tick)
        assert again.learners
        write(folder / "old.snapshot", taken(again.learners, "an arm", 0.0, 0))
    run(_session(folder, "second", ("[assist]\n", ADVISED.replace("SNAPSHOT", str(folder / "old.snapshot")))))
    return Sessions(folder / "second", folder / "old.snapshot")


async def _session(folder: Path, name: str, *changes: tuple[str, str]) -> None:
    tables = ("[learn.snapshot]\nevery_s = 60                # and at the end\n", "")
    config = sim_config(PLAIN, tables, *changes)
    config = config.model_copy(update={"record": Record(folder=folder / name)})
    async with running(config, folder / "bentod.sock") as arm:
        await asyncio.sleep(4)
        if changes:
            await arm.call("gvf_add", gvf=ADDED)
            await asyncio.sleep(2)


def relearner(recording: Recording) -> Relearner:
    return Relearner(parse(recording.header.config, "the recording", registry))


def thoughts(sessions: Sessions) -> list[tuple[Frame, Frame]]:
    with Recording(sessions.recording) as recording:
        again = relearner(recording)
        return [(tick.frame, again.step(tick)) for tick in ticks(recording.entries())]


def test_what_an_advised_arm_thought_is_thought_again_bit_for_bit(sessions: Sessions) -> None:
    told = thoughts(sessions)
    assert len(told) > 150
    assert [live.tick for live, again in told if not same_thoughts(live, again)] == []
    assert [live.tick for live, again in told if live.learn != again.learn] == []
    assert "late" in told[-1][0].learn.predictions


def test_the_recording_says_which_snapshot_gave_the_advice(sessions: Sessions) -> None:
    with Recording(sessions.recording) as recording:
        learn = parse(recording.header.config, "the recording", registry).learn
    assert learn
    (adviser,) = learn.advisers
    assert (adviser.snapshot, adviser.digest) == (sessions.snapshot, read(sessions.snapshot).digest)


def test_with_another_snapshot_in_its_place_nothing_is_thought_again_but_it_is_still_played(
    sessions: Sessions,
) -> None:
    whole = sessions.snapshot.read_bytes()
    other = read(sessions.snapshot)
    write(sessions.snapshot, Snapshot({**other.header, "tick": 1}, other.arrays))
    try:
        with Recording(sessions.recording) as recording:
            with pytest.raises(ConfigError, match="is another snapshot than that which was used"):
                relearner(recording)
            assert standing_by(parse(recording.header.config, "the recording", registry)).predictor is None
    finally:
        sessions.snapshot.write_bytes(whole)
