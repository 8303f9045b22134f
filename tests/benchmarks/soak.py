"""Whether a daemon grows: clients that come, go and misbehave, faults that come and go, and what is left.

A real daemon with the simulated arm, bytes and wearer included. Every few seconds the guests pause and leave,
and its memory, file descriptors and tasks are looked at. MINUTES: of all that.
"""

import asyncio
import json
import math
import os
import statistics
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Thread

from bentod.blocking import BlockingClient
from bentod.client import Client
from tests.benchmarks.harness import Row, at_least, at_most, main
from tests.benchmarks.rigs.churn import churn, restore
from tests.rig import CONFIGS, number, table
from tests.system.processes import eventually

MINUTES = float(os.environ.get("MINUTES", "10"))
BUSY, QUIET = 6.0, 2.0
"""s with guests, and without before the daemon is looked at: longer than it keeps one who has left."""


@dataclass(frozen=True, slots=True)
class Look:
    """The daemon at one moment, with nobody connected."""

    time: float  # s
    resident: float  # MB
    descriptors: int
    threads: int
    tasks: int


class Soaked:
    """A daemon process that tells how many tasks it has."""

    def __init__(self, process: "subprocess.Popen[str]") -> None:
        self.process = process
        self.tasks = 0
        self._folder = Path("/proc", str(process.pid))
        self._listener = Thread(target=self._listen, daemon=True)
        self._listener.start()

    def look(self) -> Look:
        """Now."""
        pages = int((self._folder / "statm").read_text().split()[1])
        resident = pages * os.sysconf("SC_PAGE_SIZE") / 1e6
        descriptors, threads = (len(list((self._folder / what).iterdir())) for what in ("fd", "task"))
        return Look(time.monotonic(), resident, descriptors, threads, self.tasks)

    def _listen(self) -> None:
        assert self.process.stdout
        for line in self.process.stdout:
            self.tasks = json.loads(line)["tasks"]


@contextmanager
def soaked(folder: Path) -> Iterator[tuple[Soaked, Path]]:
    """The daemon under way, and its socket."""
    socket = folder / "bentod.sock"
    command = [sys.executable, "-m", "tests.benchmarks.rigs.soaked", str(CONFIGS / "sim.toml"), str(socket)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            eventually(socket.exists)
            yield Soaked(process), socket
        finally:
            process.terminate()
            process.wait(20)


async def cycle(socket: Path, seed: int) -> int:
    """Guests for a while, then nobody; how many visits there were."""
    visits = await churn(socket, BUSY, seed)
    async with Client.connect(socket) as arm:
        await restore(arm)
    return visits


def slope(looks: Sequence[Look]) -> tuple[float, float]:
    """How fast it grows by a straight line through them, and how far off that may be (MB/h).

    That is the line's standard error, or one step in all that time if that is more: memory comes and goes in
    steps, not as the independent errors that the formula supposes.
    """
    hours = [look.time / 3600 for look in looks]
    sizes = [look.resident for look in looks]
    line = statistics.linear_regression(hours, sizes)
    left = [size - line.intercept - line.slope * hour for hour, size in zip(hours, sizes, strict=True)]
    mean = statistics.fmean(hours)
    spread = math.fsum((hour - mean) ** 2 for hour in hours)
    error = math.sqrt(math.fsum(rest**2 for rest in left) / max(len(looks) - 2, 1) / spread)
    step = max(abs(later - sooner) for sooner, later in pairwise(sizes)) / (hours[-1] - hours[0])
    return line.slope, max(error, step)


def rows() -> Iterator[Row]:
    """MINUTES, ten unless told."""
    looks: list[Look] = []
    visits = 0
    with TemporaryDirectory() as folder, soaked(Path(folder)) as (daemon, socket):
        end = time.monotonic() + MINUTES * 60
        while time.monotonic() < end or len(looks) < 8:
            visits += asyncio.run(cycle(socket, len(looks)))
            time.sleep(QUIET)
            looks.append(daemon.look())
        with BlockingClient(socket) as arm:
            last = table(arm.call("get_state"))
    yield from _growth(looks)
    yield Row("visits of clients", visits, f"in {MINUTES:g} min")
    yield Row("ticks missed", number(last, "missed"), f"of {number(last, 'tick'):g}")


def _growth(looks: Sequence[Look]) -> Iterator[Row]:
    later = looks[len(looks) // 2 :]
    rate, noise = slope(later)
    yield at_most("resident memory, slope of the second half / its uncertainty", rate / noise, "", 2)
    yield Row("  slope", rate, "MB/h")
    yield Row("  uncertainty", noise, "MB/h")
    yield Row("  after the first guests", looks[0].resident, "MB")
    yield Row("  at half-time", later[0].resident, "MB")
    yield Row("  at the end", looks[-1].resident, "MB")
    for what in ("descriptors", "tasks", "threads"):
        counts = [getattr(look, what) for look in later]
        yield at_most(f"{what}, second half, most - least", max(counts) - min(counts), "", 0)
        yield Row("  least", min(counts), "")
    yield at_least("looks", len(looks), "", 8)


if __name__ == "__main__":
    main("soak", rows())
