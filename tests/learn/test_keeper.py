"""What a disk can do to snapshots, and that it does nothing to who takes them."""

import errno
import os
import threading
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import cast

import numpy as np
import pytest
from numpy.typing import NDArray

from bentod.errors import SnapshotError
from bentod.frames import Value
from bentod.learn.differences import differences
from bentod.learn.keeper import Keeper, keep, previous, restore, resume, set_aside
from bentod.learn.snapshot import Snapshot, read, taken, write


def numbered(number: int) -> Snapshot:
    return Snapshot({"number": number}, {"w": np.full(3, float(number))})


def number(snapshot: Snapshot | None) -> Value:
    return snapshot.header["number"] if snapshot else None


class Disk:
    """Keeps what it is given in memory; fails as told, and waits while its gate is shut."""

    def __init__(self) -> None:
        self.kept: list[Value] = []
        self.error: Exception | None = None
        self.gate, self.at_gate = threading.Event(), threading.Event()
        self.gate.set()
        self.threads: set[int] = set()

    def store(self, path: Path, snapshot: Snapshot) -> int:
        self.threads.add(threading.get_ident())
        self.at_gate.set()
        self.gate.wait()
        if self.error:
            raise self.error
        self.kept.append(snapshot.header["number"])
        return 100


def until(condition: Callable[[], bool]) -> None:
    while not condition():
        os.sched_yield()


def test_snapshots_are_written_by_another_thread_and_the_one_before_stays(tmp_path: Path) -> None:
    path = tmp_path / "state" / "arm.snapshot"
    with Keeper(path, 60) as keeper:
        for count in (1, 2, 3):
            keeper.put(numbered(count))
            until(lambda count=count: keeper.status.written == count)  # type: ignore[misc]
    assert (number(read(path)), number(read(previous(path)))) == (3, 2)
    assert keeper.status.bytes == path.stat().st_size
    assert keeper.take_events() == []
    assert {found.name for found in path.parent.iterdir()} == {path.name, previous(path).name}


def test_while_one_is_written_only_the_newest_waits_and_nobody_else_does(tmp_path: Path) -> None:
    disk = Disk()
    disk.gate.clear()
    with Keeper(tmp_path / "s", 60, disk.store) as keeper:
        keeper.put(numbered(1))
        disk.at_gate.wait()
        for count in range(2, 50):
            keeper.put(numbered(count))
        disk.gate.set()
    assert disk.kept == [1, 49]
    assert threading.get_ident() not in disk.threads


def test_a_snapshot_is_due_after_each_period_of_the_given_clock(tmp_path: Path) -> None:
    keeper = Keeper(tmp_path / "s", 60)
    assert [now for now in range(0, 200, 10) if keeper.due(1000.0 + now)] == [60, 120, 180]


def test_a_disk_that_fails_is_told_of_once_for_each_way_in_which_it_does(tmp_path: Path) -> None:
    disk = Disk()
    tried = [
        OSError(errno.ENOSPC, "No space left on device"),
        OSError(errno.ENOSPC, "No space left on device"),
        OSError(errno.EROFS, "Read-only file system"),
        OSError(errno.ENOSPC, "No space left on device"),
        ValueError("an array has no place"),
        None,
        OSError(errno.ENOSPC, "No space left on device"),
    ]
    told = []
    with Keeper(tmp_path / "s", 60, disk.store) as keeper:
        for count, error in enumerate(tried):
            disk.error = error
            disk.at_gate.clear()
            keeper.put(numbered(count))
            disk.at_gate.wait()
            until(lambda error=error: bool(keeper.status.problem) == bool(error))  # type: ignore[misc]
        keeper.close()
        told = keeper.take_events()
    where = tmp_path / "s"
    assert told == [
        f"No snapshot can be written to {where}: No space left on device.",
        f"No snapshot can be written to {where}: Read-only file system.",
        f"No snapshot can be written to {where}: ValueError: an array has no place.",
        f"Snapshots are written to {where} again.",
        f"No snapshot can be written to {where}: No space left on device.",
    ]
    assert (disk.kept, keeper.status.written) == ([5], 1)


def test_the_last_one_is_written_at_the_end(tmp_path: Path) -> None:
    disk = Disk()
    with Keeper(tmp_path / "s", 60, disk.store) as keeper:
        keeper.put(numbered(1))
        keeper.close(numbered(2))
        keeper.put(numbered(3))
        keeper.close(numbered(4))
    assert disk.kept[-1] == 2
    assert not set(disk.kept) & {3, 4}


def test_a_dead_disk_does_not_hold_up_the_end(tmp_path: Path) -> None:
    disk = Disk()
    disk.gate.clear()
    with Keeper(tmp_path / "s", 60, disk.store) as keeper:
        keeper.close(numbered(1), patience=0.01)
        (told,) = keeper.take_events()
        assert "was not written within 0.01 s" in told
        disk.gate.set()


