"""Records a session from a thread of its own. Nothing that a disk does reaches who records."""

import math
import threading
import time
from collections import deque
from collections.abc import Mapping
from types import TracebackType
from typing import Self

from bentod.frames import ClientCommand, EmgBlock, Frame, Value
from bentod.record.disk import Disk
from bentod.record.scribe import KINDS, Limits, Scribe
from bentod.record.session import Counts, Entry, Header, Status

CLOSING = 3.0
"""s that the end of a recording may take before everybody goes on without it."""

PAUSE = 50e-6
"""s between two entries in which the thread lets others run Python, if they want to."""

BATCH = 0.4
"""s of frames after which the thread is woken. Many entries at once take half the time of one by one."""

PATIENCE = 0.45
"""s that the thread sleeps at most, when there are no frames."""

_FRAME = 8000  # bytes, more or less
_OTHER = 500
_DEEPEST = 16


class Recorder:
    """A context manager: what is put while it is entered is recorded.

    Nothing that the loop calls ever waits or raises. What the disk cannot take in time is dropped, counted,
    told by `take_events`, and noted in the file where it is missing. A disk that fails or is full ends the
    recording: `status.problem` says why, and nothing else happens.

    Entries are kept as they are until the thread gets to them, so nobody may change one that was put.
    One thread puts.
    """

    def __init__(self, header: Header, disk: Disk, limits: Limits | None = None) -> None:
        self._queue: deque[tuple[Entry, float] | Counts] = deque()
        self._limits = limits or Limits()
        self._scribe = Scribe(header, disk, self._limits)
        self._thread = threading.Thread(target=self._run, name="recorder", daemon=True)
        self._wake = threading.Lock()
        self._wake.acquire()
        self._opened = threading.Event()
        self._closing = False
        self._given = 0.0  # bytes; written by the loop only
        self._taken = 0.0  # bytes; written by the thread only
        self._losing = Counts()  # since the last entry that fitted
        self._lost = Counts()
        self._left = Counts()  # in the queue when the recording ended
        self._stuck = ""
        self._roused = -math.inf  # monotonic s of the frame that last woke the thread

    def put(self, entry: Entry) -> None:
        """Record an entry, or count that it could not be."""
        try:
            weight = _weight(entry)
            if self._closing or self._scribe.problem:
                self._lost += _count(entry)
            elif self._is_full(weight):
                self._lose(entry)
            else:
                self._append(entry, weight)
        except Exception:  # noqa: BLE001 -- whatever is wrong with an entry, the arm goes on
            self._lost += _count(entry)

    def take_events(self) -> list[str]:
        """Sentences since the last call: the disk is nearly full, entries were dropped, why it ended."""
        waiting = self._scribe.sentences
        return [waiting.popleft() for _ in range(len(waiting))]

    @property
    def status(self) -> Status:
        """How it goes, as of now."""
        scribe = self._scribe
        return Status(
            file=scribe.path,
            bytes=scribe.size,
            waiting=len(self._queue),
            written=scribe.written,
            dropped=self._lost + self._left + scribe.dropped,
            problem=self.problem,
        )

    @property
    def problem(self) -> str:
        """Why nothing is recorded any more; empty while it records."""
        return self._stuck or self._scribe.problem

    def wait_until_open(self, patience: float) -> bool:
        """Wait up to `patience` (s) for the first file, or for a `problem`; whether either has come."""
        return self._opened.wait(patience)

    def close(self, patience: float = CLOSING) -> None:
        """Write what was put and end the file, within `patience` (s): a dead disk keeps nobody."""
        if self._closing:
            return
        self._mark_losses()
        self._closing = True
        self._rouse()
        self._thread.join(patience)
        if self._thread.is_alive():
            self._stuck = (
                f"The recording was not ended: within {patience:g} s the disk did not take what was left. "
                "The last part is cut off; `bentod recording recover` mends it."
            )
            self._scribe.sentences.append(self._stuck)
        elif self._scribe.problem:
            self._discard()

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _is_full(self, weight: float) -> bool:
        limits = self._limits
        return len(self._queue) >= limits.waiting or self._given - self._taken + weight > limits.waiting_bytes

    def _append(self, entry: Entry, weight: float) -> None:
        self._mark_losses()
        self._given += weight
        self._queue.append((entry, weight))
        if isinstance(entry, Frame) and not 0 <= entry.time - self._roused < BATCH:
            self._roused = entry.time
            self._rouse()  # now, because the loop has most time to spare right after a tick

    def _rouse(self) -> None:
        if self._wake.locked():
            self._wake.release()

    def _lose(self, entry: Entry) -> None:
        if not self._losing.total:
            self._scribe.sentences.append(
                f"The disk is too slow for the recording: {len(self._queue)} entries wait, "
                "and what comes now is dropped."
            )
        self._losing += _count(entry)
        self._lost += _count(entry)

    def _mark_losses(self) -> None:
        """Have the thread note losses at the place where they are."""
        if self._losing.total:
            self._queue.append(self._losing)
            self._losing = Counts()

    def _run(self) -> None:
        scribe = self._scribe
        try:
            scribe.open()
            self._opened.set()
            closing = False
            while not closing:
                self._wake.acquire(timeout=PATIENCE)
                closing = self._closing  # read before the queue: what was put until then is written
                self._drain(pause=not closing)
                scribe.flush()
            scribe.finish()
        except Exception as error:  # noqa: BLE001 -- a disk can fail in any way; the arm does not care
            scribe.fail(error)
            self._opened.set()
            self._discard()

    def _drain(self, pause: bool) -> None:
        queue, scribe = self._queue, self._scribe
        while queue:
            item = queue.popleft()
            if isinstance(item, Counts):
                scribe.lose(item)
                continue
            entry, weight = item
            scribe.put(entry)
            self._taken += weight
            scribe.tend()
            if pause and queue:
                time.sleep(PAUSE)

    def _discard(self) -> None:
        while self._queue:
            item = self._queue.popleft()
            if not isinstance(item, Counts):
                self._left += _count(item[0])


def _count(entry: Entry) -> Counts:
    return KINDS.get(type(entry), Counts(events=1))


def _weight(entry: Entry) -> float:
    """Bytes that an entry holds on to, roughly."""
    if isinstance(entry, Frame):
        return _FRAME
    if isinstance(entry, EmgBlock):
        return _OTHER + entry.samples.nbytes
    if isinstance(entry, ClientCommand):
        return _OTHER + _size(entry.params, 0)
    return _OTHER + len(entry.text) + sum(_size(value, 0) for value in entry.data.values())


def _size(value: Value, depth: int) -> int:
    if isinstance(value, str | bytes):
        return len(value) + 50
    if isinstance(value, Mapping) and depth < _DEEPEST:
        return sum(_size(item, depth + 1) + len(str(key)) for key, item in value.items()) + 50
    if isinstance(value, list) and depth < _DEEPEST:
        return sum(_size(item, depth + 1) for item in value) + 50
    return 50
