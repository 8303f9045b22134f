"""Processes that record in real time until they are killed, and what is found of their recordings.

Run as a module it is such a process: `python -m tests.benchmarks.rigs.recorded FOLDER SPEED [BYTES]`.
"""

import mmap
import resource
import struct
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from random import Random

from bentod.frames import EmgBlock, Frame
from bentod.record.disk import Folder
from bentod.record.reader import Recording
from bentod.record.recorder import Recorder
from bentod.record.recover import recover
from bentod.record.session import SCHEMA, Entry, Header
from tests.benchmarks.rigs.sessions import RATE, SPECS, Session

PROGRESS = "progress"
"""File that says how many ticks were put; it outlives the process."""

ROOT = Path(__file__).parents[3]


@dataclass(frozen=True, slots=True)
class Kill:
    """What was left of one process."""

    after: float  # s it had recorded
    lost: float  # s of what was put, from the end
    entries: int  # recovered
    prefix: bool  # they are bit by bit what was put first, before mending and after


def header(session: str = "session", started: float = 100.0) -> Header:
    """Of a session of these processes."""
    return Header(session, SCHEMA, started, 1.7e9, "Bento Arm", RATE, SPECS, "", "", {"bentod": "0"})


def entries(made: Session, tick: int) -> tuple[EmgBlock, Frame]:
    """What is put in one tick."""
    return made.emg(tick), made.frame(tick)


def kills(folder: Path, number: int, seed: int, longest: float = 3.0) -> Iterator[Kill]:
    """So many processes, each killed with SIGKILL after a random time of recording."""
    random = Random(seed)
    for index in range(number):
        place = folder / f"kill{index}"
        place.mkdir()
        yield _kill(place, random.uniform(0.6, longest))


def _kill(folder: Path, after: float) -> Kill:
    with subprocess.Popen([sys.executable, "-m", __name__, str(folder), "1"], cwd=ROOT) as process:
        while _ticks(folder) < after * RATE:
            time.sleep(0.002)
        process.kill()
        process.wait()
    put = _ticks(folder)
    path = next(folder.glob("*.mcap"))
    before = _read(path)
    recover(path)
    found = _read(path)
    made = Session(100.0)
    expected = [entry for tick in range(put + 1) for entry in entries(made, tick)]
    same = all(_same(*pair) for kept in (before, found) for pair in zip(kept, expected, strict=False))
    frames = sum(isinstance(entry, Frame) for entry in found)
    return Kill(put / RATE, max(put - frames, 0) / RATE, len(found), same and len(before) == len(found))


def _read(path: Path) -> list[Entry]:
    with Recording(path) as recording:
        return list(recording.entries())


def _same(one: Entry, two: Entry) -> bool:
    if isinstance(one, EmgBlock) and isinstance(two, EmgBlock):
        same = (one.first_index, one.time, one.dropped) == (two.first_index, two.time, two.dropped)
        return same and one.samples.tobytes() == two.samples.tobytes()
    return one == two


def _ticks(folder: Path) -> int:
    file = folder / PROGRESS
    data = file.read_bytes() if file.exists() else b""
    return int(struct.unpack("<q", data)[0]) if len(data) == 8 else 0


def limited(folder: Path, size: int) -> subprocess.CompletedProcess[str]:
    """A process whose files may not grow beyond `size` bytes, until its recording has ended."""
    command = [sys.executable, "-m", __name__, str(folder), "20", str(size)]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False, timeout=50)


def _progress(folder: Path) -> mmap.mmap:
    file = folder / PROGRESS
    file.write_bytes(bytes(8))
    with file.open("r+b") as opened:
        return mmap.mmap(opened.fileno(), 8)


def _live(folder: Path, speed: float) -> None:
    """Record until killed, or until the recording ends by itself; says why."""
    progress = _progress(folder)
    with Recorder(header(), Folder(folder)) as recorder:
        made, start = Session(100.0), time.monotonic()
        for tick in count():
            for entry in entries(made, tick):
                recorder.put(entry)
            progress[:] = struct.pack("<q", tick + 1)
            time.sleep(max(0.0, start + (tick + 1) / RATE / speed - time.monotonic()))
            if recorder.status.problem:
                break
    sys.stdout.write(recorder.status.problem)


if __name__ == "__main__":
    if len(sys.argv) > 3:
        resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[3]), int(sys.argv[3])))
    _live(Path(sys.argv[1]), float(sys.argv[2]))
