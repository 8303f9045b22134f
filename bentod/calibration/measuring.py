"""How a client measures muscles: everybody at rest, then one contraction after the other."""

import asyncio
import math
from collections.abc import AsyncIterator, Callable, Iterator, Mapping, Sequence
from contextlib import asynccontextmanager
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from bentod.calibration.muscles import SCATTER, SHARE, Levels, Setting, settings
from bentod.errors import ConfigError, Refused, nearest
from bentod.frames import Value

PACE = 0.02
"""s between two looks at the envelopes; the daemon answers once a tick."""

REACTION = 0.5
"""s after the word in which a contraction builds up, and which do not count."""


class Arm(Protocol):
    """Whoever can ask the daemon."""

    async def call(self, method: str, /, *params: Value, **named: Value) -> Value:
        """Ask and wait for the answer. Raises BentodError: the daemon refuses, or is not there."""
        ...


@dataclass(frozen=True, slots=True)
class Plan:
    """What is asked of the wearer, and what is made of it."""

    sites: Sequence[str] = ()  # all when empty
    ready: float = 3.0  # s to get ready for each
    rest: float = 5.0  # s
    hold: float = 3.0  # s of each contraction
    scatter: float = SCATTER  # standard deviations of rest, from its mean to the threshold
    share: float = SHARE  # of the strongest contraction, at which effort is full


@dataclass(frozen=True, slots=True)
class Step:
    """What is asked of the wearer at this moment."""

    number: int  # from 0: rest, and then each site
    site: str  # whose muscle is to be contracted; empty: all are to rest
    seconds: float  # for which it is to be done
    ready: float  # s until then; 0: now

    @property
    def text(self) -> str:
        """As a sentence."""
        what = f"contract the muscle of site {self.site} as strongly as is comfortable, and hold"
        what = what if self.site else "relax every muscle"
        if self.ready:
            return f"In {self.ready:g} s, for {self.seconds:g} s: {what}."
        return f"Now, for {self.seconds:g} s: {what}!"


Told = Callable[[Step], None]


async def measure(arm: Arm, plan: Plan, told: Told) -> list[Setting]:
    """What each site should be set to; nothing is set yet. The muscles drive nothing meanwhile.

    However this ends, EMG is paused afterwards if it was before, or somebody else asked for it meanwhile.

    Raises:
        ConfigError: there is no such site.
        Refused: the source is not alive, somebody let the muscles drive again, or too little was seen.
    """
    described = _fields(await arm.call("emg_get"))
    sites = chosen(described, plan.sites)
    async with _quiet(arm):
        rest = await _ask(arm, Step(0, "", plan.rest, plan.ready), told)
        contractions = {
            site: await _ask(arm, Step(number, site, plan.hold, plan.ready), told)
            for number, site in enumerate(sites, 1)
        }
    return settings(rest, contractions, plan.scatter, plan.share, _toggles(described))


async def apply(arm: Arm, found: Sequence[Setting]) -> list[str]:
    """Set the sites whose contraction can be told from rest; returns their names."""
    good = [one for one in found if one.separable]
    for one in good:
        await arm.call("emg_set", site=one.site, threshold_v=one.threshold, max_v=one.maximum)
    return [one.site for one in good]


def chosen(described: Value, wanted: Sequence[str]) -> list[str]:
    """The names of sites in what `emg_get` tells: those that are wanted, or all when none is named.

    Raises:
        ConfigError: there are no sites, or there is no such one.
    """
    names = [str(site["name"]) for site in _tables(_fields(described), "sites")]
    if not names:
        raise ConfigError("this arm has no EMG sites: its config has no [emg] table")
    for name in wanted:
        if name not in names:
            raise ConfigError(f"there is no EMG site '{name}'{nearest(name, names)}")
    return [name for name in names if name in (wanted or names)]


def _toggles(described: Mapping[str, Value]) -> set[str]:
    """Sites of which a contraction toggles."""
    schemes = [one for key in ("pairs", "single_sites") for one in _tables(described, key)]
    return {str(one[key]) for one in schemes for key in ("toggle", "toggle_back") if one.get(key)}


@asynccontextmanager
async def _quiet(arm: Arm) -> AsyncIterator[None]:
    """While entered, the muscles drive nothing."""
    was = _fields(await arm.call("emg_get"))
    await arm.call("emg_pause", on=True)
    own = _fields(await arm.call("emg_get")).get("pauses")
    try:
        yield
    finally:
        if not was.get("paused") and _fields(await arm.call("emg_get")).get("pauses") == own:
            await arm.call("emg_pause", on=False)


async def _ask(arm: Arm, step: Step, told: Told) -> dict[str, Levels]:
    """Ask for something, count down, and say how loud every site was while it was done."""
    left = step.ready
    while left > 0:
        told(Step(step.number, step.site, step.seconds, left))
        await asyncio.sleep(min(left, 1.0))
        left -= 1.0
    told(Step(step.number, step.site, step.seconds, 0.0))
    await asyncio.sleep(REACTION)
    return await _levels(arm, max(step.seconds - REACTION, REACTION))


async def _levels(arm: Arm, seconds: float) -> dict[str, Levels]:
    """V after gain, by site, one a tick in which samples came; NaN where it is not known.

    Raises:
        Refused: the source is not alive, or somebody let the muscles drive again.
    """
    loop = asyncio.get_running_loop()
    end, newest = loop.time() + seconds, -1
    seen: list[dict[str, Value]] = []
    while loop.time() < end:
        told = _fields(await arm.call("emg_levels"))
        if not told["paused"]:
            raise Refused("somebody let the muscles drive again; nothing was set")
        if isinstance(told["index"], int) and told["index"] > newest:
            newest = told["index"]
            seen.append(_fields(told["levels_v"]))
        await asyncio.sleep(PACE)
    await _must_be_alive(arm)
    sites = seen[0] if seen else {}
    return {site: np.array([_volts(levels[site]) for levels in seen]) for site in sites}


async def _must_be_alive(arm: Arm) -> None:
    muscles = _fields(_fields(await arm.call("get_state")).get("emg"))
    if not muscles.get("alive"):
        problem = str(muscles.get("problem") or "nothing is heard of them")
        raise Refused(f"the muscles cannot be measured: {problem}")


def _volts(value: Value) -> float:
    return float(value) if isinstance(value, int | float) else math.nan


def _fields(value: Value) -> dict[str, Value]:
    return value if isinstance(value, dict) else {}


def _tables(described: Mapping[str, Value], key: str) -> Iterator[dict[str, Value]]:
    rows = described.get(key)
    return (row for row in (rows if isinstance(rows, list) else ()) if isinstance(row, dict))
