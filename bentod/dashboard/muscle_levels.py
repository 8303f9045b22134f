"""How loud sites are, asked of the daemon once for all browsers that want to know."""

import asyncio
from dataclasses import dataclass, field

from bentod.dashboard.own import Own, Stage, Visit, own
from bentod.frames import Value

KEY = "emg_levels"
"""Under which the server keeps the newest answer."""

FRESH = 0.08
"""s for which an answer holds: charts draw the level ten times a second."""


@dataclass(slots=True)
class Newest:
    """The newest answer, and when it came (monotonic s)."""

    at: float = -FRESH
    answer: Value = None
    asking: asyncio.Lock = field(default_factory=asyncio.Lock)


async def levels(visit: Visit, params: dict[str, Value]) -> Value:
    """As `emg_levels` tells, at most 0.08 s old. Raises BentodError: the daemon is not there."""
    kept, now = _kept(visit.stage), asyncio.get_running_loop().time
    async with kept.asking:
        if now() - kept.at >= FRESH:
            kept.answer = await visit.stage.look("emg_levels", {})
            kept.at = now()
    return kept.answer


def _kept(stage: Stage) -> Newest:
    kept = stage.kept.get(KEY)
    if not isinstance(kept, Newest):
        kept = stage.kept[KEY] = Newest()
    return kept


METHODS: dict[str, Own] = own(observer={"dashboard.emg_levels": levels}, operator={})
"""By name."""
