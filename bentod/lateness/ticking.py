"""Ways to tick, each telling how late its ticks began: bentod's clock, its whole daemon, a naive sleep."""

import asyncio
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TypeAlias

from bentod.clock import SystemClock
from bentod.config import Config
from bentod.culprit import Lookout
from bentod.daemon import Daemon
from bentod.realtime import Upkeep
from bentod.supervise import Supervisor
from bentod.tick import next_deadline


@dataclass(frozen=True, slots=True)
class Ticks:
    """What was seen of a row of ticks."""

    late: tuple[float, ...]  # s from each tick's deadline to its start
    missed: int  # deadlines that had passed before their tick could begin

    def __add__(self, more: "Ticks") -> "Ticks":
        return Ticks(self.late + more.late, self.missed + more.missed)


NOTHING = Ticks((), 0)


@dataclass(frozen=True, slots=True)
class Stretch:
    """How many ticks, how fast, and how many before them do not count."""

    rate_hz: float
    ticks: int
    first: int = 0

    @property
    def period(self) -> float:
        """From one deadline to the next (s)."""
        return 1 / self.rate_hz

    @property
    def all(self) -> int:
        """Ticks that are made, in number."""
        return self.first + self.ticks

    def judged(self, deadlines: Mapping[float, float]) -> Ticks:
        """Of the starts (s) by deadline (s), those that count, and those that are missing between them."""
        kept = list(deadlines.items())[self.first : self.all]
        late = tuple(start - deadline for deadline, start in kept)
        span = kept[-1][0] - kept[0][0] if kept else 0.0
        return Ticks(late, max(0, round(span * self.rate_hz) + 1 - len(kept)))


Starts: TypeAlias = dict[float, float]
"""When each tick began (monotonic s), by its deadline (monotonic s)."""


async def by_clock(stretch: Stretch, *, precise: bool = True) -> Ticks:
    """Bentod's clock, and a tick that does nothing; without `precise` the event loop's own timers."""
    starts: Starts = {}
    async with SystemClock(precise=precise) as clock:
        due = clock.now() + stretch.period
        while len(starts) < stretch.all:
            await clock.sleep_until(due)
            starts[due] = clock.now()
            due, _ = next_deadline(due, stretch.period, clock.now())
    return stretch.judged(starts)


async def by_sleep(stretch: Stretch) -> Ticks:
    """A loop that sleeps for a period again and again.

    It is judged by its own last waking: late is what it slept beyond a period. That it drifts away from any
    deadline, and would by the time of its work besides, is not held against it.
    """
    loop = asyncio.get_running_loop()
    late: list[float] = []
    last = loop.time()
    while len(late) < stretch.all:
        await asyncio.sleep(stretch.period)
        woken = loop.time()
        late.append(woken - last - stretch.period)
        last = woken
    counted = tuple(late[stretch.first :])
    return Ticks(counted, sum(int(sleep * stretch.rate_hz) for sleep in counted))


async def by_daemon(stretch: Stretch, config: Config, socket: Path, upkeep: Upkeep) -> Ticks:
    """The tick of a whole daemon with this arm, which should be simulated. Raises as `Daemon.run` does."""
    watch = _Watch()
    clock = _Observed(watch)
    around = replace(upkeep, lookout=watch)
    at_rate = config.model_copy(update={"rate_hz": stretch.rate_hz})
    async with clock:
        await Daemon(at_rate, clock, Supervisor(), socket, upkeep=around).run(stretch.all + 1)
    if len(watch.starts) < stretch.all:
        raise KeyboardInterrupt  # the daemon took the signal for its own end
    return stretch.judged(watch.starts)


class _Watch(Lookout):
    """Hears from each tick when the next one is due; the very first is nobody's next."""

    def __init__(self) -> None:
        self.due = 0.0
        self.starts: Starts = {}

    def watch(self, due: float, now: float, after: float) -> None:
        """A tick is over, the next is due at `due` (monotonic s)."""
        self.due = due


class _Observed(SystemClock):
    """The clock of a daemon, which has many sleepers; one of them is the tick."""

    def __init__(self, watch: _Watch) -> None:
        super().__init__()
        self._watch = watch

    async def sleep_until(self, deadline: float) -> None:
        """As the clock does it; notes the time if this was for the tick."""
        await super().sleep_until(deadline)
        if deadline == self._watch.due:
            self._watch.starts.setdefault(deadline, self.now())
