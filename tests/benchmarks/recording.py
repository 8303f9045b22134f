"""What recording costs, what it adds to a tick, and what is lost when the process or the power goes.

Seven joints at 30 Hz from the simulated arm, eight channels of Gaussian noise at 1 kHz.
"""

import asyncio
import dataclasses
import json
import statistics
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from unittest import mock

import zstandard

from bentod.clock import SystemClock
from bentod.frames import EmgBlock, Frame
from bentod.lateness.histogram import percentile
from bentod.record.codec import ENCODERS
from bentod.record.disk import Folder
from bentod.record.reader import Recording
from bentod.record.recorder import Recorder
from bentod.record.recover import recover
from bentod.record.scribe import FLUSH, SYNC, Limits, Scribe
from bentod.record.session import SCHEMA, Header
from tests.benchmarks import recording_analysis, replaying
from tests.benchmarks.harness import Row, at_least, at_most, main
from tests.benchmarks.rigs.arm_frames import arm_frames, endless, specs
from tests.benchmarks.rigs.recorded import kills
from tests.benchmarks.rigs.sessions import RATE, Session
from tests.record.rig import FIRST, FakeDisk

KILLS = 50
SECONDS = 10.0  # of each round in real time
ROUNDS = 3
HOUR = 3600
SAMPLE = 300  # s, for sizes


def rows() -> Iterator[Row]:
    """About eight minutes."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        yield from sizes()
        yield from costs(folder)
        yield from killed(folder)
        yield from power_cut(folder)
        yield from an_hour(folder)
    yield from replaying.rows()
    yield from recording_analysis.rows()


def header(session: str, started: float) -> Header:
    """Of a session of the benchmark."""
    return Header(session, SCHEMA, started, 1.7e9, "Bento Arm", RATE, specs(), "", "", {})


def sizes() -> Iterator[Row]:
    """Bytes of a frame: as JSON, as JSON in the same compression, and as recorded."""
    frames = arm_frames()
    texts = [json.dumps(dataclasses.asdict(frame)).encode() for frame in frames]
    binary = [ENCODERS[Frame](frame) for frame in frames]
    plain, packed, ours = statistics.fmean(map(len, texts)), _packed(texts), _packed(binary)
    yield Row("a frame as JSON", plain, "bytes")
    yield Row("a frame as JSON, zstd", packed, "bytes")
    yield Row("a frame as protobuf", statistics.fmean(map(len, binary)), "bytes")
    yield Row("a frame as protobuf, zstd", ours, "bytes")
    yield at_most("state, share of JSON", ours / plain, "", 0.2)
    yield Row("state, share of JSON in zstd", ours / packed, "")


def _packed(records: list[bytes]) -> float:
    """Bytes a record when chunks are compressed as they are in a file."""
    chunk = round(FLUSH * RATE)
    compress = zstandard.ZstdCompressor(level=3).compress
    chunks = [b"".join(records[at : at + chunk]) for at in range(0, len(records), chunk)]
    return sum(len(compress(data)) for data in chunks) / len(records)


def costs(folder: Path) -> Iterator[Row]:
    """CPU, and lateness of the tick, with and without a recording, in turns."""
    found: dict[bool, list[Ticking]] = {True: [], False: []}
    pieces: list[float] = []
    for number in range(2 * ROUNDS):
        recording = number % 2 == 0
        with ExitStack() as stack:
            put: Callable[[EmgBlock | Frame], None] = _nothing
            if recording:
                stack.enter_context(mock.patch.object(Scribe, "put", _timed(Scribe.put, pieces)))
                made = header(f"cost{number}", time.monotonic())
                put = stack.enter_context(Recorder(made, Folder(folder))).put
            found[recording].append(asyncio.run(_ticking(put)))
    thread = statistics.median(run.thread for run in found[True])
    putting = percentile([seconds for run in found[True] for seconds in run.putting], 0.5)
    yield at_most("a recording", (thread + putting * RATE) * 100, "% of a core", 1)
    yield Row("of it in the loop", putting * RATE * 100, "% of a core")
    for share, name in ((0.5, "median"), (0.99, "99 %"), (1.0, "worst")):
        without, beside = (
            percentile([late for run in found[with_it] for late in run.lateness], share) * 1e3
            for with_it in (False, True)
        )
        yield Row(f"a tick is late, {name}, without", without, "ms")
        yield Row(f"a tick is late, {name}, with", beside, "ms")
    yield Row("the thread in Python at a stretch, median", percentile(pieces, 0.5) * 1e3, "ms of CPU")
    yield at_most("the thread in Python at a stretch, 99 %", percentile(pieces, 0.99) * 1e3, "ms of CPU", 0.2)


@dataclass(frozen=True, slots=True)
class Ticking:
    """What was measured while ticks went by."""

    lateness: list[float]  # s, of each tick
    putting: list[float]  # s, of each tick: a frame and a block
    thread: float  # share of a core that the recorder's thread took


def _nothing(entry: EmgBlock | Frame) -> None:
    """Not recorded."""


def _timed(original: Callable[..., None], pieces: list[float]) -> Callable[..., None]:
    """Nobody else runs Python between two entries: what one takes is what it can delay a tick by."""

    def put(scribe: Scribe, entry: EmgBlock | Frame) -> None:
        before = time.thread_time()
        original(scribe, entry)
        pieces.append(time.thread_time() - before)

    return put


async def _ticking(put: Callable[[EmgBlock | Frame], None]) -> Ticking:
    """Ticks in real time, with what a session of that time puts."""
    clock = SystemClock()
    noise = Session(0.0)
    ticks = [(noise.emg(i), frame) for i, frame in enumerate(islice(endless(0.0), round(SECONDS * RATE)))]
    start = clock.now() + 0.1
    lateness, putting = [], []
    before = _thread_cpu()
    for block, frame in ticks:
        await clock.sleep_until(start + frame.time)
        begun = clock.now()
        put(block)
        put(frame)
        putting.append(clock.now() - begun)
        lateness.append(begun - start - frame.time)
    thread = (_thread_cpu() - before) / SECONDS
    clock.close()
    return Ticking(lateness, putting, thread)


def _thread_cpu() -> float:
    """CPU (s) of the recorder's thread, if there is one."""
    threads = [thread for thread in threading.enumerate() if thread.name == "recorder" and thread.ident]
    return sum(time.clock_gettime(time.pthread_getcpuclockid(thread.ident or 0)) for thread in threads)


