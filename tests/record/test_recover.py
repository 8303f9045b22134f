"""Recordings that were cut off anywhere: what is read of them, and what mending makes of them."""

import os
from pathlib import Path
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader

from bentod.errors import RecordingError, Refused
from bentod.record.disk import Folder, default_folder, session_name
from bentod.record.reader import Recording
from bentod.record.recorder import Recorder
from bentod.record.recover import recover
from bentod.record.session import Entry
from tests.benchmarks.rigs.recorded import kills, limited
from tests.record.rig import FIRST, HEADER, read, record, session, until
from tests.record.strategies import SLOW_IS_FINE, bits


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> tuple[bytes, list[Entry]]:
    """A file and what was put into it."""
    entries = session(2)
    return record(tmp_path_factory.mktemp("whole"), entries).read_bytes(), entries


def start_of_data(data: bytes) -> int:
    """Bytes before the first chunk."""
    at = 8
    while data[at] != 6:
        at += 9 + int.from_bytes(data[at + 1 : at + 9], "little")
    return at


@given(st.data())
@settings(SLOW_IS_FINE, max_examples=25)
def test_a_file_that_is_cut_anywhere_is_a_prefix_before_and_after_mending(
    tmp_path: Path, whole: tuple[bytes, list[Entry]], data: st.DataObject
) -> None:
    content, entries = whole
    cut = data.draw(st.integers(start_of_data(content), len(content) - 1))
    path = tmp_path / FIRST
    path.write_bytes(content[:cut])
    before = read(path)
    with Recording(path) as recording:
        info = recording.info
    mended = recover(path)
    assert mended.aside is not None
    assert mended.aside.read_bytes() == content[:cut]
    mended.aside.unlink()
    assert bits(read(path)) == bits(before) == bits(entries[: len(before)])
    assert mended.entries == info.counts
    assert not info.complete
    with path.open("rb") as file:  # as the format's authors read it
        assert sum(1 for _ in make_reader(file, validate_crcs=True).iter_messages()) > len(before)


@pytest.mark.parametrize("seed", range(20))
def test_a_file_that_ends_within_its_header_is_told_to_be_lost(
    tmp_path: Path, whole: tuple[bytes, list[Entry]], seed: int
) -> None:
    content, _ = whole
    path = tmp_path / FIRST
    path.write_bytes(content[: Random(seed).randrange(start_of_data(content))])
    try:
        assert read(path) == []
    except RecordingError as error:
        assert "is not" in str(error)  # noqa: PT017 -- either is right, depending on where it was cut


def test_a_damaged_chunk_is_left_out_and_told(tmp_path: Path, whole: tuple[bytes, list[Entry]]) -> None:
    content, entries = whole
    path = tmp_path / FIRST
    at = start_of_data(content) + 2000
    path.write_bytes(content[:at] + bytes(64) + content[at + 64 :])
    with Recording(path) as recording:
        kept = list(recording.entries())
        assert not recording.info.complete
        assert "damaged" in recording.info.problems[0]
    assert bits(kept) == bits(entries[-len(kept) :])
    mended = recover(path)
    assert len(mended.damaged) == 1
    assert mended.missing == 0  # what is lost stood before the first chunk that is whole
    assert bits(read(path)) == bits(kept)


def test_a_chunk_that_is_lost_in_between_is_counted(tmp_path: Path, whole: tuple[bytes, list[Entry]]) -> None:
    content, entries = whole
    path = tmp_path / FIRST
    at = len(content) // 2
    path.write_bytes(content[:at] + bytes(64) + content[at + 64 : -5])
    mended = recover(path)
    kept = read(path)
    assert mended.missing >= len(entries) - len(kept) > 0
    with Recording(path) as recording:
        assert recording.info.ticks_missing > 0
        assert "mended" in recording.info.problems[0]


def test_a_whole_file_is_left_alone(tmp_path: Path) -> None:
    path = record(tmp_path, session(0.5))
    content = path.read_bytes()
    assert recover(path).aside is None
    assert path.read_bytes() == content
    assert os.listdir(tmp_path) == [FIRST]


def test_a_file_that_is_being_recorded_is_read_but_not_mended(tmp_path: Path) -> None:
    with Recorder(HEADER, Folder(tmp_path)) as recorder:
        for entry in session(1):
            recorder.put(entry)
        until(lambda: recorder.status.written.frames >= 20)
        with Recording(tmp_path) as recording:
            info = recording.info
        with pytest.raises(Refused, match="still being recorded"):
            recover(tmp_path / FIRST)
    assert info.live
    assert not info.complete
    assert info.problems == ()
    assert info.counts.frames >= 20


def test_a_failed_mending_changes_nothing(
    tmp_path: Path, whole: tuple[bytes, list[Entry]], monkeypatch: pytest.MonkeyPatch
) -> None:
    content = whole[0][:-100]
    (tmp_path / FIRST).write_bytes(content)

    def full(*paths: Path) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "link", full)
    with pytest.raises(RecordingError, match="No space left"):
        recover(tmp_path / FIRST)
    assert os.listdir(tmp_path) == [FIRST]
    assert (tmp_path / FIRST).read_bytes() == content


@pytest.mark.real_time
def test_what_a_killed_process_leaves_is_a_prefix_of_what_was_put(tmp_path: Path) -> None:
    for kill in kills(tmp_path, 2, seed=5, longest=1.5):
        assert kill.prefix
        assert kill.entries > 0


@pytest.mark.real_time
def test_a_file_that_may_not_grow_ends_the_recording_of_a_real_process(tmp_path: Path) -> None:
    done = limited(tmp_path, 200_000)
    assert done.returncode == 0, done.stderr
    assert "File too large" in done.stdout
    assert len(read(tmp_path)) > 0


def test_recordings_go_where_the_system_keeps_state() -> None:
    assert default_folder({"STATE_DIRECTORY": "/var/lib/bentod:/x"}) == Path("/var/lib/bentod/recordings")
    assert default_folder({"XDG_STATE_HOME": "/s"}) == Path("/s/bentod/recordings")
    assert default_folder({"HOME": "/h"}) == Path("/h/.local/state/bentod/recordings")


def test_sessions_are_named_after_their_time() -> None:
    assert session_name(1_795_374_245.9, 0x13F2A) == "2026-11-22T19-04-05Z-3f2a"
