"""Keeps what is learned on a disk, from a thread of its own, and finds it again at the next start."""

import logging
import os
import threading
from collections import deque
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from types import TracebackType
from typing import Self

from bentod.errors import SnapshotError
from bentod.learn.differences import by_name
from bentod.learn.snapshot import Keepable, Snapshot, read, write
from bentod.whole_file import sweep_up

CLOSING = 3.0
"""s that the last snapshot may take before everybody goes on without it."""

_NAMED = 10
"""Questions that are named when there are many."""

_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class Kept:
    """How keeping goes, as of now."""

    path: Path
    written: int  # snapshots since the start
    bytes: int  # of the newest in the file
    problem: str  # why the newest could not be written; empty if it was


class Keeper:
    """A context manager: while it is entered, snapshots that are put are written to `path`.

    Nothing that the loop calls ever waits or raises. Of snapshots that wait for the disk only the newest is
    kept. The one that was written before stays as `path`.1. A disk that fails is told of once for each way
    in which it does, and once when it takes snapshots again; the next one is always tried.
    """

    def __init__(
        self, path: Path, every_s: float, store: Callable[[Path, Snapshot], int] | None = None
    ) -> None:
        """`store`: writes a file and returns its bytes; left out, it is `keep` of this module."""
        self._path = path
        self._every = every_s
        self._store = store or keep
        self._waiting: deque[Snapshot] = deque(maxlen=1)
        self._sentences: deque[str] = deque(maxlen=100)
        self._told: set[str] = set()  # ways in which the disk failed since it last did not
        self._status = Kept(path, 0, 0, "")
        self._last: float | None = None  # monotonic s, when one was asked for
        self._closing = False
        self._wake = threading.Semaphore(0)
        self._thread = threading.Thread(target=self._run, name="snapshots", daemon=True)

    def due(self, now: float) -> bool:
        """Whether to take a snapshot now (monotonic s): `every_s` after the first call, and so on."""
        if self._last is None:
            self._last = now
        if now - self._last < self._every:
            return False
        self._last = now
        return True

    def put(self, snapshot: Snapshot) -> None:
        """Have a snapshot written. Nobody may change its arrays any more."""
        if self._closing:
            return
        self._waiting.append(snapshot)
        self._wake.release()

    def take_events(self) -> list[str]:
        """Sentences since the last call: why nothing can be kept, and that it can be again."""
        return [self._sentences.popleft() for _ in range(len(self._sentences))]

    @property
    def status(self) -> Kept:
        """How it goes."""
        return self._status

    def close(self, last: Snapshot | None = None, patience: float = CLOSING) -> None:
        """Write `last`, or what waits, within `patience` (s): a dead disk keeps nobody."""
        if self._closing:
            return
        if last is not None:
            self.put(last)
        self._closing = True
        self._wake.release()
        self._thread.join(patience)
        if self._thread.is_alive():
            self._sentences.append(
                f"The last snapshot was not written within {patience:g} s; what was learned since the one "
                f"before it is lost. {self._path} is as it was."
            )

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _run(self) -> None:
        sweep_up(self._path)
        while not (self._closing and not self._waiting):
            self._wake.acquire()
            with suppress(IndexError):  # already written together with the one that woke it
                self._write(self._waiting.popleft())

    def _write(self, snapshot: Snapshot) -> None:
        try:
            size = self._store(self._path, snapshot)
        except Exception as error:  # noqa: BLE001 -- a disk can fail in any way; the arm does not care
            self._fail(error)
            return
        if self._told:
            self._told.clear()
            self._sentences.append(f"Snapshots are written to {self._path} again.")
        self._status = Kept(self._path, self._status.written + 1, size, "")

    def _fail(self, error: Exception) -> None:
        told = error.strerror if isinstance(error, OSError) else None
        problem = f"No snapshot can be written to {self._path}: {told or f'{type(error).__name__}: {error}'}."
        kind = f"{type(error).__name__} {getattr(error, 'errno', None) or ''}"
        if kind not in self._told:
            self._told.add(kind)
            self._sentences.append(problem)
        self._status = replace(self._status, problem=problem)


def keep(path: Path, snapshot: Snapshot) -> int:
    """Write a snapshot, and leave the one that stood there as the previous one. Raises as `write` does."""
    return write(path, snapshot, previous(path))


def previous(path: Path) -> Path:
    """Where the snapshot before the newest is."""
    return path.with_name(f"{path.name}.1")


def restore(path: Path) -> Snapshot | None:
    """The newest snapshot that is whole: that in `path`, or else the one before it; None if there is none.

    One that cannot be used is moved aside and logged, so that nothing is ever written over it.
    """
    for place in (path, previous(path)):
        if not os.path.lexists(place):
            continue
        try:
            found = read(place)
        except SnapshotError as error:
            _log.warning("A snapshot cannot be used: %s. %s", error, _aside(place))
        else:
            if place != path:
                _log.warning("What was learned is taken from the snapshot before the newest, %s.", place)
            return found
    return None


def resume(path: Path, learners: Keepable) -> bool:
    """Have `learners` go on from where the snapshot in `path` left off; whether they do.

    What is refused is moved aside. What is not gone on with whole, because some of its questions are asked
    otherwise or not at all, stays there under a second name. The log says what and why.
    """
    snapshot = restore(path)
    if snapshot is None:
        return False
    place = path if path.exists() else previous(path)
    try:
        new = snapshot.give(learners)
    except (SnapshotError, ValueError) as error:
        moved = " ".join(_aside(it) for it in (path, previous(path)) if os.path.lexists(it))
        _log.warning("The snapshot %s cannot be gone on with: %s. %s", place, error, moved)
        return False
    here = by_name(learners.spec().get("questions")) or {}
    there = by_name(snapshot.spec.get("questions")) or {}
    if lost := [name for name in there if name in new or name not in here]:
        told = _aside(place, copy=True)
        _log.warning("Of the snapshot %s this is not gone on with: %s. %s", place, _several(lost), told)
    elif new:
        _log.info("These questions begin anew, for the snapshot does not know them: %s.", _several(new))
    return True


def _several(names: Sequence[str]) -> str:
    more = f" and {len(names) - _NAMED} more" if len(names) > _NAMED else ""
    return ", ".join(names[:_NAMED]) + more


def set_aside(path: Path, copy: bool = False) -> Path:
    """Move a file to the first of `path`.refused-1, -2 … that is free; `copy`: it also stays where it is.

    A copy takes no room of its own until `path` is written anew. Raises OSError: it cannot be done.
    """
    number = 1
    while os.path.lexists(aside := path.with_name(f"{path.name}.refused-{number}")):
        number += 1
    if copy:
        os.link(path, aside)
    else:
        os.rename(path, aside)
    return aside


def _aside(path: Path, copy: bool = False) -> str:
    try:
        return f"It is kept as {set_aside(path, copy).name}."
    except OSError as error:
        return f"It cannot be kept aside: {error.strerror or error}."
