"""Everything that breaks around a simulated arm in motion: how long and how far it moved on, and its bound.

The table of the README is made of the same numbers (`make faults`). Then half an hour of random faults of the
bus and half an hour of random faults of the muscles, each on one arm, in virtual time.
"""

from collections.abc import Iterable, Iterator

from sim.clock import run
from tests.benchmarks.harness import Row, at_least, at_most, main
from tests.system.campaign.__main__ import REAL_SLACK, real, virtual
from tests.system.campaign.hour import endure
from tests.system.campaign.outcome import Outcome

HALF_AN_HOUR = 1800.0
"""s"""


def rows() -> Iterator[Row]:
    """Two numbers a fault, and whether all else that is promised of it holds; then the hour."""
    yield from _faults(real(), REAL_SLACK)
    yield from _faults(virtual(), 0.0)
    for name, by_muscles in (("bus", False), ("muscles", True)):
        yield from _hour(name, by_muscles)


def _faults(outcomes: Iterable[Outcome], slack: float) -> Iterator[Row]:
    for seen in outcomes:
        name = f"{seen.fault} ({seen.asker})"
        yield at_most(
            f"{name}: moved on for", seen.moved.seconds * 1e3, "ms", (seen.bound.seconds + slack) * 1e3
        )
        yield at_most(f"{name}: moved on by", seen.moved.degrees, "deg", seen.bound.degrees)
        yield at_most(f"{name}: promises broken", len(seen.broken(slack)), "", 0)


def _hour(name: str, by_muscles: bool) -> Iterator[Row]:
    tally = run(endure(by_muscles, HALF_AN_HOUR, seed=1))
    what = f"half an hour of faults of the {name}"
    yield at_least(f"{what}: virtual time", tally.seconds, "s", HALF_AN_HOUR)
    yield Row(f"{what}: faults", tally.faults, "")
    yield at_most(f"{what}: missed ticks", tally.missed, "", 0)
    yield at_most(f"{what}: ticks that broke", tally.errors, "", 0)
    yield at_most(f"{what}: promises broken", len(tally.broken), "", 0)


if __name__ == "__main__":
    main("faults", rows())