def killed(folder: Path) -> Iterator[Row]:
    """Real processes, SIGKILL at random instants."""
    found = list(kills(folder, KILLS, seed=1))
    yield at_least(
        "kill -9: what was put first is there, bit by bit", sum(k.prefix for k in found), "times", KILLS
    )
    yield Row("kill -9: lost, median", percentile([kill.lost for kill in found], 0.5), "s")
    yield at_most("kill -9: lost, most", max(kill.lost for kill in found), "s", 1.0)


def power_cut(folder: Path) -> Iterator[Row]:
    """Everything that was not synced is gone, at each tick of a minute."""
    disk, now, worst = FakeDisk(), 0.0, 0.0
    scribe = Scribe(header("cut", 0.0), disk, Limits(), lambda: now)
    scribe.open()
    synced = safe = 0
    for number, frame in enumerate(islice(endless(0.0), round(20 * RATE)), 1):
        now = frame.time
        scribe.put(frame)
        scribe.tend()
        sink = next(iter(disk.files.values()))
        if sink.synced != synced:
            synced = sink.synced
            safe = _frames_in(folder / FIRST, bytes(sink.data[:synced]))
        worst = max(worst, (number - safe) / RATE)
    yield at_most("power cut, modelled: lost, most", worst, "s", SYNC + FLUSH + 2 / RATE)


def _frames_in(path: Path, data: bytes) -> int:
    path.write_bytes(data)
    with Recording(path, alone=True) as recording:
        return sum(1 for _ in recording.frames())


def an_hour(folder: Path) -> Iterator[Row]:
    """The size of an hour, and how long it takes to look into it, whole and cut off."""
    for scales in (0, 1, 2):
        _record(folder / f"scales{scales}", scales, SAMPLE)
        size = next((folder / f"scales{scales}").iterdir()).stat().st_size * HOUR / SAMPLE
        yield at_most(f"an hour, {scales * len(specs())} predictions a tick", size / 1e6, "MB", 140)
    _record(folder / "hour", 1, HOUR)
    path = next((folder / "hour").iterdir())
    yield at_most("info of it", _info_time(path), "s", 1.0)
    with path.open("r+b") as file:
        file.truncate(path.stat().st_size - 1000)
    yield Row("info of it when it was cut off", _info_time(path), "s")
    start = time.perf_counter()
    recover(path)
    yield Row("mending it", time.perf_counter() - start, "s")
    start = time.perf_counter()
    with Recording(path) as recording:
        count = sum(1 for _ in recording.frames())
    yield Row("reading all its frames", count / (time.perf_counter() - start) / RATE, "times real time")


def _record(place: Path, scales: int, seconds: int) -> None:
    noise = Session(0.0)
    blocks = [noise.emg(number) for number in range(900)]
    with Recorder(header("hour", 0.0), Folder(place)) as recorder:
        for tick, frame in enumerate(islice(endless(0.0, scales), round(seconds * RATE))):
            again = blocks[tick % len(blocks)]
            first = tick // len(blocks) * 30_000 + again.first_index
            recorder.put(dataclasses.replace(again, first_index=first, time=first / 1000))
            recorder.put(frame)
            while recorder.status.waiting > 1000:
                time.sleep(0.001)


def _info_time(path: Path) -> float:
    start = time.perf_counter()
    with Recording(path) as recording:
        assert recording.info.counts.frames > HOUR * RATE - 60
        assert not recording.info.ticks_missing
        assert not recording.info.samples_missing
    return time.perf_counter() - start


if __name__ == "__main__":
    main("recording", rows())
