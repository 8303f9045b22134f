"""One fault of the campaign, and how it is gone through."""

import asyncio
from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from random import Random
from typing import TypeAlias

from tests.system.campaign.outcome import Bound, Moved, Outcome
from tests.system.campaign.rig import BY_ITSELF, JOINTS, Rig, rigged

Breaks: TypeAlias = Callable[[Rig], Awaitable[float | None]]
"""Begins a fault; may return the moment (monotonic s) from which nobody asks for motion, if not now."""

Mends: TypeAlias = Callable[[Rig], Awaitable[None]]

ELBOW = JOINTS.index("elbow_flexion")

WATCHED = 1.0
"""s, longer than any bound."""


async def nothing(rig: Rig) -> None:
    """The cause went away by itself."""


@dataclass(frozen=True, slots=True)
class Case:
    """What breaks while the arm moves, and what is promised."""

    fault: str
    bound: Bound
    breaks: Breaks
    mends: Mends = nothing
    told: str = ""
    """Pattern of what the daemon must say of it; empty: it need not say anything."""
    recovery: tuple[str, ...] = (BY_ITSELF,)
    by_muscles: bool = False
    assisted: bool = False
    """Whether what is predicted may move the elbow meanwhile."""
    lasts: float = 0.0
    """s that the fault lasts while whoever moves the arm goes on to: it concerns neither them nor the arm,
    which must obey, and stop when they let go. 0: it is the fault after which nothing may move."""
    falters: bool = False
    """Whether what is asked may fail to be done meanwhile."""
    judged: tuple[int, ...] = tuple(range(len(JOINTS)))
    changes: tuple[tuple[str, str], ...] = ()


async def undergo(case: Case, seed: int) -> Outcome:
    """An arm of its own for the fault."""
    random = Random(f"{case.fault}/{seed}")
    async with rigged(case.by_muscles, case.assisted, seed, *case.changes, random=random) as rig:
        return await face(case, rig, random)


async def face(case: Case, rig: Rig, random: Random) -> Outcome:
    """An arm in motion, one fault, its end, and what it takes to move again."""
    await rig.set_off(random)
    rig.observe()
    begun = rig.now
    since = await case.breaks(rig) or rig.now
    strayed, went_on = 0.0, True
    if case.lasts:
        went_on, since, strayed = await _carry_on(case, rig, begun)
        went_on = went_on or case.falters
    await asyncio.sleep(WATCHED)
    moved = rig.moved(since, case.judged)
    told = rig.told()
    strayed = max(strayed, (await _mend(case, rig)).degrees)
    recovery = await rig.recover()
    asker = "muscles" if case.by_muscles else "client"
    return Outcome(
        case.fault, asker, case.bound, moved, strayed, went_on, told, recovery, case.told, case.recovery
    )


async def _carry_on(case: Case, rig: Rig, begun: float) -> tuple[bool, float, float]:
    """Whether the arm obeyed all the while, when it was let go, and how far (degrees) others strayed."""
    went_on = True
    while rig.now < begun + case.lasts:
        await asyncio.sleep(0.5)
        went_on = went_on and rig.moved(rig.now - 0.5, rig.driven).degrees > 1
        _turn_round(rig)
    since = rig.let_go()
    asked = (*rig.driven, ELBOW) if case.assisted else rig.driven
    others = [joint for joint in range(len(JOINTS)) if joint not in asked]
    return went_on, since, rig.moved(begun, others).degrees


def _turn_round(rig: Rig) -> None:
    """Have the operator move joints back before they come to their limits."""
    if rig.operator:
        for joint in rig.driven:
            away = rig.operator.velocities[JOINTS[joint]] * rig.arm.servos[joint].position > 0
            if away and abs(rig.arm.servos[joint].position) > 0.5:
                rig.operator.velocities[JOINTS[joint]] *= -1


async def _mend(case: Case, rig: Rig) -> Moved:
    """What moved because the cause went away, though nobody asks: a wearer does ask, and may."""
    if rig.operator:
        rig.operator.let_go()
        await asyncio.sleep(0.5)
    since = rig.now
    await case.mends(rig)
    await rig.lifted.aclose()
    if rig.source:
        rig.source.relaxed = False
        return Moved(0.0, 0.0)
    await asyncio.sleep(2.0)
    return rig.moved(since)
