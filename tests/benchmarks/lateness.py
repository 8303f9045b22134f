"""How late the daemon's tick starts at 30 Hz on the real clock, beside a naive loop that only sleeps.

Both in this process, in turns, nobody connected. A tick of the daemon is late against its deadline, which is
absolute: what one tick loses, the next must win back. The naive loop is judged by its own last waking: late
is what it sleeps beyond a period. That it does nothing in between and drifts away is not held against it.
"""

import asyncio
import os
import statistics
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from unittest import mock

from bentod.clock import SystemClock
from bentod.daemon import Daemon
from bentod.supervise import Supervisor
from bentod.tick import Controller
from tests.benchmarks.harness import Row, at_most, main, percentile
from tests.rig import sim_config

PERIOD = 1 / 30  # s
FIRST = 30
"""Ticks before the first that counts: the arm gets its torque, and nothing is done for the first time."""
TICKS = 200  # that count, in a round
ROUNDS = 7
"""On an idle machine, which is what is promised for; chosen by what others do, never by the outcome."""
MOST_ROUNDS = 14
FEWEST = 3
"""Rounds on an idle machine; with fewer all rounds are counted, and tell of the neighbours."""
IDLE = 0.1
"""Share of all cores that other processes may take, at most."""
STAT = Path("/proc/stat")


@dataclass(slots=True)
class Kind:
    """One way to tick, and how late it was, round by round (s)."""

    ticks: Callable[[], list[float]]
    rounds: list[list[float]] = field(default_factory=list)

    def measure(self) -> float:
        """The p99 of one more round (s)."""
        late = self.ticks()[FIRST:][:TICKS]
        assert len(late) == TICKS
        self.rounds.append(late)
        return percentile(late, 0.99)

    def median(self, share: float) -> float:
        """Median over the rounds of a percentile (s)."""
        return statistics.median(self.each(share))

    def pooled(self, share: float) -> float:
        """A percentile of all rounds together (s)."""
        return percentile([late for found in self.rounds for late in found], share)

    def each(self, share: float) -> list[float]:
        """A percentile of each round (s)."""
        return [percentile(found, share) for found in self.rounds]


def by_daemon() -> list[float]:
    """Lateness (s) of the daemon's ticks: all of it, with simulated arm and wearer, and nobody connected."""
    late: list[float] = []
    original = Controller.tick

    async def tick(self: Controller, due: float, gap: bool) -> None:
        late.append(time.monotonic() - due)
        await original(self, due, gap)

    with TemporaryDirectory() as folder, mock.patch.object(Controller, "tick", tick):
        asyncio.run(_daemon(Path(folder, "bentod.sock")))
    return late


async def _daemon(socket: Path) -> None:
    async with SystemClock() as clock:
        await Daemon(sim_config(), clock, Supervisor(), socket).run(FIRST + TICKS)


def by_sleep() -> list[float]:
    """Lateness (s) of a loop that does nothing but sleep."""
    return asyncio.run(_sleeper())


async def _sleeper() -> list[float]:
    late: list[float] = []
    last = time.monotonic()
    while len(late) < FIRST + TICKS:
        await asyncio.sleep(PERIOD)
        woken = time.monotonic()
        late.append(woken - (last + PERIOD))
        last = woken
    return late


def busy() -> float:
    """CPU time (s) that this machine has spent on anything since it was started; 0 where nobody counts."""
    if not STAT.exists():
        return 0.0
    user, nice, system, _idle, _wait, *rest = map(int, STAT.read_text().split("\n")[0].split()[1:9])
    return (user + nice + system + sum(rest)) / os.sysconf("SC_CLK_TCK")


def disturbed(kinds: Sequence[Kind]) -> float:
    """One more round of each; returns the share of all cores (0..1) that other processes took meanwhile."""
    others, began = busy() - time.process_time(), time.monotonic()
    for kind in kinds:
        kind.measure()
    others = busy() - time.process_time() - others
    return others / (time.monotonic() - began) / (os.cpu_count() or 1)


def compare(daemon: Kind, naive: Kind) -> list[float]:
    """Rounds of both in turns until enough of them were on an idle machine; what others took in each."""
    shares: list[float] = []
    while len(shares) < MOST_ROUNDS and sum(share <= IDLE for share in shares) < ROUNDS:
        shares.append(disturbed((daemon, naive) if len(shares) % 2 else (naive, daemon)))
    return shares


def rows() -> Iterator[Row]:
    """Two to four minutes: rounds that other processes disturbed are done again, up to a point."""
    daemon, naive = Kind(by_daemon), Kind(by_sleep)
    shares = compare(daemon, naive)
    idle = [place for place, share in enumerate(shares) if share <= IDLE]
    counted = idle if len(idle) >= FEWEST else range(len(shares))
    for kind in (daemon, naive):
        kind.rounds = [kind.rounds[place] for place in counted]
    for share in (0.99, 0.5):
        ratio = daemon.median(share) / naive.median(share)
        yield at_most(
            f"lateness at 30 Hz, p{share * 100:g} of the daemon's tick / naive sleep", ratio, "", 0.5
        )
        yield Row("  the same of all ticks together", daemon.pooled(share) / naive.pooled(share), "")
        for name, kind in (("daemon", daemon), ("naive sleep", naive)):
            yield Row(f"  {name}, median of the rounds", kind.median(share) * 1e6, "µs")
            yield Row(f"  {name}, least round", min(kind.each(share)) * 1e6, "µs")
            yield Row(f"  {name}, greatest round", max(kind.each(share)) * 1e6, "µs")
    yield Row("  ticks of each", TICKS * len(counted), "")
    yield Row("  rounds on an idle machine", len(idle), f"of {len(shares)}")
    yield Row("  other processes took, in the rounds counted", _mean(shares, counted) * 100, "% of all cores")


def _mean(values: Sequence[float], places: Sequence[int]) -> float:
    return statistics.fmean(values[place] for place in places)


if __name__ == "__main__":
    main("lateness", rows())
