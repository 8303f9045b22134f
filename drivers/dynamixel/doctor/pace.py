"""How fast a bus is: round-trip times, and rounds that read every servo and write as many goals."""

import statistics
from collections.abc import Awaitable, Callable, Sequence
from dataclasses import dataclass

from bentod.contracts import Clock
from drivers.dynamixel.bus import Bus
from drivers.dynamixel.codec import Version
from drivers.dynamixel.doctor.vitals import Vitals
from drivers.dynamixel.tables import ServoModel, Window

READS, ROUNDS = 50, 200
"""How many are measured, at most."""

LONGEST = 3.0
"""s that rounds are measured at most."""

RATES = (30, 100, 200)
"""Hz: of the Bento Arm's own software, of a brisk arm, and the most that this driver is meant for."""

NOBODY = range(252, 0, -1)
"""Ids in the order in which those that nobody has are looked for."""

READ_ONLY = {1: ("Present Position", 4), 2: ("Present Velocity", 8)}
"""By protocol: a register that no write can change, and the bytes that a goal and a speed have."""


@dataclass(frozen=True, slots=True)
class Pace:
    """Times (s) of one kind of exchange."""

    median: float
    p99: float
    count: int
    lost: int  # exchanges in which an answer was missing

    @property
    def rate(self) -> float:
        """Exchanges a second."""
        return 1 / self.median if self.median > 0 else float("inf")


@dataclass(frozen=True, slots=True)
class Question:
    """Servos that are asked by one instruction."""

    protocol: Version
    window: Window
    ids: tuple[int, ...]


def questions(servos: Sequence[Vitals], together: bool = True) -> list[Question]:
    """How a round asks them all: by one instruction a protocol, except AX servos, or each by itself."""
    asked: dict[tuple[Version, int], Question] = {}
    for servo in servos:
        model = servo.model
        if model is not None:
            key = (servo.protocol, -1 if together and model.grouped else servo.id)
            ids = asked[key].ids if key in asked else ()
            asked[key] = Question(servo.protocol, model.layout.windows[0], (*ids, servo.id))
    return list(asked.values())


async def round_trips(bus: Bus, servo: Vitals, clock: Clock, count: int = READS) -> Pace:
    """Of reading the usual window of one servo."""
    return await _measure(clock, count, lambda: _ask(bus, questions([servo])))


async def rounds(bus: Bus, servos: Sequence[Vitals], asked: Sequence[Question], clock: Clock) -> Pace:
    """Of writing goals to as many servos as there are, and reading them all.

    What is written is addressed to ids that nobody has, at an address that cannot be written: it takes the
    time on the wire, and moves nothing even if somebody has the id after all.
    """
    absent = [id_ for id_ in NOBODY if id_ not in {servo.id for servo in servos}]

    async def one() -> bool:
        for version, model in _models(servos).items():
            register, size = READ_ONLY[version]
            there = sum(servo.protocol == version for servo in servos)
            nothing = dict.fromkeys(absent[:there], bytes(size))
            bus.sync_write(version, model.table[register].address, nothing)
        return await _ask(bus, asked)

    return await _measure(clock, ROUNDS, one)


async def answers(bus: Bus, asked: Sequence[Question], attempts: int = 3) -> bool:
    """Whether everybody answers in one round of `attempts`."""
    for _ in range(attempts):
        if await _ask(bus, asked):
            return True
        await bus.settle()
    return False


async def _ask(bus: Bus, asked: Sequence[Question]) -> bool:
    complete = True
    for question in asked:
        window = question.window
        replies = await bus.read(question.protocol, question.ids, window.address, window.size)
        complete = complete and len(replies) == len(question.ids)
    return complete


async def _measure(clock: Clock, count: int, exchange: Callable[[], Awaitable[bool]]) -> Pace:
    times: list[float] = []
    lost = 0
    begin = clock.now()
    while len(times) < count and (not times or clock.now() - begin < LONGEST):
        start = clock.now()
        lost += not await exchange()
        times.append(clock.now() - start)
    return Pace(statistics.median(times), sorted(times)[int(0.99 * (len(times) - 1))], len(times), lost)


def _models(servos: Sequence[Vitals]) -> dict[Version, ServoModel]:
    """A model of each protocol that is there."""
    return {servo.protocol: servo.model for servo in servos if servo.model is not None}
