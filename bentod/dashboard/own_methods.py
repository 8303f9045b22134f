"""Methods that the page's server answers itself, in the manner of the daemon's: one line each."""

from bentod.dashboard import calibrating, muscle_levels, sounds, tasks
from bentod.dashboard.own import Own, Visit, own
from bentod.frames import Value


async def stats(visit: Visit, params: dict[str, Value]) -> Value:
    """How the page's server does: browsers, frames sent and skipped for this one."""
    return visit.stats()


OWN: dict[str, Own] = (
    own(observer={"dashboard.stats": stats}, operator={})
    | calibrating.METHODS
    | muscle_levels.METHODS
    | sounds.METHODS
    | tasks.METHODS
)
"""By name."""
