"""Stops of simulated servos, seen from outside: the real driver, a simulated line, virtual time."""

import math
from collections.abc import AsyncIterator, Iterator, Sequence
from contextlib import asynccontextmanager
from dataclasses import dataclass, field, replace
from itertools import product
from random import Random

from bentod.contracts import ArmConfig
from bentod.frames import Command, JointSpec, JointState, Stop, Velocity
from drivers.dynamixel.joints import DynamixelJoints, open_over
from sim.arm import SUBSTEP, Arm
from sim.bento import bento_joints, build_arm, build_bus
from sim.clock import VirtualClock, run
from sim.line import Line
from sim.options import bus_options, parse_options

LIMIT = 2.5
"""rad either way: no stop of the sweep is cut short by a limit."""

HANGING = {"MX-64": 1.0, "MX-106": 1.0, "MX-28": 0.3}
"""N m that pull on a joint of this model when gravity is on."""

SPEEDS = (0.25, 0.5, 0.75, 1.0)
"""Shares of a joint's greatest speed."""

MOTIONS: dict[str, tuple[float, ...]] = {
    "steady": (1.0,) * 21,
    "short": (1.0,) * 5,
    "rising": (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0),
    "falling": (1.0,) * 9 + (0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3),
}
"""Shares of the motion's speed, tick by tick at 30 Hz, up to the stop. A muscle rarely asks for a step."""

PAUSE = 0.8
"""s for a joint to come to rest."""


@dataclass(frozen=True, slots=True)
class Condition:
    """One session: what the servos are, and what the driver believes of them."""

    rule: str = "full"
    dead_time: float = 0.017  # s, of the servos
    believed: float = 1.0  # share of the dead time that the driver is told
    gravity: bool = False
    learning: bool = False
    dead_man: float = 0.0  # s, 0: none
    acceleration: float = 0.0  # rad/s²
    rate_hz: float = 30.0
    firmware: int = 1  # of every servo: 2 speaks protocol 2.0
    sessions: int = 1  # how often the motions are made
    jitter: float = 0.0  # s, most by which each order takes effect later
    load_offset: float = 0.0  # share, by which the load is misread
    loss: float = 0.0  # chance that a packet on the line is lost, and as much again that it is broken
    supply: float = 12.0  # V


@dataclass(frozen=True, slots=True)
class Seen:
    """One stop of one joint, as it really was."""

    condition: Condition
    number: int  # of the motion in its session
    motion: str  # as in `MOTIONS`
    joint: str
    speed: float  # rad/s, signed, as commanded
    bounce: float  # rad, from the farthest point back to where it rests
    travel: float  # rad, from where it was when it was told to stop to where it rests
    before: float  # rad, signed, from the start of the motion to where it was when it was told to stop
    reported: float  # rad, the bounce that the driver reports; nan: none


class WatchedArm(Arm):
    """An arm whose every substep is kept."""

    def __init__(self, arm: Arm) -> None:
        super().__init__(arm.servos, arm.time, arm.catch_up)
        self.path: list[tuple[float, ...]] = []  # rad, by substep

    def advance(self, to: float) -> None:
        """As `Arm.advance`."""
        while to - self.time > SUBSTEP * (1 - 1e-6):
            super().advance(self.time + SUBSTEP * 1.001)
            self.path.append(tuple(servo.position for servo in self.servos))


@dataclass(slots=True)
class Bench:
    """The driver over a watched arm."""

    joints: DynamixelJoints
    arm: WatchedArm
    specs: Sequence[JointSpec]
    clock: VirtualClock
    period: float
    jitter: float
    states: tuple[JointState, ...] = ()
    due: float = 0.0
    random: Random = field(default_factory=lambda: Random(1))

    async def tick(self, commands: Sequence[Command]) -> None:
        """Wait for the next tick, read, write."""
        self.due += self.period
        await self.clock.sleep_until(self.due)
        self.states = (await self.joints.read()).joints
        for servo in self.arm.servos if self.jitter else ():
            servo.slowness = self.random.uniform(0.0, self.jitter)
        await self.joints.write(commands)

    async def hold(self, commands: Sequence[Command], seconds: float) -> None:
        """Repeat `commands`, then let the arm catch up."""
        for _ in range(max(round(seconds / self.period), 1)):
            await self.tick(commands)
        self.arm.advance(self.clock.now())


