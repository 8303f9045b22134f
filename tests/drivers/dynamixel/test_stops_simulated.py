"""The rules, the correction and the dead-man on simulated servos, byte for byte."""

import math
from dataclasses import replace

import pytest

from bentod.frames import Velocity
from drivers.dynamixel.stopping import StopRule
from sim.clock import run
from tests.benchmarks.deadhost import AT_REST
from tests.benchmarks.rigs.stops import Condition, Seen, bench, session


def stops(rule: StopRule, dead_man: float = 0.0) -> list[Seen]:
    condition = Condition(rule=rule, dead_time=0.05, gravity=True, dead_man=dead_man)
    return session(condition, (1.0,), ("steady", "short"))


def worst(seen: list[Seen]) -> float:
    return math.degrees(max(stop.bounce for stop in seen))


def far(one: list[Seen], other: list[Seen]) -> float:
    """The greatest difference of travel, degrees: 25 ms are 1.5 degrees at 62 degrees/s."""
    return math.degrees(max(abs(a.travel - b.travel) for a, b in zip(one, other, strict=True)))


def test_the_rules_are_as_good_as_they_are_said_to_be() -> None:
    full, creep = worst(stops("full")), worst(stops("creep"))
    thesis, last = worst(stops("thesis")), worst(stops("last_position"))
    assert full < 0.7
    assert creep < 0.7
    assert 5 * full < thesis < last
    assert 8 * full < last


@pytest.mark.parametrize("believed", [0.5, 1.5])
def test_a_wrong_dead_time_is_corrected_by_the_motions_themselves(believed: float) -> None:
    exact = Condition(dead_time=0.05, gravity=True)
    wrong = replace(exact, believed=believed)
    last = 10  # the last stop of each joint in each direction
    goal = session(exact, (1.0,), ("steady",))[-last:]
    first = session(wrong, (1.0,), ("steady",))[-last:]
    learned = session(replace(wrong, learning=True, sessions=3), (1.0,), ("steady",))[-last:]
    assert far(first, goal) > 0.7
    assert far(learned, goal) < 0.3


def test_a_stop_reports_its_travel_and_its_bounce() -> None:
    seen = stops("thesis")
    assert all(stop.reported == pytest.approx(stop.bounce, abs=math.radians(0.4)) for stop in seen)


def test_the_dead_man_costs_neither_way_nor_stop() -> None:
    free, bounded = stops("full"), stops("full", dead_man=0.3)
    for one, other in zip(free, bounded, strict=True):
        assert other.before == pytest.approx(one.before, abs=1e-3)
        assert other.bounce == pytest.approx(one.bounce, abs=1e-3)


def test_a_joint_without_orders_comes_to_rest_in_the_dead_mans_time() -> None:
    async def die() -> list[float]:
        async with bench(Condition(dead_time=0.05, gravity=True, dead_man=0.3)) as arm:
            await arm.hold([Velocity(spec.max_velocity) for spec in arm.specs], 0.5)
            arm.arm.advance(arm.clock.now() + 0.3 + 0.052)
            return [abs(servo.velocity) for servo in arm.arm.servos]

    assert max(run(die())) < AT_REST
