"""Joints made of Dynamixel servos in joint mode: a round of reading and a sync write in each tick."""

import asyncio
from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager, closing

from bentod.contracts import ArmConfig, Clock
from bentod.errors import BusError
from bentod.frames import Command, State, Stop
from drivers.dynamixel.audit import check_ids, check_spec
from drivers.dynamixel.bus import Bus
from drivers.dynamixel.codec import Version
from drivers.dynamixel.inquiries import Inquiries
from drivers.dynamixel.options import Options, parse_hardware, parse_options, with_dead_man
from drivers.dynamixel.planner import Planner
from drivers.dynamixel.reconnect import NOBODY, Connect, Connection, audit_all
from drivers.dynamixel.recovery import Recovery
from drivers.dynamixel.servo import Servo
from drivers.dynamixel.torque import switch_off, switch_on
from drivers.dynamixel.units import goal_bytes
from drivers.stream import ByteStream, open_serial

DOUBTFUL = 1.5
"""Periods of silence after which a servo is told to stop, whatever was asked of it."""

BLIND = 4.5
"""Periods of silence after which it is told nothing any more; several stops have been sent by then."""

SHORTEST_BLIND = 0.1
"""s, at fast rates. That an MX takes longer than this to boot is assumed."""


class DynamixelJoints:
    """The `Joints` contract over one bus."""

    def __init__(
        self, line: Connection, servos: Sequence[Servo], options: Options, period: float, clock: Clock
    ) -> None:
        """Servos that passed the audit, in the order of the config; `period`: s between ticks."""
        self._line = line
        self._bus = line.bus
        self._servos = tuple(servos)
        self._options = options
        self._period = period
        self._longest_round = period / 2
        self._blind = max(SHORTEST_BLIND, BLIND * period)
        self._clock = clock
        self._planner = Planner(line.bus, servos, clock)
        self._inquiries = Inquiries(self._servos, self._planner, line.bus, clock, options)
        self._recovery = Recovery(options, clock)
        self._unclear: set[int] = set()

    async def read(self) -> State:
        """As few questions as the bus allows; see `bentod.contracts.Joints.read`."""
        fresh: list[Servo] = [] if self._line.problem else await self._round()
        now = self._clock.now()
        joints = tuple(servo.state(now, servo in fresh) for servo in self._servos)
        return State(now, joints, self._line.problem)

    async def write(self, commands: Sequence[Command | None]) -> None:
        """One sync write a protocol; see `bentod.contracts.Joints.write`.

        A joint whose torque is off, or that is back from silence and was not asked for it yet, is left
        out: on firmware 1 a goal switches torque on by itself. A joint that falls silent is told to stop a
        few times and then nothing more: it could come back from a reset limp, and be armed by that.
        """
        now = self._clock.now()
        goals: dict[tuple[Version, int], dict[int, bytes]] = {}
        for servo, command in zip(self._servos, commands, strict=True):
            if command and self._may_be_told(servo, now):
                heard = servo.age(now) < DOUBTFUL * self._period
                data = goal_bytes(servo.model, servo.goal(command if heard else Stop(), now))
                goals.setdefault(servo.goal_address, {})[servo.id] = data
            elif servo.age(now) >= self._blind:
                servo.motion.lose()
        for (version, address), parts in goals.items():
            self._bus.sync_write(version, address, parts)

    async def set_torque(self, on: Sequence[bool]) -> None:
        """Off before on, each joint even if another failed; see `bentod.contracts.Joints.set_torque`."""
        if self._line.problem:
            raise BusError(self._line.problem)
        wanted = list(zip(self._servos, on, strict=True))
        # A doubt is reason enough to switch off again, but not to pin and switch on what nobody asked about.
        changes = [
            (servo, switch)
            for servo, switch in wanted
            if servo.torque != switch or servo.condition.tripped or (servo.in_doubt and not switch)
        ]
        problems: list[str] = []
        for servo, switch in sorted(changes, key=lambda change: change[1]):
            try:
                await (switch_on(servo, self._options) if switch else switch_off(servo))
            except BusError as error:
                problems.append(str(error))
        if problems:
            raise BusError(" ".join(dict.fromkeys(problems)))

    def torque(self) -> tuple[bool, ...]:
        """As last confirmed."""
        return tuple(servo.torque for servo in self._servos)

    async def clear_errors(self, joints: Sequence[int]) -> tuple[str, ...] | None:
        """See `bentod.contracts.Joints.clear_errors`."""
        if self._line.problem:
            return (self._line.problem,)
        return await self._recovery.clear([self._servos[joint] for joint in joints])

    async def probe(self) -> None:
        """Find out how the servos can be read."""
        await self._planner.probe(self._options.attempts)

    def returned(self) -> None:
        """The line was lost and is back, and every servo passed its audit again."""
        self._planner.restart()
        self._unclear.clear()

    async def _round(self) -> list[Servo]:
        """Who answered."""
        deadline = self._clock.now() + self._longest_round
        self._inquiries.begin()
        replies = await self._planner.read(deadline)
        fresh = [s for s in self._servos if s.id in replies and s.heard(replies[s.id])]
        for servo in self._servos:
            servo.in_doubt = servo.in_doubt or servo not in fresh
        await self._inquiries.ask(fresh, deadline)
        self._unclear = {servo.id for servo in fresh if servo.in_doubt}
        self._look_for_loss()
        return fresh

    def _look_for_loss(self) -> None:
        now = self._clock.now()
        if self._bus.problem:
            self._line.lose(self._bus.problem)
        elif all(servo.age(now) > self._options.lost_after_s for servo in self._servos):
            self._line.lose(NOBODY)

    def _may_be_told(self, servo: Servo, now: float) -> bool:
        known = servo.id not in self._unclear and servo.age(now) < self._blind
        return servo.torque and known and not self._line.problem


@asynccontextmanager
async def open_over(connect: Connect, config: ArmConfig, clock: Clock) -> AsyncIterator[DynamixelJoints]:
    """Joints over the line that `connect` opens. Leaving moves nothing, switches nothing, closes the line.

    Raises:
        ConfigError: the driver's options or a joint's hardware are not valid.
        BusError: there is no line, or a servo is absent or not the one in the config; all of them are named.
    """
    options = with_dead_man(parse_options(config.options), config.period)
    hardware = [parse_hardware(spec) for spec in config.joints]
    for spec, its in zip(config.joints, hardware, strict=True):
        check_spec(spec, its)

    def make_bus(stream: ByteStream) -> Bus:
        return Bus(stream, clock, options.baud, options.reply_margin_s)

    with closing(Connection(connect, make_bus, clock)) as line:
        servos = [
            Servo(line.bus, spec, its, options) for spec, its in zip(config.joints, hardware, strict=True)
        ]
        check_ids(servos)
        await audit_all(line.bus, servos)
        joints = DynamixelJoints(line, servos, options, config.period, clock)
        await joints.probe()
        # Not in a TaskGroup, which would wrap what the body raises and hide a BusError from who opened this.
        keeper = asyncio.create_task(line.keep(servos, joints.returned), name="reconnect")
        try:
            yield joints
        finally:
            keeper.cancel()
            await asyncio.wait((keeper,))


@asynccontextmanager
async def open_joints(config: ArmConfig, clock: Clock) -> AsyncIterator[DynamixelJoints]:
    """Joints on the serial port that the options name.

    Raises:
        ConfigError, BusError: as `open_over`.
    """
    options = parse_options(config.options)
    async with open_over(lambda: open_serial(options.port, options.baud), config, clock) as joints:
        yield joints
