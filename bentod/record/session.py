"""What a session is to those who write and read it: its header, what is counted, and what is missing."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeAlias

from bentod.frames import ClientCommand, EmgBlock, Event, Frame, JointSpec, Trial, Value

SCHEMA = 1
"""Version of what the messages mean. A new field does not change it: old files read with its default."""

SUFFIX = ".mcap"

_LATEST = (1 << 63) - 1
_FAR = 9e9  # s

Entry: TypeAlias = Frame | EmgBlock | Event | ClientCommand
"""What is recorded. Times are monotonic s; `Frame.wall` is the time of the day."""

KINDS: tuple[type[Entry], ...] = (Frame, EmgBlock, Event, ClientCommand)


@dataclass(frozen=True, slots=True)
class Header:
    """What does not change in a session; it stands at the start of each of its parts."""

    session: str  # e.g. "2026-11-22T19-04-05Z-3f2a"; files are named after it
    schema: int  # version of what the messages mean
    started: float  # monotonic s
    started_wall: float  # s since the epoch, at `started`
    arm: str
    rate_hz: float
    joints: tuple[JointSpec, ...]
    config: str  # the config file's text
    config_name: str
    versions: Mapping[str, str]  # of bentod, python, numpy, the system; the commit, if known
    part: int = 1  # from 1; a session is split by size and by time
    urdf: str = ""  # the robot's description, if the config names one
    learned: bytes = b""  # the snapshot that the learners went on with, in the first part
    note: str = ""  # of whoever began it

    def log_time(self, time: float) -> int:
        """`time` (monotonic s, not nan) as ns since the epoch, had nobody set the clock since the start.

        So what was recorded in order stays in order when the clock is set; `Frame.wall` shows that it was.
        Times that no file has room for are the nearest that it has.
        """
        since = min(max(time - self.started, -_FAR), _FAR)
        return min(max(round(self.started_wall * 1e9) + round(since * 1e9), 0), _LATEST)


@dataclass(frozen=True, slots=True)
class Counts:
    """How many entries of each kind."""

    frames: int = 0
    emg: int = 0  # blocks
    events: int = 0
    commands: int = 0

    @property
    def total(self) -> int:
        """Of all kinds."""
        return self.frames + self.emg + self.events + self.commands

    def __add__(self, other: "Counts") -> "Counts":
        return Counts(
            self.frames + other.frames,
            self.emg + other.emg,
            self.events + other.events,
            self.commands + other.commands,
        )


@dataclass(frozen=True, slots=True)
class Gap:
    """A stretch in which ticks or samples are missing."""

    start: float  # monotonic s of what came before it
    end: float  # monotonic s of what came after it
    missing: int  # how many; below 0: the source began to count anew


@dataclass(frozen=True, slots=True)
class Tally:
    """What was counted while a stretch was written or read; -1 and nan where there was nothing."""

    written: Counts = Counts()
    dropped: Counts = Counts()  # by the recorder, because they could not be written
    start: float = float("nan")  # monotonic s of the earliest entry
    end: float = float("nan")  # monotonic s of the latest one
    first_tick: int = -1
    last_tick: int = -1
    first_frame: float = float("nan")  # monotonic s
    last_frame: float = float("nan")  # monotonic s
    first_missed: int = 0  # `Frame.missed` of the first frame
    last_missed: int = 0
    first_index: int = -1  # of the first EMG sample
    next_index: int = -1  # after the last EMG sample
    first_sample: float = float("nan")  # monotonic s
    last_sample: float = float("nan")  # monotonic s of the last block
    samples: int = 0  # EMG samples that are there
    tick_gaps: tuple[Gap, ...] = ()  # the first hundred
    emg_gaps: tuple[Gap, ...] = ()  # the first hundred
    ticks_missing: int = 0
    samples_missing: int = 0


@dataclass(frozen=True, slots=True)
class Report:
    """What the recorder says of itself, in the file: at the end of a part, and when something is amiss."""

    time: float  # monotonic s of the last entry before it
    text: str  # a sentence; empty at the end of a part that ended as it should
    closing: bool  # the part ends here
    tally: Tally  # of this part, so far


@dataclass(frozen=True, slots=True)
class Mark:
    """A tick at which the trial or the metadata changed: a small index of the frames."""

    time: float  # monotonic s
    tick: int
    trial: Trial | None
    meta: Value


@dataclass(frozen=True, slots=True)
class TrialSpan:
    """One trial, from its first frame to the last before it ended; `end` is the last frame if it did not."""

    trial: Trial
    start: float  # monotonic s
    end: float  # monotonic s
    ended: bool


@dataclass(frozen=True, slots=True)
class Info:
    """What there is in a recording and what is missing from it."""

    files: tuple[Path, ...]
    bytes: int
    counts: Counts
    dropped: Counts  # by the recorder
    start: float  # monotonic s of the earliest entry; nan if there is none
    end: float  # monotonic s of the latest
    complete: bool  # every part is there and was closed in order
    live: bool  # it is being recorded
    problems: tuple[str, ...]  # sentences: what ended it early, what is cut off, damaged or absent
    tick_gaps: tuple[Gap, ...]  # the first hundred of each part
    emg_gaps: tuple[Gap, ...]  # the first hundred of each part
    ticks_missing: int  # frames that were made but are not in the recording
    ticks_skipped: int  # ticks that the daemon itself missed or was too late for
    samples: int  # EMG samples that are there
    samples_missing: int
    trials: tuple[TrialSpan, ...] = ()
    metas: tuple[tuple[float, Value], ...] = field(default=())  # monotonic s, and what it was from then on

    @property
    def duration(self) -> float:
        """S from the earliest entry to the latest."""
        return self.end - self.start if self.counts.total else 0.0

    @property
    def whole(self) -> bool:
        """Whether nothing is known to be missing: no tick, no sample, no entry, no part."""
        missing = (self.ticks_missing, self.samples_missing, len(self.tick_gaps), len(self.emg_gaps))
        return self.complete and not any(missing) and not self.dropped.total


@dataclass(frozen=True, slots=True)
class Status:
    """How the recording goes, as of now."""

    file: Path | None  # the part that is being written; None before the first is open
    bytes: int  # written, all parts
    waiting: int  # entries in the queue
    written: Counts
    dropped: Counts
    problem: str  # why nothing is recorded any more; empty while it records
