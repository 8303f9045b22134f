"""What a disk can do to a recording, and that it does nothing to who records."""

import errno
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest

from bentod.frames import Event, Frame
from bentod.record.disk import Budget
from bentod.record.reader import Recording
from bentod.record.recorder import Recorder
from bentod.record.scribe import FLUSH, SYNC, Limits, Scribe, describe
from bentod.record.session import Counts, Entry, Info
from tests.record.rig import FIRST, HEADER, FakeDisk, session, until
from tests.record.strategies import bits


def stored(disk: FakeDisk, folder: Path, synced: bool = False) -> Path:
    """What is on a disk in memory, or what a power cut leaves of it, as real files."""
    for name, sink in disk.files.items():
        (folder / name).write_bytes(sink.data[: sink.synced] if synced else sink.data)
    return folder / FIRST


def found(path: Path) -> tuple[list[Entry], Info]:
    with Recording(path) as recording:
        return list(recording.entries()), recording.info


@contextmanager
def stuck(disk: FakeDisk, limits: Limits | None = None) -> Iterator[Recorder]:
    """A recorder whose thread waits for the disk; the disk comes back at the end."""
    disk.gate.clear()
    with Recorder(HEADER, disk, limits) as recorder:
        disk.at_gate.wait()
        try:
            yield recorder
        finally:
            disk.gate.set()


def test_a_disk_that_hangs_makes_nobody_wait_and_what_is_lost_is_told(tmp_path: Path) -> None:
    disk, entries = FakeDisk(), session(3)
    lost = len(entries) - 50
    with stuck(disk, Limits(waiting=50)) as recorder:
        for entry in entries:
            recorder.put(entry)
        assert recorder.status.waiting == 50
        assert recorder.status.dropped.total == lost
        assert recorder.take_events() == [
            "The disk is too slow for the recording: 50 entries wait, and what comes now is dropped."
        ]
    kept, info = found(stored(disk, tmp_path))
    assert bits(kept) == bits(entries[:50])
    assert info.dropped.total == lost
    assert not info.whole
    assert recorder.take_events() == [
        f"The recording lost {describe(info.dropped)} because the disk was too slow."
    ]


def test_a_loss_is_noted_where_it_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("bentod.record.recorder.PATIENCE", 0.001)  # the queue is emptied thirty times
    disk = FakeDisk()
    frames = [entry for entry in session(2) if isinstance(entry, Frame)]
    with stuck(disk, Limits(waiting=10)) as recorder:
        for frame in frames[:30]:
            recorder.put(frame)
        disk.gate.set()
        for frame in frames[30:]:
            until(partial(_empty, recorder))
            recorder.put(frame)
    kept, info = found(stored(disk, tmp_path))
    assert [frame.tick for frame in kept if isinstance(frame, Frame)] == [*range(10), *range(30, 60)]
    gap = info.tick_gaps[0]
    assert (gap.start, gap.end, gap.missing) == (frames[9].time, frames[30].time, 20)
    assert info.dropped == Counts(frames=20)


def _empty(recorder: Recorder) -> bool:
    return recorder.status.waiting == 0


def test_memory_is_bounded_by_bytes_too() -> None:
    disk = FakeDisk()
    with stuck(disk, Limits(waiting_bytes=1e6)) as recorder:
        for number in range(20):
            recorder.put(
                Event(0.0, "client", "x" * 100_000, {"number": number, "deep": [{"a": b"x" * 9000}]})
            )
        assert 5 < recorder.status.waiting < 10
        assert recorder.status.dropped.events == 20 - recorder.status.waiting


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EIO, errno.EROFS])
@pytest.mark.parametrize(
    ("call", "after"), [("open", 0), ("write", 0), ("write", 4), ("sync", 0), ("write", 9)]
)
def test_a_disk_that_fails_ends_the_recording_and_nothing_else(
    tmp_path: Path, call: str, after: int, number: int
) -> None:
    disk, entries = FakeDisk(), session(4)
    disk.fail(call, number, after)
    with Recorder(HEADER, disk) as recorder:
        for entry in entries:
            recorder.put(entry)
    status = recorder.status
    assert errno.errorcode[number] in status.problem
    assert recorder.take_events() == [status.problem]
    assert status.waiting == 0
    assert all(sink.closed for sink in disk.files.values())
    if status.written.total:
        kept, info = found(stored(disk, tmp_path))
        assert bits(kept) == bits(entries[: len(kept)])
        assert not info.complete


