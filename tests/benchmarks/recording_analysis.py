"""How long it takes to look into an hour of seven joints at 30 Hz and eight channels of EMG at 1 kHz."""

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from bentod.frames import Event, Frame, Trial
from bentod.record.disk import Folder
from bentod.record.recorder import Recorder
from bentod.record.session import Header
from tests.benchmarks.harness import Row, at_most, main
from tests.benchmarks.rigs.sessions import BLOCKS, CHANNELS, EMG_RATE, RATE, SPECS, Session

SECONDS = 3600
TRIAL_S = 30.0
TOGGLE_S = 3
WAITING = 4000
"""Entries that may wait for the disk, well below what the recorder holds."""

CONFIG = f"""
[emg]
rate_hz = {EMG_RATE}
{"".join(f'[[emg.sites]]{chr(10)}name = "s{n}"{chr(10)}channel = {n}{chr(10)}' for n in range(CHANNELS))}
[learn]
joints = ["{SPECS[0].name}", "{SPECS[1].name}"]
"""


def rows() -> Iterator[Row]:
    """About three minutes, most of it for making the hour."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        file = record_hour(folder)
        yield Row("an hour's file", file.stat().st_size / 1e6, "MB")
        seconds, _ = _run(folder, "info", str(file))
        seconds = min(seconds, _run(folder, "info", str(file))[0])  # the second finds its code in memory
        yield at_most("info of an hour, the command", seconds, "s", 1)
        seconds, megabytes = _run(folder, "export", str(file), "--format", "parquet", "-o", "out")
        yield at_most("export of an hour, parquet", seconds, "s", 30)
        yield at_most("export of an hour, memory", megabytes, "MB", 1000)
        seconds, megabytes = _run(folder, "report", str(file), "-o", "report.html")
        yield Row("report of an hour", seconds, "s")
        yield at_most("report of an hour, memory", megabytes, "MB", 1000)


def record_hour(folder: Path, seconds: int = SECONDS) -> Path:
    """A recording of so many seconds by the real recorder, as fast as it takes it."""
    session = Session()
    header = Header(
        "2026-11-22T19-04-05Z-0001", 1, 0.0, 1.7e9, "Bento Arm", RATE, SPECS, CONFIG, "bench.toml", {}
    )
    with Recorder(header, Folder(folder)) as recorder:
        for tick in range(seconds * int(RATE)):
            recorder.put(_in_trial(session.frame(tick)))
            recorder.put(session.emg(tick * BLOCKS // int(RATE)))
            if tick % (TOGGLE_S * int(RATE)) == 0:
                active = SPECS[tick // 90 % 4].name
                data = {"group": "arm", "active": active}
                recorder.put(Event(tick / RATE, "group", f"the wearer switched arm to {active}", {**data}))
            while recorder.status.waiting > WAITING:
                time.sleep(0.001)
    if recorder.status.dropped.total:
        raise RuntimeError(f"the recorder dropped {recorder.status.dropped.total} entries")
    return min(folder.iterdir())


def _in_trial(frame: Frame) -> Frame:
    number, since = divmod(frame.time, TRIAL_S)
    if since >= TRIAL_S - 5:
        return frame
    trial = Trial(int(number) + 1, "maze", "dpcc" if number % 2 else "toggling", number * TRIAL_S)
    return replace(frame, trial=trial)


def _run(folder: Path, *arguments: str) -> tuple[float, float]:
    """What `bentod recording` takes as a process of its own: s, and MB at its greatest."""
    command = [sys.executable, "-m", "bentod", "recording", *arguments]
    here = str(Path(__file__).parents[2])
    begun = time.perf_counter()
    process = subprocess.Popen(
        command, cwd=folder, env={**os.environ, "PYTHONPATH": here}, stdout=subprocess.DEVNULL
    )
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise RuntimeError(f"{' '.join(command)} ended with {process.returncode}")
    return time.perf_counter() - begun, usage.ru_maxrss / 1e3


if __name__ == "__main__":
    main("recording_analysis", rows())
