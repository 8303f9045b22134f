"""A line that does to every reply whatever a line can do must never make the driver believe a wrong value."""

import random
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager
from dataclasses import dataclass, replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bentod.contracts import ArmConfig
from bentod.frames import Command, Freshness, State, Stop, Velocity
from drivers.dynamixel.joints import DynamixelJoints, open_over
from sim import clock as simulated
from sim.arm import Arm
from sim.bento import bento_joints, build_arm, build_bus
from sim.clock import VirtualClock
from sim.line import Line
from sim.options import bus_options, parse_options

PERIOD = 1 / 30
JOINTS = bento_joints()
MOVING = (0, 2, 3, 4)
SPEED = 0.78
"""rad/s: in one period a joint goes three times as far as the tolerance."""

FIRMWARE_1 = ("MX-64", "MX-106", "MX-28", "MX-28", "MX-28")
FIRMWARE_2 = ("MX-64(2.0)", "MX-106(2.0)", "MX-28(2.0)", "MX-28(2.0)", "MX-28(2.0)")
MIXED = ("MX-64(2.0)", "MX-106", "MX-28(2.0)", "AX-12A", "MX-28")


@dataclass(frozen=True)
class Mischief:
    """Chances (0..1) that a reply suffers this."""

    damage: float = 0.0  # one byte is another
    lose: float = 0.0  # a byte is missing
    insert: float = 0.0  # a byte too many
    cut: float = 0.0  # the end is missing
    late: float = 0.0  # it comes up to two periods later
    twice: float = 0.0  # it comes again, up to two periods later
    echo: bool = False
    seed: int = 0


class Liar(Line):
    """A line that is up to mischief once `mischief` is set."""

    mischief: Mischief | None = None
    dice = random.Random(0)

    def _return(self, at: float, reply: bytes) -> None:
        if self.mischief is None:
            super()._return(at, reply)
            return
        for delay, data in self._spoiled(self.mischief, reply):
            self._send(at + self.latency + delay, data)

    def _spoiled(self, chance: Mischief, reply: bytes) -> Iterator[tuple[float, bytes]]:
        data = bytearray(reply)
        place = self.dice.randrange(len(data))
        if self._falls(chance.damage):
            data[place] ^= self.dice.randrange(1, 256)
        if self._falls(chance.lose):
            del data[place]
        if self._falls(chance.insert):
            data.insert(place, self.dice.randrange(256))
        if self._falls(chance.cut):
            del data[place:]
        delay = self.dice.uniform(0, 2 * PERIOD) if self._falls(chance.late) else 0.0
        yield delay, bytes(data)
        if self._falls(chance.twice):
            yield delay + self.dice.uniform(0, 0.001), bytes(data)

    def _falls(self, chance: float) -> bool:
        return self.dice.random() < chance


@asynccontextmanager
async def over_a_liar(models: tuple[str, ...]) -> AsyncIterator[tuple[DynamixelJoints, Arm, Liar]]:
    clock = VirtualClock()
    joints = tuple(
        replace(spec, hardware={**spec.hardware, "model": model})
        for spec, model in zip(JOINTS, models, strict=True)
    )
    config = ArmConfig(joints, PERIOD, {})
    options = parse_options(config)
    arm = build_arm(config, options, clock.now())
    line = Liar(build_bus(arm, config, options), arm)
    driven = replace(config, options=bus_options(options))
    async with open_over(lambda: line, driven, clock) as opened:
        yield opened, arm, line


async def story(models: tuple[str, ...], mischief: Mischief) -> tuple[int, int]:
    """A second in the life of an arm; returns how many readings were fresh, and how many there were."""
    clock = VirtualClock()
    fresh = total = 0
    async with over_a_liar(models) as (joints, arm, line):
        await joints.set_torque([True] * 5)
        for tick in range(-8, 30):
            if tick == 0:
                line.mischief, line.echo, line.dice = mischief, mischief.echo, random.Random(mischief.seed)
            began = clock.now()
            state = await joints.read()
            arm.advance(state.time)
            if tick >= 0:
                total += len(MOVING)
                fresh += sum(is_fresh_and_true(state, arm, joint) for joint in MOVING)
            sign = 1 if tick < 15 else -1
            commands: list[Command] = [Velocity(sign * SPEED) if i in MOVING else Stop() for i in range(5)]
            await joints.write(commands)
            await clock.sleep_until(began + PERIOD)
    return fresh, total


def is_fresh_and_true(state: State, arm: Arm, joint: int) -> bool:
    """Whether the joint was read in this round; then it is where the reading says, but for its age."""
    seen = state.joints[joint]
    if seen.freshness is not Freshness.FRESH:
        return False
    assert abs(seen.position - arm.servos[joint].position) < 0.0105 + SPEED * seen.age
    return True


CHANCE = st.sampled_from([0.0, 0.0, 0.05, 0.3])
ANY = st.builds(
    Mischief,
    damage=CHANCE, lose=CHANCE, insert=CHANCE, cut=CHANCE, late=CHANCE, twice=CHANCE,
    echo=st.booleans(), seed=st.integers(0, 2**32),
)  # fmt: skip


@pytest.mark.parametrize("models", [FIRMWARE_1, FIRMWARE_2, MIXED], ids=["1.0", "2.0", "mixed"])
@given(mischief=ANY)
@settings(max_examples=10, deadline=None)
def test_no_line_makes_a_wrong_position_fresh(models: tuple[str, ...], mischief: Mischief) -> None:
    simulated.run(story(models, mischief))


@pytest.mark.parametrize("models", [FIRMWARE_1, FIRMWARE_2, MIXED], ids=["1.0", "2.0", "mixed"])
def test_a_line_that_damages_every_tenth_reply_leaves_most_readings_fresh(models: tuple[str, ...]) -> None:
    fresh, total = simulated.run(story(models, Mischief(damage=0.1)))
    assert fresh > 0.8 * total


def test_a_quiet_line_leaves_every_reading_fresh() -> None:
    fresh, total = simulated.run(story(MIXED, Mischief(echo=True)))
    assert fresh == total
