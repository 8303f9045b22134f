"""What the recorder's thread does: parts, flushes, syncs and the budget of the disk."""

import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

from bentod.errors import BentodError
from bentod.frames import ClientCommand, EmgBlock, Event, Frame
from bentod.record.disk import GB, Budget, Disk, part_name
from bentod.record.part import Course, Part
from bentod.record.session import Counts, Entry, Header

FLUSH = 0.45
"""s after which what was put is handed to the system, where it survives the end of this process."""

SYNC = 2.0
"""s after which the disk is made to take it, where it survives a power cut."""

WARNINGS = (1e9, 1e8)
"""bytes that are left for recordings when it is said that they will end."""

_SOON = 60.0  # s after which the rate of a recording is known from itself
_USUAL = 40e3  # bytes/s until then

KINDS: dict[type[Entry], Counts] = {
    Frame: Counts(frames=1),
    EmgBlock: Counts(emg=1),
    Event: Counts(events=1),
    ClientCommand: Counts(commands=1),
}


_BUDGET = Budget(50e9, 2e9)


@dataclass(frozen=True, slots=True)
class Limits:
    """When a new part begins, what all recordings may use, and what may wait for the disk."""

    part_bytes: float = 1e9
    part_seconds: float = 3600.0
    budget: Budget = _BUDGET
    waiting: int = 8192  # entries: more than a minute of everything
    waiting_bytes: float = 64e6  # roughly


class RecordingEnded(BentodError):
    """The recording ends in order, before the session does.

    Examples: the recordings have used all that they may, the disk is nearly full.
    """


