"""How a client measures muscles: everybody at rest, then one contraction after the other."""

import asyncio
import math
from collections.abc import AsyncIterator, Callable, Mapping, Sequence
from contextlib import asynccontextmanager
from dataclasses import dataclass

import numpy as np

from bentod.calibration.muscles import SCATTER, SHARE, Levels, Setting, settings
from bentod.cli import show
from bentod.client import Client
from bentod.errors import ConfigError, Refused, nearest
from bentod.frames import Value

Told = Callable[[str], None]

PACE = 0.02
"""s between two looks at the envelopes; the daemon answers once a tick."""

REACTION = 0.5
"""s after the word in which a contraction builds up, and which do not count."""


@dataclass(frozen=True, slots=True)
class Plan:
    """What is asked of the wearer, and what is made of it."""

    sites: Sequence[str] = ()  # all when empty
    ready: float = 3.0  # s to get ready for each
    rest: float = 5.0  # s
    hold: float = 3.0  # s of each contraction
    scatter: float = SCATTER  # standard deviations of rest, from its mean to the threshold
    share: float = SHARE  # of the strongest contraction, at which effort is full


async def measure(arm: Client, plan: Plan, told: Told) -> list[Setting]:
    """What each site should be set to; nothing is set yet. The muscles drive nothing meanwhile.

    However this ends, EMG is paused afterwards if it was before, and only then.

    Raises:
        ConfigError: there is no such site.
        Refused: the source is not alive, somebody let the muscles drive again, or too little was seen.
    """
    described = show.fields(await arm.call("emg_get"))
    sites = _chosen(described, plan.sites)
    async with _quiet(arm):
        rest = await _ask(arm, plan, "relax every muscle", plan.rest, told)
        contractions = {}
        for site in sites:
            asked = f"contract the muscle of site {site} as strongly as is comfortable, and hold"
            contractions[site] = await _ask(arm, plan, asked, plan.hold, told)
        told("Thank you: relax.")
    return settings(rest, contractions, plan.scatter, plan.share, _toggles(described))


async def apply(arm: Client, found: Sequence[Setting]) -> list[str]:
    """Set the sites whose contraction can be told from rest; returns their names."""
    good = [one for one in found if one.separable]
    for one in good:
        await arm.call("emg_set", site=one.site, threshold_v=one.threshold, max_v=one.maximum)
    return [one.site for one in good]


def _toggles(described: Mapping[str, Value]) -> set[str]:
    """Sites of which a contraction toggles."""
    schemes = [
        show.fields(one) for key in ("pairs", "single_sites") for one in show.entries(described.get(key))
    ]
    return {str(one[key]) for one in schemes for key in ("toggle", "toggle_back") if one.get(key)}


def _chosen(described: Mapping[str, Value], wanted: Sequence[str]) -> list[str]:
    names = [str(show.fields(site)["name"]) for site in show.entries(described.get("sites"))]
    if not names:
        raise ConfigError("this arm has no EMG sites: its config has no [emg] table")
    for name in wanted:
        if name not in names:
            raise ConfigError(f"there is no EMG site '{name}'{nearest(name, names)}")
    return [name for name in names if name in (wanted or names)]


@asynccontextmanager
async def _quiet(arm: Client) -> AsyncIterator[None]:
    """While entered, the muscles drive nothing."""
    was = bool(show.fields(await arm.call("emg_get")).get("paused"))
    await arm.call("emg_pause", on=True)
    try:
        yield
    finally:
        if not was:
            await arm.call("emg_pause", on=False)


async def _ask(arm: Client, plan: Plan, what: str, seconds: float, told: Told) -> dict[str, Levels]:
    """Ask for something, count down, and say how loud every site was while it was done."""
    left = plan.ready
    while left > 0:
        told(f"In {left:g} s, for {seconds:g} s: {what}.")
        await asyncio.sleep(min(left, 1.0))
        left -= 1.0
    told(f"Now, for {seconds:g} s: {what}!")
    await asyncio.sleep(REACTION)
    return await _levels(arm, max(seconds - REACTION, REACTION))


async def _levels(arm: Client, seconds: float) -> dict[str, Levels]:
    """V after gain, by site, one a tick in which samples came; NaN where it is not known.

    Raises:
        Refused: the source is not alive, or somebody let the muscles drive again.
    """
    loop = asyncio.get_running_loop()
    end, newest = loop.time() + seconds, -1
    seen: list[dict[str, Value]] = []
    while loop.time() < end:
        told = show.fields(await arm.call("emg_levels"))
        if not told["paused"]:
            raise Refused("somebody let the muscles drive again; nothing was set")
        if isinstance(told["index"], int) and told["index"] > newest:
            newest = told["index"]
            seen.append(show.fields(told["levels_v"]))
        await asyncio.sleep(PACE)
    await _must_be_alive(arm)
    sites = seen[0] if seen else {}
    return {site: np.array([_volts(levels[site]) for levels in seen]) for site in sites}


async def _must_be_alive(arm: Client) -> None:
    muscles = show.fields(show.fields(await arm.call("get_state")).get("emg"))
    if not muscles.get("alive"):
        raise Refused(f"the muscles cannot be measured: {show.word(muscles.get('problem'))}")


def _volts(value: Value) -> float:
    return float(value) if isinstance(value, int | float) else math.nan
