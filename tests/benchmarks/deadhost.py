"""A daemon that dies in mid-motion: how long and how far the joints go on.

Simulated kills: the driver is never called again, the servos go on, and their shafts are looked at every
millisecond. Real kills: SIGKILL to a daemon, the servo read from outside through the same port. No servo of
either was a real one.
"""

import asyncio
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from random import Random

from bentod.frames import Command, Position, Velocity
from bentod.lateness.histogram import percentile
from sim.clock import run
from tests.benchmarks.harness import Row, at_least, at_most, main
from tests.benchmarks.rigs.kill9 import kills
from tests.benchmarks.rigs.stops import Bench, Condition, bench

KILLS = 100

REAL_KILLS = 6

DEAD_MAN = 0.3
"""s, the default at 30 Hz."""

DEAD_TIME = 0.019
"""s, at most, of a simulated servo that is not told otherwise."""

AT_REST = 0.02
"""rad/s, as the daemon sees it (`bentod.tick`)."""

WATCHED = 3.0
"""s after the kill."""


@dataclass(frozen=True, slots=True)
class Death:
    """What one joint did after its daemon was gone."""

    seconds: float  # from the kill until it was at rest for good
    travel: float  # rad, its farthest way from where it was at the kill
    allowed: float  # s


def deaths(dead_man: float, firmware: int) -> Iterator[Death]:
    """The daemon of `KILLS` arms, killed at random moments of random motions; each joint that moved."""
    random = Random(f"{firmware}")
    for _ in range(KILLS):
        condition = Condition(
            dead_time=random.uniform(0.005, 0.05),
            gravity=random.random() < 0.5,
            dead_man=dead_man,
            firmware=firmware,
            learning=True,
        )
        yield from run(_kill(condition, random))


async def _kill(condition: Condition, random: Random) -> list[Death]:
    async with bench(condition) as arm:
        commands = [_motion(spec.max_velocity, random) for spec in arm.specs]
        await arm.hold(commands, random.uniform(0.15, 0.8))
        await asyncio.sleep(random.uniform(0.0, arm.period))  # the last thing that this daemon does
        return _aftermath(arm, condition)


def _motion(speed: float, random: Random) -> Command:
    chosen = speed * random.uniform(0.3, 1.0)
    sign = random.choice((-1, 1))
    return Velocity(sign * chosen) if random.random() < 0.5 else Position(sign * 1.5, chosen)


def _aftermath(arm: Bench, condition: Condition) -> list[Death]:
    now = arm.clock.now()
    arm.arm.advance(now)
    killed = len(arm.arm.path) - 1
    arm.arm.advance(now + WATCHED)
    found = []
    for joint, servo in enumerate(arm.arm.servos):
        path = [position[joint] for position in arm.arm.path[killed:]]
        moving = [at for at in range(1, len(path)) if abs(path[at] - path[at - 1]) > AT_REST * 1e-3]
        allowed = condition.dead_man + servo.dead_time
        found.append(Death(max(moving, default=0) * 1e-3, max(abs(p - path[0]) for p in path), allowed))
    return found


def rows() -> Iterator[Row]:
    """100 kills of five joints each, of either firmware, then without a dead-man, then for real."""
    for firmware in (1, 2):
        found = list(deaths(DEAD_MAN, firmware))
        late = sum(death.seconds > death.allowed for death in found)
        name = f"firmware {firmware}, {len(found)} joints"
        yield at_most(f"{name}: not at rest in time", late, "joints", 0)
        yield from numbers(name, found)
    yield from numbers("without a dead-man, firmware 1", list(deaths(0.0, 1)))
    real = list(kills(REAL_KILLS))
    met = sum(kill.speed > 0 for kill in real)
    yield at_least("kill -9: killed in motion", met, f"of {REAL_KILLS}", REAL_KILLS)
    yield at_most("kill -9: until rest, longest", max(k.seconds for k in real), "s", DEAD_MAN + DEAD_TIME)
    yield Row("kill -9: way, longest", max(k.ticks for k in real) * 360 / 4096, "deg")


def numbers(name: str, found: Sequence[Death]) -> Iterator[Row]:
    """How long and how far."""
    spare = min(death.allowed - death.seconds for death in found)
    yield Row(f"{name}: until rest, median", percentile([death.seconds for death in found], 0.5), "s")
    yield Row(f"{name}: until rest, longest", max(death.seconds for death in found), "s")
    yield Row(f"{name}: time to spare, least", spare, "s")
    yield Row(f"{name}: way, median", math.degrees(percentile([d.travel for d in found], 0.5)), "deg")
    yield Row(f"{name}: way, longest", math.degrees(max(death.travel for death in found)), "deg")


if __name__ == "__main__":
    main("deadhost", rows())
