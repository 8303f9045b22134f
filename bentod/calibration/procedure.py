"""Moves one joint to and fro in small steps and records what it does; the others are not touched."""

import asyncio
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from bentod.calibration.estimate import Record
from bentod.contracts import Clock, Joints
from bentod.errors import BusError, Refused
from bentod.frames import Command, Freshness, JointSpec, JointState, Position, Stop

DURATION = 0.12
"""s that the way of one step takes, if the joint may be so fast."""

SHRINK = 0.07
"""Each pair of steps is shorter than the last by this share, so that positions are rounded differently."""

STAGGER = 0.0004
"""s by which reading starts later in each step than in the last, so that readings lie denser."""

PACE = 0.002
"""s from one reading to the next at least."""

LEAD, STILL, SLOWEST_START, PATIENCE = 0.03, 0.15, 0.3, 3.0
"""s of readings before a step; of rest after it; before which a joint at rest may still start; in all."""

GENTLE = 0.2
"""rad/s: on the way to where the steps begin."""

TICK = 0.002
"""rad: a joint whose position changes no more than this is at rest."""

MARGIN = math.radians(1)
"""rad that steps keep from the limits."""

RUNAWAY = 1.6
"""Steps from where it began at which a joint is stopped."""

Say = Callable[[str], None]


@dataclass(frozen=True, slots=True)
class Plan:
    """What to do."""

    joint: int
    step: float  # rad, above 0
    pairs: int  # steps to and fro
    period: float  # s between two orders
    lost_after: float  # s of silence that end the calibration
    limp_after: bool  # whether the joint is limp after a calibration, or one that was interrupted
    limp_after_fault: bool  # the same after a failure


@dataclass(frozen=True, slots=True)
class _Sample:
    time: float  # monotonic s, when it was asked for
    state: JointState


async def record_steps(joints: Joints, spec: JointSpec, plan: Plan, clock: Clock, say: Say) -> list[Record]:
    """Steps to and fro, all of them within the joint's limits.

    The joint is stopped at the end and left as the plan says, whatever happens. `say` is told how it goes.

    Raises:
        BusError: the joint fell silent, complained, moved too far or did not come to rest.
        Refused: there is no room for a step where it stands.
    """
    stepper = _Stepper(joints, spec, plan, clock)
    limp = plan.limp_after
    try:
        return await stepper.run(say)
    except (BusError, Refused):
        limp = plan.limp_after_fault
        raise
    finally:
        # Ctrl-C cancels, and twice if it is pressed twice; the joint is stopped all the same.
        await asyncio.shield(stepper.leave(limp, say))


