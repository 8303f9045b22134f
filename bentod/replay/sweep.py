"""What a sweep over parameters tries, and what comes of it."""

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from bentod.errors import BadRequest
from bentod.frames import Value

MOST = 10_000
"""Combinations of one sweep."""


@dataclass(frozen=True, slots=True)
class Point:
    """One combination of parameters."""

    place: int  # among those of the sweep
    changes: Mapping[str, Value]

    def __str__(self) -> str:
        return ", ".join(f"{key}={shown(value)}" for key, value in self.changes.items())


@dataclass(frozen=True, slots=True)
class Measure:
    """How far one general value function was from what came to pass, in the unit of its cumulant."""

    name: str
    live: float  # root mean square
    again: float  # root mean square


@dataclass(frozen=True, slots=True)
class Outcome:
    """What came of one combination."""

    point: Point
    measures: tuple[Measure, ...] = ()
    ticks: int = 0
    equal: int = 0  # ticks that were thought bit for bit as they were live
    failed: str = ""  # why there is nothing else

    @property
    def relative(self) -> float:
        """Errors as a share of those live: the geometric mean over all functions; nan without any."""
        logs = [math.log(it.again / it.live) for it in self.measures if it.live > 0 and it.again > 0]
        return math.exp(math.fsum(logs) / len(logs)) if logs else math.nan


Work: TypeAlias = Callable[[Point], Outcome]
"""Thinks one combination through."""

Told: TypeAlias = Callable[[Outcome], None]
"""Hears of an outcome as soon as it is there."""


def points(grid: Mapping[str, Sequence[Value]]) -> list[Point]:
    """All combinations, the last key changing fastest.

    Raises:
        BadRequest: there is nothing to try, or too much.
    """
    count = math.prod(len(values) for values in grid.values())
    if not grid or not 0 < count <= MOST:
        raise BadRequest(f"a sweep tries 1 to {MOST} combinations, not {count if grid else 0}", "set")
    combined = itertools.product(*grid.values())
    return [Point(place, dict(zip(grid, values, strict=True))) for place, values in enumerate(combined)]


def best(outcomes: Sequence[Outcome]) -> Outcome | None:
    """The one with the least relative error, the earlier of equals; None if there are no errors at all."""
    told = [outcome for outcome in outcomes if not math.isnan(outcome.relative)]
    return min(told, key=lambda outcome: outcome.relative, default=None)


def shown(value: Value) -> str:
    """A parameter as it is written on a command line."""
    if isinstance(value, bool):
        return "true" if value else "false"
    return f"[{','.join(map(shown, value))}]" if isinstance(value, list) else str(value)