def test_what_is_put_after_the_end_is_counted() -> None:
    disk = FakeDisk()
    disk.fail("open", errno.ENOSPC)
    with Recorder(HEADER, disk) as recorder:
        until(lambda: recorder.status.problem != "")
        recorder.put(session(0.1)[1])
        assert recorder.status.dropped == Counts(frames=1)
    recorder.put(session(0.1)[0])
    assert recorder.status.dropped == Counts(frames=1, emg=1)


def test_a_dead_disk_does_not_hold_up_the_end() -> None:
    disk = FakeDisk()
    with stuck(disk) as recorder:
        recorder.close(patience=0.01)
        assert "was not ended" in recorder.status.problem
        assert recorder.take_events() == [recorder.status.problem]


def test_closing_twice_is_closing_once(tmp_path: Path) -> None:
    disk = FakeDisk()
    with Recorder(HEADER, disk) as recorder:
        recorder.put(session(0.1)[1])
        recorder.close()
    assert found(stored(disk, tmp_path))[1].whole


def test_an_entry_that_does_not_fit_the_schema_is_left_out_and_told(tmp_path: Path) -> None:
    disk, entries = FakeDisk(), session(1)
    frame = entries[1]
    assert isinstance(frame, Frame)
    odd = replace(frame, mode="dancing")  # type: ignore[arg-type]
    with Recorder(HEADER, disk) as recorder:
        for entry in (odd, *entries, odd, 5):
            recorder.put(entry)  # type: ignore[arg-type]
    kept, info = found(stored(disk, tmp_path))
    assert bits(kept) == bits(entries)
    assert info.dropped.frames == 2
    assert recorder.status.dropped.total == 3
    assert "dancing" in recorder.take_events()[0]


@pytest.mark.parametrize(
    ("budget", "told"),
    [(Budget(2e6, 0), "recordings may use 0.002 GB"), (Budget(1e12, 1e12 - 1e6), "GB of the disk stay free")],
)
def test_a_budget_is_told_of_before_it_ends_the_recording(tmp_path: Path, budget: Budget, told: str) -> None:
    disk, now = FakeDisk(), 0.0
    disk.others = round(1e6)
    scribe = Scribe(HEADER, disk, Limits(budget=budget), lambda: now)
    scribe.open()
    assert told in scribe.sentences.popleft()
    for entry in session(60):
        scribe.put(entry)
        now += 0.5 / 30
        try:
            scribe.tend()
        except Exception as error:  # noqa: BLE001
            scribe.fail(error)
            break
    assert told in scribe.problem
    info = found(stored(disk, tmp_path))[1]
    assert info.problems == (scribe.problem,)
    assert not info.ticks_missing
    assert (
        info.counts
        == scribe.written
        == Counts(info.counts.frames, info.counts.emg, *[info.counts.events] * 2)
    )
    assert 0.7e6 < info.bytes < 1.2e6


def test_a_power_cut_costs_at_most_what_two_periods_have(tmp_path: Path) -> None:
    disk, now, worst = FakeDisk(), 0.0, 0.0
    scribe = Scribe(HEADER, disk, Limits(), lambda: now)
    scribe.open()
    frames = [entry for entry in session(9) if isinstance(entry, Frame)]
    told = [bits(frame) for frame in frames]
    for number, frame in enumerate(frames):
        now = number / 30
        scribe.put(frame)
        scribe.tend()
        if number % 23 == 0:
            kept, _ = found(stored(disk, tmp_path, synced=True))
            assert [bits(entry) for entry in kept] == told[: len(kept)]
            worst = max(worst, (number + 1 - len(kept)) / 30)
    assert SYNC / 2 < worst <= SYNC + FLUSH + 2 / 30


def test_a_new_part_begins_after_its_time(tmp_path: Path) -> None:
    disk, now, entries = FakeDisk(), 0.0, session(5)
    scribe = Scribe(HEADER, disk, Limits(part_seconds=1.0), lambda: now)
    scribe.open()
    for number, entry in enumerate(entries):
        now = number / 60
        scribe.put(entry)
        scribe.tend()
    scribe.finish()
    kept, info = found(stored(disk, tmp_path))
    assert len(disk.files) == 1 + int(now)
    assert bits(kept) == bits(entries)
    assert info.whole
