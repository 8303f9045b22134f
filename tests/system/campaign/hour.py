"""Fault after fault on one and the same arm, each gone before the next comes, for as long as you like."""

from dataclasses import dataclass, field
from random import Random

from tests.system.campaign import bus_faults, emg_faults
from tests.system.campaign.case import Case, face
from tests.system.campaign.rig import RESTARTED, rigged


@dataclass(slots=True)
class Tally:
    """What came of it."""

    faults: int = 0
    seconds: float = 0.0  # of virtual time
    missed: float = 0.0  # ticks
    errors: int = 0  # faults that a tick which broke has caused
    broken: list[str] = field(default_factory=list)  # promises, as sentences


def lasting(by_muscles: bool) -> list[Case]:
    """Faults after which the same arm goes on, with the same config, and nothing of it has fallen.

    A slow clock is not among them: after 30 s of it the source counts as late for good.
    """
    cases = emg_faults.CASES if by_muscles else bus_faults.CASES
    return [
        case
        for case in cases
        if RESTARTED not in case.recovery
        and not case.changes
        and case.bound is not bus_faults.LIMP
        and case is not emg_faults.SLOW
    ]


async def endure(by_muscles: bool, seconds: float, seed: int) -> Tally:
    """Random faults for so many virtual seconds, of the bus or of the muscles."""
    random = Random(f"{by_muscles}/{seed}")
    tally = Tally()
    cases = lasting(by_muscles)
    async with rigged(by_muscles, False, seed, random=random) as rig:
        await rig.set_off(random)
        start, already = rig.now, rig.missed()
        while rig.now < start + seconds:
            outcome = await face(random.choice(cases), rig, random)
            tally.faults += 1
            tally.broken += outcome.broken()
            tally.errors += "internal error" in outcome.told
            if outcome.recovery == RESTARTED:
                break
        tally.seconds, tally.missed = rig.now - start, rig.missed() - already
    return tally
