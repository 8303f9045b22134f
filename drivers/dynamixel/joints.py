"""Joints made of Dynamixel MX servos in joint mode: one bulk read and one sync write a tick."""

import logging
from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager, closing

from bentod.contracts import ArmConfig, Clock
from bentod.errors import BusError
from bentod.frames import Command, State
from drivers.dynamixel.audit import audit, check_ids, check_spec
from drivers.dynamixel.bus import Bus
from drivers.dynamixel.options import Options, parse_hardware, parse_options
from drivers.dynamixel.rounds import Roll
from drivers.dynamixel.servo import Servo
from drivers.dynamixel.tables import MX_28
from drivers.dynamixel.torque import switch_off, switch_on
from drivers.dynamixel.units import WINDOW, WINDOW_SIZE, goal_bytes
from drivers.stream import ByteStream, open_serial

log = logging.getLogger(__name__)

GOAL = MX_28["Goal Position"].address
"""Goal Position and Moving Speed are neighbours and are written as one; the same in every model."""

TORQUE = MX_28["Torque Enable"]

MOST_QUESTIONS = 4
"""Bulk reads in one round: one when all is well."""

BLIND_S = 0.1
"""s of silence after which a servo is not written to any more. How long an MX takes to boot is assumed."""


class DynamixelJoints:
    """The `Joints` contract over one bus."""

    def __init__(
        self, bus: Bus, servos: Sequence[Servo], options: Options, period: float, clock: Clock
    ) -> None:
        """Servos that passed the audit, in the order of the config; `period`: s between ticks."""
        self._bus = bus
        self._servos = tuple(servos)
        self._by_id = {servo.id: servo for servo in servos}
        self._options = options
        self._longest_round = period / 2
        self._clock = clock
        self._roll = Roll(list(self._by_id), clock.now())
        self._unclear: set[int] = set()

    async def read(self) -> State:
        """One bulk read of all who answer; see `bentod.contracts.Joints.read`."""
        fresh: set[int] = set()
        if not self._bus.problem:
            deadline = self._clock.now() + self._longest_round
            await self._read_windows(fresh, deadline)
            await self._resolve_doubt(fresh, deadline)
        now = self._clock.now()
        joints = tuple(servo.state(now, servo.id in fresh) for servo in self._servos)
        return State(now, joints, self._bus.problem)

    async def write(self, commands: Sequence[Command | None]) -> None:
        """One sync write; see `bentod.contracts.Joints.write`.

        A joint whose torque is off, or that is back from silence and was not asked for it yet, is left
        out: on firmware 1 a goal switches torque on by itself. A joint that falls silent is still told
        to stop, but not for longer than a reset takes: it could come back limp, and be armed by that.
        """
        now = self._clock.now()
        goals = {
            servo.id: goal_bytes(servo.goal(command, now))
            for servo, command in zip(self._servos, commands, strict=True)
            if command and servo.torque and servo.id not in self._unclear and servo.age(now) < BLIND_S
        }
        if goals:
            self._bus.sync_write(GOAL, goals)

    async def set_torque(self, on: Sequence[bool]) -> None:
        """Off before on, each joint even if another failed; see `bentod.contracts.Joints.set_torque`."""
        wanted = list(zip(self._servos, on, strict=True))
        changes = [(servo, switch) for servo, switch in wanted if servo.torque != switch or servo.in_doubt]
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

    async def _read_windows(self, fresh: set[int], deadline: float) -> None:
        self._roll.begin(self._clock.now())
        for question in range(MOST_QUESTIONS):
            chain = self._roll.chain()
            if not chain or (question > 0 and not self._in_time(chain, deadline)):
                break
            replies = await self._bus.read(chain, WINDOW.start, WINDOW_SIZE)
            self._roll.note(chain, replies, self._clock.now())
            for id_, reply in replies.items():
                self._by_id[id_].heard(reply)
                fresh.add(id_)
        for servo in self._servos:
            servo.in_doubt = servo.in_doubt or servo.id not in fresh

    async def _resolve_doubt(self, fresh: set[int], deadline: float) -> None:
        """Ask who is back from silence for its torque: it may have been without power meanwhile."""
        for servo in self._servos:
            if servo.in_doubt and servo.id in fresh and self._in_time([servo.id], deadline):
                replies = await self._bus.read((servo.id,), TORQUE.address, TORQUE.size)
                if servo.id in replies:
                    self._note_torque(servo, replies[servo.id].data != b"\x00")
        self._unclear = {servo.id for servo in self._servos if servo.in_doubt and servo.id in fresh}

    def _note_torque(self, servo: Servo, on: bool) -> None:
        servo.in_doubt = False
        if servo.torque != on:
            servo.torque = on
            log.warning("%s was silent and came back with its torque %s.", servo, "on" if on else "off")

    def _in_time(self, ids: Sequence[int], deadline: float) -> bool:
        return self._clock.now() + self._bus.longest_read(ids, WINDOW_SIZE) <= deadline


@asynccontextmanager
async def open_over(stream: ByteStream, config: ArmConfig, clock: Clock) -> AsyncIterator[DynamixelJoints]:
    """Joints over a line that the caller owns and closes. Leaving moves nothing and switches nothing.

    Raises:
        ConfigError: the driver's options or a joint's hardware are not valid.
        BusError: a servo is absent or not the one in the config; all of them are named.
    """
    options = parse_options(config.options)
    bus = Bus(stream, clock, options.baud, options.reply_margin_s)
    for spec in config.joints:
        check_spec(spec)
    servos = [Servo(bus, spec, parse_hardware(spec), options) for spec in config.joints]
    check_ids(servos)
    await _audit_all(bus, servos)
    yield DynamixelJoints(bus, servos, options, config.period, clock)


@asynccontextmanager
async def open_joints(config: ArmConfig, clock: Clock) -> AsyncIterator[DynamixelJoints]:
    """Joints on the serial port that the options name.

    Raises:
        ConfigError, BusError: as `open_over`; also when the port cannot be opened.
    """
    options = parse_options(config.options)
    with closing(open_serial(options.port, options.baud)) as stream:
        async with open_over(stream, config, clock) as joints:
            yield joints


async def _audit_all(bus: Bus, servos: Sequence[Servo]) -> None:
    problems: list[str] = []
    for servo in servos:
        try:
            bus.set_return_delay(servo.id, await audit(servo))
        except BusError as error:
            problems.append(str(error))
    if problems:
        raise BusError(" ".join(dict.fromkeys(problems)))
