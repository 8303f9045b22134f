"""A visit to a bus: look for servos, read them, measure them, and mend what can be mended safely."""

from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import dataclass, field

from bentod.contracts import Clock
from bentod.errors import BusError
from drivers.dynamixel.bus import Bus
from drivers.dynamixel.codec import Version
from drivers.dynamixel.doctor.findings import (
    Finding,
    Repair,
    judge,
    judge_bauds,
    judge_pace,
    judge_timer,
    judge_twins,
)
from drivers.dynamixel.doctor.pace import Pace, answers, questions, round_trips, rounds
from drivers.dynamixel.doctor.repair import mend
from drivers.dynamixel.doctor.vitals import Vitals, examine
from drivers.dynamixel.doctor.wanted import Wanted, compare
from drivers.dynamixel.latency_timer import BEST, LatencyTimer
from drivers.stream import ByteStream

SCAN_MARGIN = 0.003
"""s to wait for the reply to a ping, beyond its time on the wire and the adapter's latency timer."""

GUESSES = (BEST, 16)
"""ms: latency timers of adapters that do not say, tried until somebody is found; 16 is the usual default."""

PATIENT_MARGIN = 0.03
"""s beyond it when times are measured: a late reply is then slow, and not lost."""

PROTOCOLS: tuple[Version, ...] = (1, 2)

Say = Callable[[str], None]

Open = Callable[[int], ByteStream]
"""The port at a rate (bit/s). Raises BusError: it cannot be opened so."""


@dataclass(frozen=True, slots=True)
class Plan:
    """What to look for."""

    bauds: tuple[int, ...]  # bit/s
    ids: tuple[int, ...]
    wanted: tuple[Wanted, ...] | None = None  # None: there is no config to compare with
    rate_hz: float = 30.0
    fix: bool = False


@dataclass(slots=True)
class Report:
    """What was found."""

    servos: list[Vitals] = field(default_factory=list)
    timer: int | None = None  # ms, the adapter's latency timer while the port is open
    reads: dict[int, Pace] = field(default_factory=dict)  # by id
    rounds: dict[int, Pace] = field(default_factory=dict)  # by rate, bit/s
    findings: list[Finding] = field(default_factory=list)
    mended: list[str] = field(default_factory=list)  # sentences

    @property
    def healthy(self) -> bool:
        """Whether nothing is left to mend."""
        return all(finding.note for finding in self.findings)


class Visit:
    """One port."""

    def __init__(
        self, open_port: Open, timer: LatencyTimer, clock: Clock, say: Callable[[str], None]
    ) -> None:
        """`say` is told how it goes."""
        self._open = open_port
        self._timer = timer
        self._clock = clock
        self._say = say
        self._uneven: list[Finding] = []

    async def run(self, plan: Plan) -> Report:
        """Look at everything.

        Raises:
            BusError: the port cannot be opened at any of the rates.
        """
        report = Report()
        for timer in GUESSES:
            await self._everywhere(plan, timer, report)
            if report.servos or report.timer is not None:
                break
        report.findings = [
            *judge_timer(report.timer),
            *judge_bauds(report.servos),
            *judge_twins(report.servos),
            *self._uneven,
            *(one for baud, pace in report.rounds.items() for one in judge_pace(baud, pace, plan.rate_hz)),
            *(finding for servo in report.servos for finding in judge(servo)),
            *(compare(plan.wanted, report.servos) if plan.wanted is not None else ()),
        ]
        return report

    async def _everywhere(self, plan: Plan, timer: int, report: Report) -> None:
        refused: list[str] = []
        for baud in plan.bauds:
            try:
                await self._at(baud, plan, timer, report)
            except BusError as error:
                refused.append(str(error))
        if len(refused) == len(plan.bauds):
            raise BusError(" ".join(dict.fromkeys(refused)))

    async def _at(self, baud: int, plan: Plan, timer: int, report: Report) -> None:
        """Everything at one rate; `timer`: ms, of adapters that do not say."""
        with closing(self._open(baud)) as stream:
            report.timer = self._set_timer(plan, report)
            margin = SCAN_MARGIN + (report.timer or timer) / 1000
            found = await self._scan(Bus(stream, self._clock, baud, margin), baud, plan)
            bus = Bus(stream, self._clock, baud, PATIENT_MARGIN)
            here = [await examine(bus, id_, protocol, baud) for id_, protocol in found]
            if plan.fix:
                here = [await self._mend(bus, servo, report) for servo in here]
            for servo in here:
                delay = servo.value("Return Delay Time")
                bus.set_return_delay(servo.id, 0.0 if delay is None else delay)
            report.servos += here
            await self._measure(bus, baud, here, report)
            if bus.problem:
                raise BusError(bus.problem)

    def _set_timer(self, plan: Plan, report: Report) -> int | None:
        found = self._timer.read()
        if plan.fix and found is not None and found > BEST and self._timer.set_best():
            report.mended.append(
                f"The adapter's latency timer was {found} ms and is {BEST} ms, until it is unplugged."
            )
        return self._timer.read()

    async def _scan(self, bus: Bus, baud: int, plan: Plan) -> list[tuple[int, Version]]:
        """Each id once, and those of the config again if need be."""
        ids = (*plan.ids, *(one.hardware.id for one in plan.wanted or ()))
        found: list[tuple[int, Version]] = []
        for protocol in PROTOCOLS:
            self._say(f"{baud} bit/s, protocol {protocol}.0: asking {len(plan.ids)} IDs")
            for id_ in ids:
                if (id_, protocol) not in found and await bus.ping(protocol, id_) is not None:
                    found.append((id_, protocol))
        return sorted(found, key=lambda place: (place[1], place[0]))

    async def _mend(self, bus: Bus, servo: Vitals, report: Report) -> Vitals:
        repairs = [finding.repair for finding in judge(servo) if finding.repair is not None]
        if not repairs:
            return servo
        for repair in repairs:
            report.mended.append(await self._apply(bus, servo, repair))
        return await examine(bus, servo.id, servo.protocol, servo.baud)

    async def _apply(self, bus: Bus, servo: Vitals, repair: Repair) -> str:
        try:
            await mend(bus, servo, repair)
        except BusError as error:
            return str(error)
        return f"{servo}: {repair.register} is {repair.value} now."

    async def _measure(self, bus: Bus, baud: int, servos: Sequence[Vitals], report: Report) -> None:
        known = [servo for servo in servos if servo.model is not None]
        if not known:
            return
        self._say(f"{baud} bit/s: measuring {len(known)} servos")
        for servo in known:
            report.reads[servo.id] = await round_trips(bus, servo, self._clock)
        asked = questions(known)
        if not await answers(bus, asked):
            asked = questions(known, together=False)
            self._uneven.append(
                Finding(
                    f"At {baud} bit/s the servos do not all answer when they are asked together.",
                    "They work one by one, which takes longer; look at the firmware of those that fail.",
                )
            )
        report.rounds[baud] = await rounds(bus, known, asked, self._clock)
