"""What is put is what is read: by our reader, by others', whole, in parts, and by stretches."""

import json
import os
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader
from mcap.stream_reader import StreamReader

from bentod.errors import RecordingError
from bentod.frames import ClientCommand, EmgBlock, Event, Frame, Trial
from bentod.record.codec import SCHEMAS
from bentod.record.disk import Folder
from bentod.record.reader import Recording
from bentod.record.recorder import Recorder
from bentod.record.scribe import Limits
from bentod.record.session import Counts, Entry
from tests.record import strategies
from tests.record.rig import FIRST, HEADER, read, record, session, small_block, with_frames
from tests.record.strategies import SLOW_IS_FINE, bits


def test_a_session_is_read_back_bit_by_bit_and_in_order(tmp_path: Path) -> None:
    entries = session()
    assert bits(read(record(tmp_path, entries))) == bits(entries)


@given(st.lists(strategies.entries, max_size=8))
@settings(SLOW_IS_FINE, max_examples=25)
def test_any_session_is_read_back_bit_by_bit(
    tmp_path_factory: pytest.TempPathFactory, entries: list[Entry]
) -> None:
    assert bits(read(record(tmp_path_factory.mktemp("any"), entries))) == bits(entries)


def test_the_header_is_read_back(tmp_path: Path) -> None:
    with Recording(record(tmp_path, ())) as recording:
        assert bits(recording.header) == bits(HEADER)
        assert list(recording.entries()) == []


def test_files_are_named_after_the_session_and_not_for_everybody_to_read(tmp_path: Path) -> None:
    old = os.umask(0o077)
    try:
        path = record(tmp_path / "new" / "folder", session(0.1))
    finally:
        os.umask(old)
    assert path.name == FIRST
    assert path.stat().st_mode & 0o777 == 0o640


def test_a_session_never_overwrites_another(tmp_path: Path) -> None:
    first = record(tmp_path, session(0.1)).read_bytes()
    with Recorder(HEADER, Folder(tmp_path)) as second:
        second.put(small_block(0))
    assert "File exists" in second.status.problem
    assert (tmp_path / FIRST).read_bytes() == first


@pytest.mark.parametrize("kind", [Frame, EmgBlock, Event, ClientCommand])
def test_one_kind_can_be_read_alone(tmp_path: Path, kind: type[Entry]) -> None:
    entries = session()
    with Recording(record(tmp_path, entries)) as recording:
        found = list(recording.entries(kinds=(kind,)))
    assert bits(found) == bits([entry for entry in entries if type(entry) is kind])


@given(st.floats(99, 103), st.floats(99, 103))
@settings(SLOW_IS_FINE, max_examples=30)
def test_a_stretch_has_what_lies_within_it(
    long_session: tuple[Path, list[Entry]], start: float, end: float
) -> None:
    path, entries = long_session
    with Recording(path) as recording:
        found = list(recording.entries(start, end))
    assert bits(found) == bits([entry for entry in entries if start <= entry.time < end])


@pytest.fixture(scope="module")
def long_session(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[Entry]]:
    entries = session(3)
    return record(tmp_path_factory.mktemp("long"), entries, Limits(part_bytes=30e3)), entries


def test_a_part_of_a_stretch_starts_at_the_very_entry(long_session: tuple[Path, list[Entry]]) -> None:
    path, entries = long_session
    frames = [entry for entry in entries if isinstance(entry, Frame)]
    with Recording(path) as recording:
        found = [frame.tick for frame in recording.frames(frames[20].time, frames[30].time)]
    assert found == list(range(20, 30))


def test_parts_are_one_session_from_any_of_them_and_from_their_folder(
    long_session: tuple[Path, list[Entry]],
) -> None:
    path, entries = long_session
    parts = sorted(path.parent.iterdir())
    assert len(parts) > 3
    for place in (parts[0], parts[2], path.parent):
        with Recording(place) as recording:
            assert bits(list(recording.entries())) == bits(entries)
            assert recording.info.whole
            assert recording.info.files == tuple(parts)


def test_a_part_alone_is_a_recording_too(long_session: tuple[Path, list[Entry]]) -> None:
    path, entries = long_session
    second = sorted(path.parent.iterdir())[1]
    with Recording(second, alone=True) as recording:
        found = list(recording.entries())
        assert recording.header == replace(HEADER, part=2)
        assert recording.info.complete
    assert 0 < len(found) < len(entries)


def test_a_part_that_is_gone_is_missed(long_session: tuple[Path, list[Entry]], tmp_path: Path) -> None:
    for part in sorted(long_session[0].parent.iterdir()):
        (tmp_path / part.name).write_bytes(part.read_bytes())
    sorted(tmp_path.iterdir())[1].unlink()
    with Recording(tmp_path) as recording:
        info = recording.info
    assert "Part 2 is missing." in info.problems
    assert not info.complete
    assert info.ticks_missing == info.tick_gaps[0].missing > 0
    assert info.samples_missing == info.emg_gaps[0].missing > 0


def test_the_info_of_a_whole_session_says_so(tmp_path: Path) -> None:
    entries = session(2)
    with Recording(record(tmp_path, entries)) as recording:
        info = recording.info
    assert info.whole
    assert info.counts == Counts(frames=60, emg=60, events=2, commands=2)
    assert (info.samples, info.samples_missing, info.ticks_missing) == (2000, 0, 0)
    assert (info.start, info.end) == (100.0, 100.0 + 59 / 30)
    assert (info.live, info.problems) == (False, ())