class Scribe:
    """Owns the files. Methods raise what the disk raises; `fail` is told and cleans up.

    The fields are for the loop to read at any time.
    """

    def __init__(
        self, header: Header, disk: Disk, limits: Limits, now: Callable[[], float] = time.monotonic
    ) -> None:
        self.path: Path | None = None
        self.size = 0
        self.written = Counts()
        self.dropped = Counts()  # entries that did not fit the schema, or came to nothing when it ended
        self.problem = ""
        self.sentences: deque[str] = deque()
        self._header = header
        self._disk = disk
        self._limits = limits
        self._now = now
        self._course = Course()
        self._part: Part | None = None
        self._before = (0, Counts())  # bytes and entries of earlier parts
        self._used = 0  # bytes of all other recordings
        self._opened = self._begun = self._flushed = self._synced = now()
        self._warnings = list(WARNINGS)
        self._unfit = ""

    def open(self) -> None:
        """Begin the first part."""
        self._begun = self._now()
        self._open()

    def put(self, entry: Entry) -> None:
        """Write an entry to the open chunk; one that cannot be written is counted."""
        part = self._writing()
        if not part.waiting:
            self._flushed = self._now()
        try:
            part.put(entry)
        except Exception as error:  # noqa: BLE001 -- an odd entry must not end the recording of all others
            self._refuse(part, entry, error)
        if part.full:
            self._flush(part)

    def lose(self, counts: Counts) -> None:
        """Note entries that were dropped on their way here."""
        told = f"{describe(counts)} dropped here: the disk was too slow."
        self._writing().drop(counts, told)
        self.sentences.append(f"The recording lost {describe(counts)} because the disk was too slow.")

    def tend(self) -> None:
        """Do what has become due: flush, sync, look at the room that is left, begin a new part."""
        part, now = self._writing(), self._now()
        if part.waiting and now - self._flushed >= FLUSH:
            self._flush(part)
        if now - self._synced >= SYNC:
            self._sync(part, now)
        limits = self._limits
        if part.data >= limits.part_bytes or (part.data and now - self._opened >= limits.part_seconds):
            self._rotate(part)

    def flush(self) -> None:
        """Hand over what was put, whatever is due."""
        part = self._writing()
        if part.waiting:
            self._flush(part)
        self.tend()

    def finish(self) -> None:
        """End the file in order."""
        part = self._writing()
        part.finish()
        self._account(part)

    def fail(self, error: Exception) -> None:
        """Nothing more is recorded: say why, and leave the file as whole as it can be."""
        part, self._part = self._part, None
        problem = _sentence(error, self.path)
        try:
            if part and isinstance(error, RecordingEnded):
                part.finish(problem)
            elif part:
                part.abandon()
        except Exception as second:  # noqa: BLE001 -- it is over either way
            problem += f" Its end could not be written either: {second}."
        if part:
            self._account(part)
        self.problem = problem
        self.sentences.append(problem)

    def _writing(self) -> Part:
        if self._part is None:
            raise RecordingEnded("The recording has ended.")
        return self._part

    def _open(self) -> None:
        header = self._header
        name = part_name(header.session, header.part)
        self.path = path = self._disk.path(name)
        self._used = self._disk.used()
        self._check_room(0)
        sink = self._disk.create(name)
        try:
            self._part = Part(sink, path, header, self._course)
        except OSError:
            sink.close()
            raise
        self._part.sync()
        self._opened = self._synced = self._now()

    def _rotate(self, part: Part) -> None:
        part.finish()
        self._account(part)
        self._before = (self.size, self.written)
        self._part = None
        self._header = replace(self._header, part=self._header.part + 1)
        self._open()

    def _flush(self, part: Part) -> None:
        part.flush()
        self._account(part)

    def _sync(self, part: Part, now: float) -> None:
        part.sync()
        self._synced = now
        self._check_room(part.size)

    def _account(self, part: Part) -> None:
        size, written = self._before
        self.size = size + part.size
        self.written = written + part.counter.written

    def _check_room(self, size: int) -> None:
        """Warn when room gets scarce, and end the recording while there is room to end it well.

        Raises:
            RecordingEnded: there is none left.
        """
        budget = self._limits.budget
        ours, free = budget.folder - self._used - size, self._disk.free() - budget.free
        left = min(ours, free)
        why = (
            f"recordings may use {budget.folder / GB:g} GB"
            if ours < free
            else f"{budget.free / GB:g} GB of the disk stay free"
        )
        if left <= 0:
            raise RecordingEnded(f"The recording ended: {why}, and nothing is left of that.")
        if self._warnings and left < self._warnings[0]:
            self._warnings = [bound for bound in self._warnings if bound <= left]
            minutes = left / self._rate() / 60
            self.sentences.append(
                f"The recording will end in about {minutes:.0f} min: {why}, and "
                f"{left / GB:.2g} GB are left for it."
            )

    def _rate(self) -> float:
        """Bytes a second."""
        seconds = self._now() - self._begun
        return max(self.size / seconds, 1.0) if seconds > _SOON else _USUAL

    def _refuse(self, part: Part, entry: Entry, error: Exception) -> None:
        counts = KINDS.get(type(entry), Counts(events=1))
        self.dropped += counts
        text = f"{describe(counts)} dropped here: {type(error).__name__}: {error}"
        part.drop(counts, text)
        if str(error) != self._unfit:
            self.sentences.append(f"The recording has no form for an entry and left it out: {error}.")
        self._unfit = str(error)


def describe(counts: Counts) -> str:
    """Counts in words, without those that are 0."""
    named = {
        "frame": counts.frames,
        "EMG block": counts.emg,
        "event": counts.events,
        "command": counts.commands,
    }
    return ", ".join(f"{n} {name}{'s' * (n != 1)}" for name, n in named.items() if n) or "nothing"


def _sentence(error: Exception, path: Path | None) -> str:
    if isinstance(error, RecordingEnded):
        return str(error)
    why = (
        f"{path} cannot be written: {error.strerror or error}"
        if isinstance(error, OSError)
        else f"an error of its own: {type(error).__name__}: {error}"
    )
    return f"The recording ended: {why}. The arm is not affected."