@asynccontextmanager
async def bench(condition: Condition) -> AsyncIterator[Bench]:
    """All joints of the Bento Arm, armed."""
    clock = VirtualClock()
    config = _config(condition)
    options = parse_options(config)
    arm = WatchedArm(build_arm(config, options, clock.now()))
    line = Line(build_bus(arm, config, options), arm, "stop")
    driven = replace(config, options=bus_options(options))
    async with open_over(lambda: line, driven, clock) as joints:
        await joints.read()
        await joints.set_torque([True] * len(config.joints))
        made = Bench(joints, arm, config.joints, clock, config.period, condition.jitter, due=clock.now())
        await made.hold([Stop()] * len(config.joints), 1.0)
        _disturb(arm, condition)
        yield made


def _disturb(arm: Arm, condition: Condition) -> None:
    arm.noise = condition.loss
    for servo in arm.servos:
        servo.load_offset = condition.load_offset
        servo.supply = condition.supply


def session(
    condition: Condition, speeds: Sequence[float] = SPEEDS, motions: Sequence[str] = tuple(MOTIONS)
) -> list[Seen]:
    """Each joint, speed and motion, in both directions, `sessions` times."""
    each = list(product(range(condition.sessions), speeds, motions, (1, -1)))
    return run(_session(condition, each))


async def _session(condition: Condition, each: Sequence[tuple[int, float, str, int]]) -> list[Seen]:
    seen: list[Seen] = []
    async with bench(condition) as arm:
        for number, (_, share, motion, sign) in enumerate(each):
            speeds = [sign * share * spec.max_velocity for spec in arm.specs]
            for part in MOTIONS[motion]:
                await arm.hold([Velocity(speed * part) for speed in speeds], 1 / 30)
            await arm.tick([Stop()] * len(speeds))
            arm.arm.advance(arm.clock.now())
            told = len(arm.arm.path) - 1
            await arm.hold([Stop()] * len(speeds), PAUSE)
            seen += _stops(condition, number, motion, arm, speeds, told)
            del arm.arm.path[:-1]
    return seen


def _stops(
    condition: Condition, number: int, motion: str, arm: Bench, speeds: Sequence[float], told: int
) -> Iterator[Seen]:
    start, path = arm.arm.path[0], arm.arm.path[told:]
    for joint, (spec, speed) in enumerate(zip(arm.specs, speeds, strict=True)):
        forward = math.copysign(1.0, speed)
        way = [forward * (position[joint] - path[0][joint]) for position in path]
        report = arm.states[joint].stop
        yield Seen(
            condition=condition,
            number=number,
            motion=motion,
            joint=spec.name,
            speed=speed,
            bounce=max(way) - way[-1],
            travel=way[-1],
            before=path[0][joint] - start[joint],
            reported=report.bounce if report else math.nan,
        )


def _config(condition: Condition) -> ArmConfig:
    joints = tuple(_joint(spec, condition) for spec in bento_joints())
    gravity = {
        spec.name: HANGING[str(spec.hardware["model"]).removesuffix("(2.0)")] * condition.gravity
        for spec in joints
    }
    return ArmConfig(
        joints,
        1 / condition.rate_hz,
        {
            "gravity_nm": dict(gravity),
            "servo_dead_time_s": condition.dead_time,
            "stop": condition.rule,
            "stop_learning": condition.learning,
            "dead_man_s": condition.dead_man,
        },
    )


def _joint(spec: JointSpec, condition: Condition) -> JointSpec:
    model = str(spec.hardware["model"])
    hardware = {
        **spec.hardware,
        "model": model if condition.firmware == 1 else f"{model}(2.0)",
        "dead_time_s": condition.dead_time * condition.believed,
        "goal_acceleration_rad_s2": condition.acceleration,
    }
    return replace(spec, minimum=-LIMIT, maximum=LIMIT, home=0.0, hardware=hardware)