def test_ticks_and_samples_that_are_not_there_are_missed(tmp_path: Path) -> None:
    entries = session(1)
    frames = [entry for entry in entries if isinstance(entry, Frame)]
    kept: list[Entry] = [*frames[:10], *frames[13:], small_block(0), small_block(10), small_block(25)]
    with Recording(record(tmp_path, kept)) as recording:
        info = recording.info
    assert [gap.missing for gap in info.tick_gaps] == [3] == [info.ticks_missing]
    assert (info.tick_gaps[0].start, info.tick_gaps[0].end) == (frames[9].time, frames[13].time)
    assert [gap.missing for gap in info.emg_gaps] == [5] == [info.samples_missing]
    assert not info.whole


def test_ticks_that_the_daemon_skipped_are_told_apart_from_missing_ones(tmp_path: Path) -> None:
    entries = [entry for entry in session(1) if isinstance(entry, Frame)]
    later = [replace(entry, missed=4) for entry in entries[20:]]
    with Recording(record(tmp_path, [*entries[:20], *later])) as recording:
        assert (recording.info.ticks_skipped, recording.info.ticks_missing) == (4, 0)


def test_trials_and_metadata_are_known_without_reading_the_frames(tmp_path: Path) -> None:
    entries = session(3)
    one, two = Trial(1, "box", "dpcc", 100.5), Trial(2, "box", "toggling", 101.5)
    parts = [
        with_frames(entries[n * 40 : n * 40 + 40], trial=t) for n, t in enumerate((None, one, None, two))
    ]
    parts[1] = with_frames(parts[1], meta={"participant": "p08"})
    frames = [[e for e in part if isinstance(e, Frame)] for part in parts]
    with Recording(
        record(tmp_path, [*parts[0], *parts[1], *parts[2], *parts[3]], Limits(part_bytes=30e3))
    ) as recording:
        info = recording.info
    assert [(s.trial, s.start, s.end, s.ended) for s in info.trials] == [
        (one, frames[1][0].time, frames[2][0].time, True),
        (two, frames[3][0].time, frames[3][-1].time, False),
    ]
    assert [value for _, value in info.metas] == [
        frames[0][0].meta,
        {"participant": "p08"},
        frames[0][0].meta,
    ]


def test_a_clock_that_is_set_does_not_reorder_and_can_be_seen(tmp_path: Path) -> None:
    frames = [entry for entry in session(1) if isinstance(entry, Frame)]
    jumped = [replace(frame, wall=frame.wall - 3600) for frame in frames[15:]]
    path = record(tmp_path, [*frames[:15], *jumped])
    with path.open("rb") as file:
        times = [
            m.log_time for _, channel, m in make_reader(file).iter_messages() if channel.topic == "/frame"
        ]
    assert times == [round(1.7e9 * 1e9) + round(tick / 30 * 1e9) for tick in range(30)]
    assert [entry for entry in read(path) if isinstance(entry, Frame)][15].wall == jumped[0].wall


def test_the_reader_of_the_format_s_authors_reads_it_and_finds_every_checksum_right(tmp_path: Path) -> None:
    path = record(tmp_path, session(2))
    with path.open("rb") as file:
        records = list(StreamReader(file, validate_crcs=True).records)
    assert len(records) > 100
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        summary = reader.get_summary()
        assert summary is not None
        assert summary.statistics is not None
        counts = summary.statistics.channel_message_counts
        topics = {channel.topic: counts.get(number, 0) for number, channel in summary.channels.items()}
        assert topics.pop("/frame") == topics.pop("/emg") == 60
        assert topics.pop("/event") == topics.pop("/command") == topics.pop("/log") == 2
        assert topics == {"/mark": 1, "/recording": 1, "/joints": 20}
        assert {schema.name for schema in summary.schemas.values()} == set(SCHEMAS.values())
        assert sum(1 for _ in reader.iter_messages()) == summary.statistics.message_count
        found = {a.name: a.data.decode() for a in reader.iter_attachments()}
        assert found == {"config.toml": HEADER.config, "robot.urdf": HEADER.urdf}
        metadata = {record.name: record.metadata for record in reader.iter_metadata()}
    assert metadata["bentod.session"]["arm"] == HEADER.arm
    assert json.loads(metadata["bentod.joints"]["spare"])["home"] == 0.25


def test_a_recording_of_a_newer_version_says_so(tmp_path: Path) -> None:
    path = record(tmp_path, session(0.2), header=replace(HEADER, schema=7))
    with pytest.raises(
        RecordingError, match=r"version 7 of the schema; this bentod reads versions up to 1\."
    ):
        Recording(path)


@pytest.mark.parametrize("content", [b"", b"hello", b"\x89MCAP0\r\n", b"\x89MCAP0\r\n" + b"\0" * 100])
def test_what_is_no_recording_is_told(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "x.mcap").write_bytes(content)
    with pytest.raises(RecordingError, match=r"x\.mcap is not"):
        Recording(tmp_path / "x.mcap")


def test_a_folder_must_hold_one_session(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match="no recording"):
        Recording(tmp_path)
    record(tmp_path, ())
    record(tmp_path, (), header=replace(HEADER, session="another"))
    with pytest.raises(RecordingError, match="2 sessions"):
        Recording(tmp_path)
    with pytest.raises(RecordingError, match="does not exist"):
        Recording(tmp_path / "none.mcap")