def test_a_folder_that_cannot_be_made_is_a_sentence(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with Keeper(tmp_path / "file" / "s", 60) as keeper:
        keeper.put(numbered(1))
    (told,) = keeper.take_events()
    assert told.startswith(f"No snapshot can be written to {tmp_path / 'file' / 's'}: ")
    assert keeper.status.problem == told


def test_without_a_snapshot_nothing_is_restored_and_nothing_is_said(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    assert restore(tmp_path / "none" / "s") is None
    assert caplog.messages == []


def test_the_newest_is_restored_or_else_the_one_before_it_and_the_broken_one_is_kept(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    path = tmp_path / "s"
    keep(path, numbered(1))
    keep(path, numbered(2))
    assert number(restore(path)) == 2
    broken = path.read_bytes()[:-1]
    path.write_bytes(broken)
    assert number(restore(path)) == 1
    assert "is cut off" in caplog.messages[0]
    assert "kept as s.refused-1" in caplog.messages[0]
    assert "the snapshot before the newest" in caplog.messages[1]
    assert (tmp_path / "s.refused-1").read_bytes() == broken
    assert number(restore(path)) == 1
    keep(path, numbered(3))
    assert (number(read(path)), number(read(previous(path)))) == (3, 1)


def test_after_a_power_cut_between_the_two_renames_the_previous_one_is_found(tmp_path: Path) -> None:
    path = tmp_path / "s"
    keep(path, numbered(1))
    os.replace(path, previous(path))
    assert number(restore(path)) == 1


def test_what_is_refused_never_takes_the_place_of_what_was_refused_before(tmp_path: Path) -> None:
    for count in (1, 2, 3):
        (tmp_path / "s").write_text(str(count))
        assert set_aside(tmp_path / "s") == tmp_path / f"s.refused-{count}"
    assert (tmp_path / "s.refused-1").read_text() == "1"


class Learners:
    """Questions that are asked with one λ, each with a weight."""

    def __init__(self, names: str = "ab", lam: float = 0.95, tilings: int = 100) -> None:
        self.lam, self.tilings = lam, tilings
        self.weights = dict.fromkeys(names, 0.0)

    def spec(self) -> dict[str, Value]:
        return {
            "questions": [{"name": name, "lam": self.lam} for name in self.weights],
            "representations": {"arm": {"tilings": self.tilings}},
        }

    def memory(self) -> dict[str, NDArray[np.float64]]:
        return {name: np.array([weight]) for name, weight in self.weights.items()}

    def recall(self, spec: Mapping[str, Value], memory: Mapping[str, NDArray[np.float64]]) -> list[str]:
        mine = self.spec()
        if spec["representations"] != mine["representations"]:
            raise SnapshotError("; ".join(differences(mine, spec)))
        asked = cast("list[dict[str, str]]", mine["questions"])
        same = [it["name"] for it in cast("list[dict[str, str]]", spec["questions"]) if it in asked]
        self.weights |= {name: float(memory[name][0]) for name in same}
        return [name for name in self.weights if name not in same]


def learned(path: Path) -> Learners:
    """Learners that know something, and a snapshot of them."""
    learners = Learners()
    learners.weights = {"a": 1.0, "b": 2.0}
    write(path, taken(learners, "Bento", 1.7e9, 900))
    return learners


def test_learners_go_on_from_where_they_left_off(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    learned(tmp_path / "s")
    learners = Learners()
    assert resume(tmp_path / "s", learners)
    assert learners.weights == {"a": 1.0, "b": 2.0}
    assert not resume(tmp_path / "none", learners)
    assert caplog.messages == []
    assert [path.name for path in tmp_path.iterdir()] == ["s"]


def test_what_a_snapshot_does_not_know_begins_anew(tmp_path: Path) -> None:
    learned(tmp_path / "s")
    learners = Learners("abc")
    assert resume(tmp_path / "s", learners)
    assert learners.weights == {"a": 1.0, "b": 2.0, "c": 0.0}
    assert [path.name for path in tmp_path.iterdir()] == ["s"]


@pytest.mark.parametrize(
    ("learners", "told"),
    [(Learners("a"), "not gone on with: b."), (Learners(lam=0.9), "not gone on with: a, b.")],
)
def test_what_is_not_gone_on_with_is_not_lost(
    tmp_path: Path, caplog: pytest.LogCaptureFixture, learners: Learners, told: str
) -> None:
    path = tmp_path / "s"
    learned(path)
    before = path.read_bytes()
    assert resume(path, learners)
    assert told in caplog.text
    for count in (1, 2, 3):
        keep(path, numbered(count))
    assert (tmp_path / "s.refused-1").read_bytes() == before


def test_a_snapshot_that_is_refused_is_moved_aside_and_never_written_over(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    path, learners = tmp_path / "s", Learners(tilings=64)
    learned(previous(path))
    learned(path)
    before = path.read_bytes()
    assert not resume(path, learners)
    assert not any(learners.weights.values())
    assert "representation arm: tilings 64 here, 100 in the snapshot" in caplog.text
    for count in (1, 2, 3):
        keep(path, numbered(count))
    assert (tmp_path / "s.refused-1").read_bytes() == before
    assert (tmp_path / "s.1.refused-1").read_bytes() == before
