"""Recordings that are begun and ended while entries go on coming."""

import asyncio
import errno
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from bentod.clock import SystemClock
from bentod.errors import Refused
from bentod.record.disk import Folder
from bentod.record.reader import Recording
from bentod.record.scribe import Limits
from bentod.record.session import Entry, Header
from bentod.record.takes import Takes
from tests.record.rig import HEADER, FakeDisk, session
from tests.record.strategies import bits

pytestmark = pytest.mark.real_time


def takes_on(disk: FakeDisk | Folder) -> Takes:
    return Takes(lambda: replace(HEADER, session=""), disk, Limits(), SystemClock())


@pytest.fixture
def disk() -> Iterator[FakeDisk]:
    disk = FakeDisk()
    yield disk
    disk.gate.set()


def entries_in(file: object) -> list[Entry]:
    with Recording(Path(str(file))) as recording:
        assert recording.info.complete
        return list(recording.entries())


def header_of(file: object) -> Header:
    with Recording(Path(str(file))) as recording:
        return recording.header


async def test_every_entry_is_in_one_of_two_files_and_none_in_both(tmp_path: Path) -> None:
    entries = session(2)
    with takes_on(Folder(tmp_path)) as takes:
        takes.begin(learned=b"")
        for entry in entries[:40]:
            takes.put(entry)
        before = takes.needed()
        await takes.start("after the break")
        for entry in entries[40:]:
            takes.put(entry)
        told = takes.describe()
    assert bits(entries_in(before.status.file)) == bits(entries[:40])
    assert bits(entries_in(told["file"])) == bits(entries[40:])
    assert header_of(told["file"]).note == told["note"] == "after the break"


async def test_a_file_is_whole_once_its_end_is_answered(tmp_path: Path) -> None:
    entries = session(1)
    with takes_on(Folder(tmp_path)) as takes:
        takes.begin()
        for entry in entries:
            takes.put(entry)
        await takes.stop()
        assert bits(entries_in(takes.describe()["file"])) == bits(entries)
        takes.put(entries[0])
        told = takes.describe()
    assert (told["recording"], told["problem"], told["dropped"]) == (False, "", 0)
    assert len(entries_in(told["file"])) == len(entries)


async def test_nothing_is_recorded_until_it_is_asked_for(disk: FakeDisk) -> None:
    with takes_on(disk) as takes:
        takes.put(session(1)[0])
        assert takes.describe()["recording"] is False
        with pytest.raises(Refused, match="nothing is recorded"):
            await takes.stop()
        assert disk.files == {}
        await takes.start("")
        assert takes.describe()["recording"] is True
    assert len(disk.files) == 1


async def test_a_full_disk_is_a_refusal_and_what_was_recorded_goes_on(disk: FakeDisk) -> None:
    with takes_on(disk) as takes:
        await takes.start("first")
        disk.fail("open", errno.ENOSPC)
        with pytest.raises(Refused, match=r"nothing new is recorded: .* cannot be written"):
            await takes.start("second")
        takes.put(session(1)[0])
        assert takes.describe()["note"] == "first"
        assert takes.recording


async def test_a_disk_that_hangs_is_a_refusal_too(disk: FakeDisk, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("bentod.record.takes.OPENING", 0.05)
    with takes_on(disk) as takes:
        disk.gate.clear()
        with pytest.raises(Refused, match=r"opened no file within 0\.05 s"):
            await takes.start("")
        assert not takes.recording


async def test_two_clients_do_not_begin_recordings_at_once(disk: FakeDisk) -> None:
    disk.gate.clear()
    with takes_on(disk) as takes:
        starting = asyncio.create_task(takes.start(""))
        await asyncio.to_thread(disk.at_gate.wait)
        with pytest.raises(Refused, match="just being begun or ended"):
            await takes.start("")
        disk.gate.set()
        await starting
    assert len(disk.files) == 1


async def test_who_leaves_while_a_recording_is_begun_leaves_none_behind(disk: FakeDisk) -> None:
    disk.gate.clear()
    with takes_on(disk) as takes:
        starting = asyncio.create_task(takes.start(""))
        await asyncio.to_thread(disk.at_gate.wait)
        starting.cancel()
        await asyncio.wait([starting])
        assert not takes.recording
        disk.gate.set()
        await takes.start("again")
        assert takes.recording
