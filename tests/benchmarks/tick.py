"""How late a tick begins: bentod's daemon and its clock beside what else there is, idle and under load.

All take turns, so that a disturbance falls on all alike; rounds in which the host of a virtual machine took
the processors away are left out for all alike. MINUTES: of the daemon at 30 Hz under load, at the end.
ROUNDS: more are surer. FIFO: everything runs with this priority of SCHED_FIFO, cyclictest too.
"""

import asyncio
import os
import shutil
from collections.abc import Iterator, Mapping
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import click

from bentod import logs
from bentod.cli.bench import idle_arm
from bentod.config_tables import Realtime
from bentod.lateness.histogram import percentiles
from bentod.lateness.ticking import Stretch, Ticks, by_clock
from bentod.lateness.trial import (
    CLOCK,
    DAEMON,
    SLEEP,
    Case,
    Way,
    burst,
    cases,
    describe,
    together,
    trial,
    undisturbed,
    ways,
)
from tests.benchmarks.harness import Row, at_least, at_most, main
from tests.rig import sim_config

CALL_AT, CYCLICTEST = "loop.call_at", "cyclictest"

SECONDS = {30.0: 6.0, 200.0: 3.0, 1000.0: 2.0}
"""Of one burst, by rate (Hz)."""

MINUTES = float(os.environ.get("MINUTES", "1"))
ROUNDS = int(os.environ.get("ROUNDS", "4"))
REALTIME = Realtime(priority=int(os.environ.get("FIFO", "0")), required=True)

GREATEST = 200_000
"""µs; the histogram of cyclictest ends here."""


async def by_cyclictest(stretch: Stretch) -> Ticks:
    """The usual measure of a kernel's latency: a thread that does nothing but wake, man cyclictest."""
    with TemporaryDirectory() as folder:
        file = Path(folder, "histogram")
        # Any priority, even 0, makes it SCHED_FIFO.
        policy = ["--policy=fifo", f"-p{REALTIME.priority}"] if REALTIME.priority else ["--policy=other"]
        words = ["-q", "-t1", *policy, f"-l{stretch.ticks}", f"-i{round(stretch.period * 1e6)}"]
        words += [f"-h{GREATEST}", f"--histfile={file}"]
        process = await asyncio.create_subprocess_exec(
            "cyclictest", *words, stdout=asyncio.subprocess.DEVNULL
        )
        assert await process.wait() == 0, "cyclictest failed"
        return _parsed(file.read_text())


def _parsed(histogram: str) -> Ticks:
    """Lines of microseconds and counts; a tick that was later than the histogram reaches counts as that."""
    late: list[float] = []
    for line in histogram.splitlines():
        if line[:1].isdigit():
            micros, count = line.split()
            late += [int(micros) * 1e-6] * int(count)
        elif line.startswith("# Histogram Overflows:"):
            late += [GREATEST * 1e-6] * sum(map(int, line.split()[3:]))
    return Ticks(tuple(late), 0)


def kinds() -> dict[str, Way]:
    """All ways to tick; one that is not installed is left out."""
    known = ways(idle_arm()) | {CALL_AT: lambda stretch, socket, around: by_clock(stretch, precise=False)}
    if shutil.which("cyclictest"):
        known[CYCLICTEST] = lambda stretch, socket, around: by_cyclictest(stretch)
    else:
        click.echo("cyclictest is not installed (Debian: rt-tests); its rows are left out")
    return known


def rows() -> Iterator[Row]:
    """About ten minutes, and MINUTES."""
    known = kinds()
    measured = {
        case: partial(burst, known[case.way], case, SECONDS[case.rate_hz], REALTIME)
        for case in cases(list(known), list(SECONDS), (False, True))
    }
    rounds = trial(measured, lambda what: None, ROUNDS)
    counted = undisturbed(rounds)
    found = together(counted)
    yield from _promises(found)
    yield Row("rounds that count", len(counted), f"of {len(rounds)}")
    yield Row("  the host took, at most", max(one.stolen for one in counted) * 100, "%")
    yield Row("load average now", os.getloadavg()[0], "")
    for case, ticks in found.items():
        yield from _spread(case, ticks)
    yield from _long()


def _promises(found: Mapping[Case, Ticks]) -> Iterator[Row]:
    """Ratios of the 99th percentiles, in each of the two cases that something was promised of."""

    def p99(way: str, rate: float, loaded: bool) -> float:
        return percentiles(found[Case(way, rate, loaded)].late)["p99"]

    for rate, loaded, bound in ((200.0, True, 3.0), (1000.0, False, 2.5)):
        what = f"p99 at {rate:g} Hz, {'under load' if loaded else 'idle'}"
        ours = DAEMON if rate == 200.0 else CLOCK
        yield at_least(
            f"{what}: {SLEEP} / {ours}", p99(SLEEP, rate, loaded) / p99(ours, rate, loaded), "", bound
        )
        if ours != CLOCK:
            yield Row(f"  {SLEEP} / {CLOCK}", p99(SLEEP, rate, loaded) / p99(CLOCK, rate, loaded), "")
        yield Row(f"  {CALL_AT} / {ours}", p99(CALL_AT, rate, loaded) / p99(ours, rate, loaded), "")
        if Case(CYCLICTEST, rate, loaded) in found:
            ratio = p99(ours, rate, loaded) / p99(CYCLICTEST, rate, loaded)
            yield at_most(f"  {ours} / {CYCLICTEST}, same scheduling class", ratio, "", 4)


def _spread(case: Case, ticks: Ticks) -> Iterator[Row]:
    for name, late in percentiles(ticks.late).items():
        yield Row(f"{describe(case)}, {name}", late * 1e6, "µs")
    yield Row(f"  missed, of {len(ticks.late)}", ticks.missed, "ticks")


def _long() -> Iterator[Row]:
    """The shipped simulation, bytes and wearer included, for some real minutes."""
    case = Case(DAEMON, 30.0, True)
    ticks = burst(ways(sim_config())[DAEMON], case, MINUTES * 60, REALTIME)
    yield at_most(f"missed in {MINUTES:g} real minutes at 30 Hz under load", ticks.missed, "ticks", 0)
    yield Row("  latest", percentiles(ticks.late)["max"] * 1e6, "µs")


if __name__ == "__main__":
    with logs.setup("ERROR"):
        main("tick", rows())
