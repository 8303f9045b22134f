"""Headers, entries and disks for recordings: in memory, failing, slow, or losing what was not synced."""

import errno
import os
import threading
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from bentod.frames import ClientCommand, EmgBlock, Event, Frame, JointSpec
from bentod.record.container import Sink
from bentod.record.disk import Folder
from bentod.record.reader import Recording
from bentod.record.recorder import Recorder
from bentod.record.scribe import Limits
from bentod.record.session import SCHEMA, Entry, Header
from tests.benchmarks.rigs.sessions import SPECS, Session

HEADER = Header(
    session="2026-11-22T19-04-05Z-3f2a",
    schema=SCHEMA,
    started=100.0,
    started_wall=1.7e9,
    arm="Bento Arm",
    rate_hz=30.0,
    joints=(*SPECS, JointSpec("spare", -1.0, 1.0, 0.5, 0.25, {"id": 9, "gain": [1, None, "x"]})),
    config='arm = "Bento Arm"  # Ωmega\n',
    config_name="bento.toml",
    versions={"bentod": "0.1.0", "python": "3.11", "commit": "1a2b3c, dirty"},
    urdf="<robot/>",
)

FIRST = "2026-11-22T19-04-05Z-3f2a.001.mcap"


def session(seconds: float = 2.0, started: float = 100.0, seed: int = 1) -> list[Entry]:
    """A frame and an EMG block each tick, an event and a command each second."""
    made = Session(started, 1.7e9, seed)
    found: list[Entry] = []
    for tick in range(round(seconds * 30)):
        frame = made.frame(tick)
        found += [made.emg(tick), frame]
        if tick % 30 == 15:
            found.append(Event(frame.time, "goal", f"goal {tick}", {"id": tick, "at": [0.5, None]}))
            found.append(ClientCommand(frame.time, tick, "notebook", "move", {"joint": "hand"}, ""))
    return found


def record(
    folder: Path, entries: Iterable[Entry], limits: Limits | None = None, header: Header = HEADER
) -> Path:
    """A session in `folder`; returns its first file."""
    with Recorder(header, Folder(folder), limits) as recorder:
        for entry in entries:
            recorder.put(entry)
    assert not recorder.status.problem, recorder.status.problem
    return folder / f"{header.session}.001.mcap"


def until(condition: Callable[[], bool]) -> None:
    """Return once the recorder's thread has brought `condition` about."""
    while not condition():
        os.sched_yield()


def read(path: Path) -> list[Entry]:
    """Everything that is in a recording."""
    with Recording(path) as recording:
        return list(recording.entries())


def with_frames(entries: Sequence[Entry], **changes: object) -> list[Entry]:
    """The same with every frame changed."""
    return [replace(e, **changes) if isinstance(e, Frame) else e for e in entries]  # type: ignore[arg-type]


def small_block(index: int, samples: int = 10, time: float = 100.0) -> EmgBlock:
    """Silence."""
    return EmgBlock(index, time, np.zeros((samples, 2), np.float32))


@dataclass
class FakeSink:
    """A file in memory that knows how much of it the disk has."""

    disk: "FakeDisk"
    data: bytearray = field(default_factory=bytearray)
    synced: int = 0
    closed: bool = False

    def write(self, data: bytes) -> None:
        self.disk.pass_gate("write")
        self.data += data

    def sync(self) -> None:
        self.disk.pass_gate("sync")
        self.synced = len(self.data)

    def close(self) -> None:
        self.closed = True


class FakeDisk:
    """A disk in memory. It fails as told, and its gate can be shut: calls then wait until it is opened."""

    def __init__(self) -> None:
        self.files: dict[str, FakeSink] = {}
        self.failures: dict[str, tuple[int, int]] = {}  # call: errno, how many calls go well before
        self.calls = {"open": 0, "write": 0, "sync": 0}
        self.gate = threading.Event()
        self.gate.set()
        self.at_gate = threading.Event()
        self.room = 1e12
        self.others = 0

    def create(self, name: str) -> Sink:
        self.pass_gate("open")
        self.files[name] = FakeSink(self)
        return self.files[name]

    def path(self, name: str) -> Path:
        return Path("disk") / name

    def used(self) -> int:
        return self.others

    def free(self) -> int:
        return round(self.room - sum(len(file.data) for file in self.files.values()))

    def fail(self, call: str, number: int, after: int = 0) -> None:
        """Have `call` fail with an errno, after some that do not."""
        self.failures[call] = (number, self.calls[call] + after)

    def pass_gate(self, call: str) -> None:
        self.calls[call] += 1
        if not self.gate.is_set():
            self.at_gate.set()
            self.gate.wait()
        number, after = self.failures.get(call, (0, 0))
        if number and self.calls[call] > after:
            raise OSError(number, errno.errorcode[number])
