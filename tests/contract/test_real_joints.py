"""What every arm must do that can be asked of a real one: small, slow and in real time.

By default the arm is simulated, in another process behind a pseudo-terminal. To try a real one: power it, put
it where each joint can move 3 degrees both ways, keep the power switch at hand, and give its port, and the
config that describes it, in the environment:

    export BENTOD_TEST_PORT=/dev/ttyUSB0 BENTOD_TEST_CONFIG=config/bento.toml
    python -m pytest tests/contract/test_real_joints.py -p no:randomly
"""

import asyncio
import os
from collections.abc import AsyncIterator, Iterator
from dataclasses import replace
from math import radians
from pathlib import Path

import pytest

from bentod.contracts import ArmConfig, Joints
from bentod.frames import Command, Freshness, Position, State, Stop, Value, Velocity
from drivers.dynamixel.joints import open_joints
from sim import bus_config
from sim.clock import VirtualClock
from tests.system.bus_processes import running

pytestmark = pytest.mark.real_time

SLOW = 0.1
STEP = radians(2)
REAL = os.environ.get("BENTOD_TEST_PORT")
CONFIG = os.environ.get("BENTOD_TEST_CONFIG")
PERIOD = 1 / 30 if REAL else 0.1
PATIENT = {"reply_margin_s": 0.03, "attempts": 10}
"""Two processes on a busy machine are slower than any servo."""
MOTION_S = 0.7 if REAL else 0.5
"""s for a step, which takes 0.35: a real servo may be slow to start."""
FRESH = 0.95 if REAL else 0.6
"""Share of readings: a servo answers, a process that simulates one may not be let run for a while."""


@pytest.fixture(scope="module")
def port() -> Iterator[str]:
    """Of the real arm, if there is one."""
    if REAL:
        yield REAL
        return
    with running(*(("--config", CONFIG) if CONFIG else ())) as process:
        yield process.port


@pytest.fixture
async def joints(port: str) -> AsyncIterator[Joints]:
    found = bus_config.load(Path(CONFIG) if CONFIG else None, None)
    known = {key: value for key, value in found.options.items() if key in ("baud", "reply_margin_s")}
    options: dict[str, Value] = {**known, **({} if REAL else PATIENT), "port": port}
    config: ArmConfig = replace(found, period=PERIOD, options=options)
    async with open_joints(config, VirtualClock()) as opened:
        try:
            yield opened
        finally:
            await opened.set_torque([False] * len(config.joints))


async def run(joints: Joints, commands: list[Command | None], seconds: float) -> list[State]:
    """Tick for a while."""
    states = []
    for _ in range(round(seconds / PERIOD)):
        states.append(await joints.read())
        await joints.write(commands)
        await asyncio.sleep(PERIOD)
    return states


async def held(joints: Joints) -> tuple[list[Command | None], list[float]]:
    """Switch everything on; the commands that hold it, and where it is."""
    start = [joint.position for joint in (await joints.read()).joints]
    await joints.set_torque([True] * len(start))
    return [Stop() for _ in start], start


async def test_every_joint_answers_nearly_every_time(joints: Joints) -> None:
    states = await run(joints, [None] * len(joints.torque()), 2.0)
    fresh = [joint.freshness is Freshness.FRESH for state in states for joint in state.joints]
    assert sum(fresh) > FRESH * len(fresh)


async def test_an_arm_is_in_order(joints: Joints) -> None:
    for joint in (await joints.read()).joints:
        assert joint.errors == ()
        assert 9.0 < joint.voltage < 16.0
        assert joint.temperature < 65.0


async def test_torque_on_pins_every_joint_where_it_is(joints: Joints) -> None:
    commands, _ = await held(joints)
    states = await run(joints, commands, 1.0)
    assert all(joints.torque())
    first, last = ([joint.position for joint in state.joints] for state in (states[0], states[-1]))
    assert last == pytest.approx(first, abs=radians(2))


async def test_a_joint_moves_a_little_and_comes_back(joints: Joints) -> None:
    commands, _ = await held(joints)
    start = [joint.position for joint in (await run(joints, commands, 0.5))[-1].joints]
    for joint, home in enumerate(start):
        for target in (home + STEP, home):
            commands[joint] = Position(target, SLOW)
            state = (await run(joints, commands, MOTION_S))[-1]
            assert state.joints[joint].position == pytest.approx(target, abs=radians(1.5))
        commands[joint] = Stop()


async def test_a_velocity_is_followed_and_a_stop_ends_it(joints: Joints) -> None:
    commands, _ = await held(joints)
    joint = len(commands) - 1
    for velocity in (SLOW, -SLOW):
        commands[joint] = Velocity(velocity)
        moved = [state.joints[joint].position for state in await run(joints, commands, 0.4)]
        assert (moved[-1] - moved[0]) * velocity > 0
        commands[joint] = Stop()
        rest = [state.joints[joint].position for state in await run(joints, commands, 0.8)]
        assert max(rest[len(rest) // 2 :]) - min(rest[len(rest) // 2 :]) < radians(0.3)