class _Stepper:
    """One joint of an arm, as a calibration sees and moves it."""

    def __init__(self, joints: Joints, spec: JointSpec, plan: Plan, clock: Clock) -> None:
        self._joints = joints
        self._spec = spec
        self._plan = plan
        self._clock = clock
        self._home = 0.0
        self._free = math.inf
        """rad: how far it may be from home."""

    async def run(self, say: Say) -> list[Record]:
        step = self._plan.step
        found = (await self._sample()).state.position
        self._home, side = self._room(found)
        await self._switch(True)
        self._free = RUNAWAY * step + abs(found - self._home)
        await self._move(self._home, GENTLE, 0.0)
        self._free = RUNAWAY * step
        records: list[Record] = []
        for pair in range(self._plan.pairs):
            length = side * step * (1 - SHRINK * pair)
            records.append(await self._record(self._home + length, length, 2 * pair))
            records.append(await self._record(self._home, -length, 2 * pair + 1))
            say(f"{pair + 1} of {self._plan.pairs} steps to and fro")
        return records

    async def leave(self, limp: bool, say: Say) -> None:
        """Stop the joint, wait until it rests, and make it limp if asked; what fails is said."""
        try:
            await self._order(Stop())
            await self._rest(self._clock.now(), [])
            if limp:
                await self._switch(False)
        except BusError as error:
            say(f"The joint was told to stop; {error}")
            if limp:
                await self._try_limp(say)

    async def _try_limp(self, say: Say) -> None:
        try:
            await self._switch(False)
        except BusError as error:
            say(str(error))

    def _room(self, position: float) -> tuple[float, int]:
        """Where the steps begin (rad), and to which side they go."""
        low, high = self._spec.minimum + MARGIN, self._spec.maximum - MARGIN
        home = min(max(position, low), high)
        room = max(high - home, home - low)
        if room < self._plan.step:
            raise Refused(
                f"Joint {self._spec.name} has {math.degrees(room):.1f} degrees of room at "
                f"{math.degrees(position):.1f} degrees, less than a step of "
                f"{math.degrees(self._plan.step):.1f}; take smaller steps."
            )
        return home, 1 if high - home >= home - low else -1

    async def _switch(self, on: bool) -> None:
        """Torque of this joint alone; the driver pins it before."""
        wanted = list(self._joints.torque())
        wanted[self._plan.joint] = on
        await self._joints.set_torque(wanted)

    async def _record(self, goal: float, length: float, number: int) -> Record:
        speed = min(self._plan.step / DURATION, self._spec.max_velocity)
        start, samples = await self._move(goal, speed, STAGGER * number)
        states = [sample.state for sample in samples]
        return Record(
            times=np.array([sample.time - start for sample in samples]),
            positions=np.array([state.position for state in states]),
            velocities=np.array([state.velocity for state in states]),
            loads=np.array([state.load for state in states]),
            distance=length,
            speed=speed,
        )

    async def _move(self, goal: float, speed: float, delay: float) -> tuple[float, list[_Sample]]:
        """When the joint was told to go, and what was read from shortly before until it rested."""
        samples: list[_Sample] = []
        begin = self._clock.now()
        while self._clock.now() - begin < LEAD:
            await self._look(samples)
        start = self._clock.now()
        order = Position(goal, speed)
        await self._order(order)
        await self._clock.sleep_until(start + delay)
        await self._rest(start, samples, order)
        return start, samples

    async def _rest(self, start: float, samples: list[_Sample], order: Command | None = None) -> None:
        """Read until the joint has come to rest; the order is repeated, as in every tick of the daemon."""
        ordered = start
        while not _at_rest(samples, start):
            now = self._clock.now()
            if now - start > PATIENCE:
                raise BusError(f"Joint {self._spec.name} does not come to rest within {PATIENCE:g} s.")
            if order is not None and now - ordered >= self._plan.period:
                await self._order(order)
                ordered = now
            await self._look(samples)

    async def _look(self, samples: list[_Sample]) -> None:
        """One more reading, if there was an answer."""
        sample = await self._sample()
        if sample.state.freshness is Freshness.FRESH:
            samples.append(sample)
        await self._clock.sleep_until(sample.time + PACE)

    async def _sample(self) -> _Sample:
        # The moment when the question goes out counts, not that when the answer is there: a command takes
        # the same way out, so that way drops from the difference between the two, and the servo's is left.
        asked = self._clock.now()
        state = await self._joints.read()
        joint = state.joints[self._plan.joint]
        name = f"Joint {self._spec.name}"
        if joint.freshness is Freshness.LOST or joint.age > self._plan.lost_after:
            raise BusError(state.problem or f"{name} has not answered for {joint.age:.2f} s.")
        if joint.errors:
            raise BusError(f"{name} reports {', '.join(joint.errors)}.")
        away = abs(joint.position - self._home)
        if away > self._free:
            raise BusError(
                f"{name} is {math.degrees(away):.1f} degrees from where its steps began, which is more than "
                f"{math.degrees(self._free):.1f}."
            )
        return _Sample(asked, joint)

    async def _order(self, command: Command) -> None:
        commands: list[Command | None] = [None] * len(self._joints.torque())
        commands[self._plan.joint] = command
        await self._joints.write(commands)


def _at_rest(samples: Sequence[_Sample], start: float) -> bool:
    """Whether the last readings show no motion, and one that is late can no longer be about to begin."""
    if not samples or samples[-1].time - start < SLOWEST_START + DURATION:
        return False
    last = [s.state.position for s in samples if s.time >= samples[-1].time - STILL]
    return max(last) - min(last) <= TICK
