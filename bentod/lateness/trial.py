"""One trial: ways to tick, taken in turns at some rates, idle and under load, and what comes of each."""

import asyncio
import os
import time
from collections.abc import Callable, Coroutine, Mapping, Sequence
from contextlib import AsyncExitStack, ExitStack
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TypeAlias

from bentod.clock import SystemClock
from bentod.config import Config
from bentod.config_tables import Realtime
from bentod.lateness import load
from bentod.lateness.machine import stolen
from bentod.lateness.ticking import NOTHING, Stretch, Ticks, by_clock, by_daemon, by_sleep
from bentod.realtime import Upkeep, upkeep

WARM_UP = 1.0
"""s before the first tick that counts: what is done for the first time is done, and the load is there."""

ROUNDS = 5

CALM, FEWEST = 0.005, 3
"""Share of all cores that the host may take in an undisturbed round, and how many such rounds are enough.
A host that takes more stops the whole machine for up to 40 ms at a time, which no program can make good. So
rounds are chosen by what the host did in them to all cases alike, never by their outcome."""

MOST_HZ = 500.0
"""What a config may ask of the daemon."""

DAEMON, CLOCK, SLEEP = "bentod's daemon", "bentod's clock", "asyncio.sleep"

Way: TypeAlias = Callable[[Stretch, Path, Upkeep], Coroutine[object, object, Ticks]]
"""Ticks in a running loop; a daemon, if it has one, serves the socket at the path."""


@dataclass(frozen=True, slots=True)
class Case:
    """What is measured."""

    way: str
    rate_hz: float
    loaded: bool


def ways(config: Config) -> dict[str, Way]:
    """Those of every trial, by name."""
    return {
        DAEMON: lambda stretch, socket, around: by_daemon(stretch, config, socket, around),
        CLOCK: lambda stretch, socket, around: by_clock(stretch),
        SLEEP: lambda stretch, socket, around: by_sleep(stretch),
    }


def cases(named: Sequence[str], rates: Sequence[float], loads: Sequence[bool]) -> list[Case]:
    """Every way at every rate, but no daemon faster than a config allows."""
    return [
        Case(way, rate, loaded)
        for rate in rates
        for loaded in loads
        for way in named
        if way != DAEMON or rate <= MOST_HZ
    ]


def burst(way: Way, case: Case, seconds: float, realtime: Realtime) -> Ticks:
    """One case, once. Raises ConfigError: `realtime` is refused and required."""
    with TemporaryDirectory() as folder:
        return asyncio.run(_burst(way, case, seconds, realtime, Path(folder, "bentod.sock")))


@dataclass(frozen=True, slots=True)
class Round:
    """Every case once."""

    stolen: float  # share of all cores that the host of a virtual machine took meanwhile
    found: Mapping[Case, Ticks]

    @property
    def calm(self) -> bool:
        """Whether it was undisturbed."""
        return self.stolen <= CALM


def trial(
    measured: Mapping[Case, Callable[[], Ticks]],
    tell: Callable[[str], None],
    rounds: int = ROUNDS,
    most: int = 0,
) -> list[Round]:
    """All cases in turns, each round starting with another one, so that a disturbance falls on all alike.

    With `most` it goes on until as many as `rounds` were undisturbed, or there are so many in all.
    """
    done: list[Round] = []
    while len(done) < rounds or (sum(one.calm for one in done) < rounds and len(done) < most):
        done.append(_round(measured, len(done) / rounds % 1, tell))
    return done


def undisturbed(rounds: Sequence[Round]) -> list[Round]:
    """Rounds that the host left alone; all of them if these are too few to tell anything."""
    calm = [one for one in rounds if one.calm]
    return calm if len(calm) >= min(FEWEST, len(rounds)) else list(rounds)


def together(rounds: Sequence[Round]) -> dict[Case, Ticks]:
    """What was found in all of these rounds."""
    return {case: sum((one.found[case] for one in rounds), NOTHING) for case in rounds[0].found}


def describe(case: Case) -> str:
    """The case in words."""
    return f"{case.way} at {case.rate_hz:g} Hz, {'under load' if case.loaded else 'idle'}"


def _round(measured: Mapping[Case, Callable[[], Ticks]], begin: float, tell: Callable[[str], None]) -> Round:
    """`begin`: 0..1, with which of them."""
    order = list(measured)
    first = int(begin * len(order))
    began, before = time.monotonic(), stolen()
    found: dict[Case, Ticks] = {}
    for case in order[first:] + order[:first]:
        tell(describe(case))
        found[case] = measured[case]()
    share = (stolen() - before) / (time.monotonic() - began) / (os.cpu_count() or 1)
    return Round(share, {case: found[case] for case in order})


async def _burst(way: Way, case: Case, seconds: float, realtime: Realtime, socket: Path) -> Ticks:
    stretch = Stretch(case.rate_hz, max(1, round(seconds * case.rate_hz)), round(WARM_UP * case.rate_hz))
    with ExitStack() as stack:
        if case.loaded:  # started first: it must not get the scheduling that is asked for here
            stack.enter_context(load.requests(socket))
        async with SystemClock() as clock, AsyncExitStack() as tasks:
            around = stack.enter_context(upkeep(realtime, clock))
            if case.loaded:
                await tasks.enter_async_context(load.churn())
            if case.loaded and case.way != DAEMON:
                await tasks.enter_async_context(load.answering(socket))
            return await way(stretch, socket, around)
