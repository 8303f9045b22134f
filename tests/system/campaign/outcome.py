"""What is promised when something breaks, and what was seen."""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

TICK = 1 / 30
"""s"""

ROUND = TICK / 2
"""s that a round on the bus may take before it is given up."""

DEAD_TIME = 0.019
"""s, at most, from an order to its effect in a simulated servo."""

RESTING = 0.25
"""s from the moment when an order to stop takes effect until the worst damped joint is at rest: `full` lets
it glide, and then it swings."""

DEAD_MAN = 0.3
"""s that an order reaches ahead at 30 Hz."""

LEASE = 0.2
"""s of a `move` that does not say."""

BRAKING = 4.0
"""Degrees from an order to stop, when it takes effect, to the farthest point: what the joint lags behind, and
its swing."""

OR = "; or "
"""Between what it took to move again, when that differed."""

HEAD = "| fault | moved by | moved on | bound | what is said | moves again |\n|---|---|---|---|---|---|"

SHORT = 60
"""Characters of what is said that stand in the table."""

CALM = 1.0
"""Degrees that a joint may stir of which nobody asks anything."""


@dataclass(frozen=True, slots=True)
class Bound:
    """How long and how far a joint may move on."""

    seconds: float
    why: str
    speed: float = 0.7  # rad/s, at most, that was asked for
    runs: float | None = None  # s at that speed, if not all the time until the joint begins to come to rest

    @property
    def degrees(self) -> float:
        """At full speed until the order to stop takes effect, then the way of braking."""
        runs = self.seconds - RESTING if self.runs is None else self.runs
        return math.degrees(self.speed) * runs + BRAKING


ANSWER = TICK + ROUND + DEAD_TIME + RESTING
"""s from anything that a tick can see until the joints that it stops are at rest."""


@dataclass(frozen=True, slots=True)
class Moved:
    """What the servos did after a moment, by their shafts."""

    degrees: float  # the farthest that any of the joints came from where it was at the moment
    seconds: float  # from the moment until the last of them was at rest for good


@dataclass(frozen=True, slots=True)
class Outcome:
    """One fault, once or the worst of several times."""

    fault: str
    asker: str  # who moved the arm
    bound: Bound
    moved: Moved
    strayed: float  # degrees that joints moved of which nobody asked anything, before, during and after
    went_on: bool  # whether what was asked was done while that should have been possible
    told: str  # what the daemon said of it
    recovery: str  # what it took to move again
    must_tell: str = ""  # a pattern, to be found in what was told
    may_take: tuple[str, ...] = ()  # what it may take to move again

    def broken(self, slack: float = 0.0) -> list[str]:
        """Which promises were broken, as sentences; `slack`: s that a busy machine may add to times."""
        moved, bound = self.moved, self.bound
        seconds, degrees = bound.seconds + slack, bound.degrees + math.degrees(bound.speed) * slack
        kept = {
            f"moved on for {moved.seconds:.3f} s, bound {seconds:.3f} s": moved.seconds <= seconds,
            f"moved on by {moved.degrees:.1f}°, bound {degrees:.1f}°": moved.degrees <= degrees,
            f"a joint came {self.strayed:.1f}° away unasked, bound {CALM:g}°": self.strayed <= CALM,
            "did not do what was asked, though it could have": self.went_on,
            f"said '{self.told}', nothing of '{self.must_tell}'": re.search(self.must_tell, self.told),
            f"moved again only by: {self.recovery}": {*self.recovery.split(OR)} <= {*self.may_take},
        }
        return [f"{self.fault}: {text}" for text, holds in kept.items() if not holds]


def worst(outcomes: Sequence[Outcome]) -> Outcome:
    """Several times the same fault as one row: the farthest, the longest, the first words."""
    first = outcomes[0]
    return Outcome(
        first.fault,
        first.asker,
        first.bound,
        Moved(max(o.moved.degrees for o in outcomes), max(o.moved.seconds for o in outcomes)),
        max(o.strayed for o in outcomes),
        all(o.went_on for o in outcomes),
        first.told,
        OR.join(dict.fromkeys(o.recovery for o in outcomes)),
        first.must_tell,
        first.may_take,
    )


def grouped(outcomes: Sequence[Outcome]) -> list[Outcome]:
    """Faults that share who moved the arm, the bound and what it took to move again, as one."""
    groups: dict[tuple[str, Bound, str], list[Outcome]] = {}
    for seen in outcomes:
        groups.setdefault((seen.asker, seen.bound, seen.recovery), []).append(seen)
    return [
        replace(worst(group), fault="; ".join(seen.fault for seen in group), told=_longest(group))
        for group in groups.values()
    ]


def _longest(group: Sequence[Outcome]) -> str:
    """What is said that says most."""
    return max((seen.told for seen in group), key=len)


def table(outcomes: Sequence[Outcome]) -> str:
    """Markdown, one row a fault."""
    return "\n".join([HEAD, *map(row, outcomes)])


def row(outcome: Outcome) -> str:
    """One fault as a row of that table."""
    moved, bound = outcome.moved, outcome.bound
    return (
        f"| {outcome.fault} | {outcome.asker} | {moved.seconds * 1e3:.0f} ms, {moved.degrees:.1f}° "
        f"| {bound.seconds * 1e3:.0f} ms, {bound.degrees:.0f}°: {bound.why} "
        f"| {_short(outcome.told)} | {outcome.recovery} |"
    )


def _short(told: str) -> str:
    """The first words, as many as fit into a table, without the time and place that stand in a log."""
    said = re.sub(r"^[-0-9 :.]+ [A-Z]+ +[\w.]+: ", "", told)
    return said if len(said) <= SHORT else f"{said[:SHORT].rsplit(' ', 1)[0]} …"
