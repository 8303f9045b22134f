"""What was learned lasts from session to session, or is set aside, with the reason, and harms no arm."""

import asyncio
import logging
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from bentod.config_learn import SnapshotTable
from bentod.config_tables import Record
from bentod.frames import Frame
from bentod.learn.horde import Horde
from bentod.learn.snapshot import read
from bentod.learned import snapshot_path
from bentod.record.reader import Recording
from bentod.replay.altered import relearner
from bentod.replay.relearn import same_thoughts, ticks
from sim.clock import run
from tests.rig import PLAIN, number, quiet_config, running, wait_for

SHOULDER, MINIMUM = 0, -1.347
"""The first joint, which stands at 0, and its minimum (rad), which is expected before anything is learned."""

Change = tuple[str, str]


def session(folder: Path, *changes: Change, seconds: float = 1.0, count: int = 1) -> Path:
    """A session of an arm that stands still, which is kept in `folder`; the folder of its recording."""
    kept = ("every_s = 60", f'path = "{folder / "kept"}"\nevery_s = 5 ')
    recorded = folder / f"recording-{count}"
    config = quiet_config(PLAIN, kept, *changes).model_copy(update={"record": Record(folder=recorded)})

    async def live() -> None:
        async with running(config, folder / "bentod.sock") as arm:
            await wait_for(arm, lambda frame: number(frame, "tick") > seconds * 30)

    run(live())
    return recorded


def first_tick(recorded: Path) -> Frame:
    with Recording(recorded) as recording:
        return next(iter(recording.frames()))


def expected(frame: Frame, timescale: str = "20") -> float:
    return frame.joints[SHOULDER].predictions[timescale]


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two sessions, one after the other."""
    folder = tmp_path_factory.mktemp("learned")
    session(folder, seconds=3)
    session(folder, seconds=3, count=2)
    return folder


def test_a_second_start_expects_the_right_thing_from_its_first_tick(place: Path) -> None:
    first, second = (first_tick(place / f"recording-{count}") for count in (1, 2))
    assert expected(first) == pytest.approx(MINIMUM, abs=0.1)
    assert expected(second) == pytest.approx(0.0, abs=0.2)


def test_a_session_that_began_with_a_snapshot_is_thought_again_bit_for_bit(place: Path) -> None:
    with Recording(place / "recording-2") as recording:
        told = list(ticks(recording.entries()))
        header = recording.header
    again = relearner(header, {})
    assert [tick.frame.tick for tick in told if not same_thoughts(tick.frame, again.step(tick))] == []
    assert len(told) > 90
    without = relearner(replace(header, learned=b""), {})
    assert not same_thoughts(told[0].frame, without.step(told[0]))


def test_what_the_first_session_left_behind_can_be_learned_from_its_recording(place: Path) -> None:
    with Recording(place / "recording-1") as recording:
        again = relearner(recording.header, {})
        for tick in ticks(recording.entries()):
            again.step(tick)
        with Recording(place / "recording-2") as second:
            carried = second.header.learned
    (place / "carried").write_bytes(carried)
    left, learned = read(place / "carried").arrays, again.learners
    assert learned is not None
    memory: Mapping[str, NDArray[np.float64]] = learned.memory()
    assert left.keys() == memory.keys()
    assert [name for name, array in left.items() if array.tobytes() != memory[name].tobytes()] == []


def test_a_snapshot_of_another_representation_is_set_aside_with_the_difference_and_the_arm_goes_on(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    session(tmp_path)
    old = (tmp_path / "kept").read_bytes()
    with caplog.at_level(logging.INFO):
        recorded = session(
            tmp_path, ("timescales = [10, 20]", "timescales = [10, 20]\ntilings = 80"), count=2
        )
    assert "representation arm: tiles.0.tilings 80 here, 100 in the snapshot" in caplog.text
    assert "It is kept as kept.refused-1" in caplog.text
    assert (tmp_path / "kept.refused-1").read_bytes() == old
    assert expected(first_tick(recorded)) == pytest.approx(MINIMUM, abs=0.1)


def test_a_question_that_is_new_begins_and_the_others_go_on(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    session(tmp_path, seconds=2)
    with caplog.at_level(logging.INFO):
        recorded = session(tmp_path, ("timescales = [10, 20]", "timescales = [10, 20, 40]"), count=2)
    assert "These questions begin anew, for the snapshot does not know them: shoulder" in caplog.text
    found = first_tick(recorded)
    assert expected(found, "40") == pytest.approx(MINIMUM, abs=0.1)
    assert expected(found, "20") == pytest.approx(0.0, abs=0.3)


def test_the_log_says_who_learns_and_with_which_kernel(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    with caplog.at_level(logging.INFO):
        session(tmp_path, ("timescales = [10, 20]", 'timescales = [10, 20]\nkernel = "numpy"'), seconds=0.5)
    assert "10 GVFs learn with the kernel numpy" in caplog.text
    assert f"Nothing is known yet; learning is kept in {tmp_path / 'kept'}" in caplog.text


def test_a_place_where_nothing_can_be_kept_is_a_warning_and_no_more(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    (tmp_path / "in_the_way").touch()
    session(tmp_path, ("/kept", "/in_the_way/kept"))
    assert f"No snapshot can be written to {tmp_path / 'in_the_way' / 'kept'}" in caplog.text


def test_a_copy_for_which_there_is_no_memory_does_not_end_the_arm(
    tmp_path: Path, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    copied: Callable[[Horde], Iterator[dict[str, NDArray[np.float64]]]] = Horde.memories
    asked: list[Horde] = []

    def memories(horde: Horde) -> Iterator[dict[str, NDArray[np.float64]]]:
        asked.append(horde)
        if len(asked) == 1:
            raise MemoryError
        yield from copied(horde)

    monkeypatch.setattr(Horde, "memories", memories)
    session(tmp_path, seconds=5.5)
    assert caplog.text.count("There is no memory for a copy of what was learned") == 1
    assert read(tmp_path / "kept").header["arm"] == "Bento Arm (simulated)"


def test_what_has_no_name_is_kept_only_where_the_config_says() -> None:
    state = {"XDG_STATE_HOME": "/state"}
    assert snapshot_path(SnapshotTable(), "config/sim.toml", state) == Path(
        "/state/bentod/learned/sim.snapshot"
    )
    assert snapshot_path(SnapshotTable(), "", state) is None
    assert snapshot_path(SnapshotTable(path=Path("/srv/x")), "", state) == Path("/srv/x")
    service = {"STATE_DIRECTORY": "/var/lib/bentod", **state}
    assert snapshot_path(SnapshotTable(), "b.toml", service) == Path("/var/lib/bentod/learned/b.snapshot")


async def test_nothing_is_kept_of_a_daemon_that_has_no_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    async with running(quiet_config(PLAIN), tmp_path / "bentod.sock"):
        await asyncio.sleep(0.5)
    assert list(tmp_path.rglob("*snapshot*")) == []
