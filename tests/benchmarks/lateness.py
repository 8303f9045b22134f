"""How late the daemon's tick starts at 30 Hz on the real clock, beside a naive loop that only sleeps.

All in this process, in turns, nobody connected. A tick of the daemon is late against its deadline, which is
absolute: what one tick loses, the next must win back. The naive loop is judged by its own last waking: late
is what it sleeps beyond a period. That it does nothing in between and drifts away is not held against it.

The promise is of an idle daemon: it reads, learns and writes at every tick, but nobody asks anything of it. A
wearer's samples come in at moments of their own, some of them just before a tick; that is shown beside it.
"""

import asyncio
import os
import statistics
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from unittest import mock

from bentod.clock import SystemClock
from bentod.config import Config
from bentod.daemon import Daemon
from bentod.supervise import Supervisor
from bentod.tick import Controller
from tests.benchmarks.harness import Row, at_most, main, percentile
from tests.rig import quiet_config, sim_config

PERIOD = 1 / 30  # s
FIRST = 30
"""Ticks before the first that counts: the arm gets its torque, and nothing is done for the first time."""
TICKS = 200  # that count, in a round
ROUNDS = 6  # that count
MOST_ROUNDS = 12
FEWEST = 3
"""Undisturbed rounds; with fewer all rounds count, and tell more of the host than of the daemon."""
CALM = 0.005
"""Share of all cores that the host may take in an undisturbed round. One that takes more stops the whole
machine for up to 40 ms at a time, which no program can make good. So rounds are chosen by what the host did
in them to all kinds alike, never by their outcome."""
STAT, STEAL = Path("/proc/stat"), 8  # the file's word for it is the ninth, man proc_stat


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

    def each(self, share: float) -> list[float]:
        """A percentile of each round (s)."""
        return [percentile(found, share) for found in self.rounds]

    def median(self, share: float) -> float:
        """Median over the rounds of a percentile (s)."""
        return statistics.median(self.each(share))

    def pooled(self, share: float) -> float:
        """A percentile of all rounds together (s)."""
        return percentile([late for found in self.rounds for late in found], share)


def by_daemon(config: Config) -> list[float]:
    """Lateness (s) of the ticks of a whole daemon with a simulated arm."""
    late: list[float] = []
    original = Controller.tick

    async def tick(self: Controller, due: float, gap: bool) -> None:
        late.append(time.monotonic() - due)
        await original(self, due, gap)

    with TemporaryDirectory() as folder, mock.patch.object(Controller, "tick", tick):
        asyncio.run(_daemon(config, Path(folder, "bentod.sock")))
    return late


async def _daemon(config: Config, socket: Path) -> None:
    async with SystemClock() as clock:
        await Daemon(config, clock, Supervisor(), socket).run(FIRST + TICKS)


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


def stolen() -> float:
    """CPU time (s) that the host of this virtual machine gave to others; 0 where nobody counts it."""
    if not STAT.exists():
        return 0.0
    return int(STAT.read_text().split()[STEAL]) / os.sysconf("SC_CLK_TCK")


def sweeps(kinds: Sequence[Kind]) -> list[float]:
    """Rounds of all kinds in turns until enough are undisturbed; the host's share of all cores in each."""
    shares: list[float] = []
    while len(shares) < MOST_ROUNDS and sum(share <= CALM for share in shares) < ROUNDS:
        began, before = time.monotonic(), stolen()
        for place in range(len(kinds)):
            kinds[(place + len(shares)) % len(kinds)].measure()
        shares.append((stolen() - before) / (time.monotonic() - began) / (os.cpu_count() or 1))
    return shares


def rows() -> Iterator[Row]:
    """Two and a half minutes on a calm machine, up to twice as long on another."""
    kinds = {
        "idle": Kind(partial(by_daemon, quiet_config())),
        "with a wearer": Kind(partial(by_daemon, sim_config())),
        "naive sleep": Kind(by_sleep),
    }
    idle, worn, naive = kinds.values()
    shares = sweeps((idle, worn, naive))
    calm = [place for place, share in enumerate(shares) if share <= CALM]
    counted = calm if len(calm) >= FEWEST else range(len(shares))
    for kind in kinds.values():
        kind.rounds = [kind.rounds[place] for place in counted]
    for share in (0.99, 0.5):
        what = f"lateness at 30 Hz, p{share * 100:g} of the"
        yield at_most(f"{what} idle tick / naive sleep", idle.median(share) / naive.median(share), "", 0.5)
        yield Row("  the same of all ticks together", idle.pooled(share) / naive.pooled(share), "")
        yield Row(f"{what} tick with a wearer / naive sleep", worn.median(share) / naive.median(share), "")
        yield Row("  the same of all ticks together", worn.pooled(share) / naive.pooled(share), "")
        yield from _spread(share, kinds)
    yield Row("  ticks of each that count", TICKS * len(counted), "")
    yield Row("  rounds undisturbed by the host", len(calm), f"of {len(shares)}")
    took = statistics.fmean(shares[place] for place in counted)
    yield Row("  the host took, in the rounds that count", took * 100, "%")


def _spread(share: float, kinds: dict[str, Kind]) -> Iterator[Row]:
    for name, kind in kinds.items():
        yield Row(f"  {name}, median of the rounds", kind.median(share) * 1e6, "µs")
        yield Row(f"  {name}, least round", min(kind.each(share)) * 1e6, "µs")
        yield Row(f"  {name}, greatest round", max(kind.each(share)) * 1e6, "µs")


if __name__ == "__main__":
    main("lateness", rows())
