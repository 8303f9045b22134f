"""The loop: read → think → arbitrate → limit → write → publish, once a period, on absolute deadlines."""

import asyncio
import logging
import math
from collections.abc import Awaitable, Callable, Sequence
from typing import TypeVar

from bentod.contracts import Clock, Joints
from bentod.control.arbiter import OPERATORS, Decision, arbitrate, attended
from bentod.control.recency import HELD_UP
from bentod.desk import Desk
from bentod.errors import BentodError, BusError
from bentod.frames import Command, Event, Frame, State, Stop, Wishes
from bentod.hands import operate
from bentod.inbox import Inbox, Seam
from bentod.pace import Pace
from bentod.realtime import Upkeep
from bentod.report import Deed, Stamp, faulted, frame

_log = logging.getLogger(__name__)

T = TypeVar("T")

Publish = Callable[[Frame, Sequence[Event], bool], None]
"""Where a tick's frame and events go, and whether the tick was whole. Must not wait and must not raise."""

LONGEST = 3
"""Periods that count as passed at most when velocities change: a tick that comes late is no run-up."""

AT_REST = 0.02
"""Rad/s; the least speed that an MX servo reports is 0.012."""

ANSWER = 0.5
"""s that a driver has for a round of reading or for a write. All of ours take less than a period."""

SWITCH = 1.0
"""s that it has to switch torque or to clear errors: each servo is asked a dozen things, one by one."""

LETTING_GO = 3
"""Ticks in which the arm is made limp at the end: one servo may have missed the first."""

QUIET = 60.0
"""s between two tracebacks in the log of errors of one type."""


def never_slept() -> float:
    """Seconds in which the machine was suspended, where nobody counts them."""
    return 0.0


class Controller:
    """Owns the bus and the tick. Only pure functions and the desk stand between `read` and `write`."""

    def __init__(
        self,
        joints: Joints,
        desk: Desk,
        inbox: Inbox,
        clock: Clock,
        rate_hz: float,
        publish: Publish,
        upkeep: Upkeep | None = None,
        slept: Callable[[], float] = never_slept,
    ) -> None:
        """`slept`: s that the machine has been suspended so far, which `clock` does not count."""
        self._joints = joints
        self._desk = desk
        self._inbox = inbox
        self._clock = clock
        self._rate_hz = rate_hz
        self._period = 1 / rate_hz
        self._due = 0.0
        self._gap = False
        self._broken = False
        self._quiet_until: dict[str, float] = {}
        self._slept = slept
        self._slept_before = slept()
        self._publish = publish
        upkeep = upkeep or Upkeep()
        self._collector = upkeep.collector
        self._gate = upkeep.gate
        self.chores: list[Callable[[float], None]] = []
        """What is done in the time that is left after each tick, given the next deadline (monotonic s)."""
        self._pace = Pace(clock, self._period, desk.mind.budget, upkeep.lookout)
        self._seam = Seam([])
        self._torque = joints.torque()
        self._newest: Frame | None = None
        self._ticks = 0
        self._missed = 0
        self._ending = False

    async def tick(self, due: float, gap: bool) -> None:
        """One tick, due at `due` (monotonic s); `gap`: ticks just before it were missed."""
        desk, pace = self._desk, self._pace
        pace.begin(due)
        await asyncio.sleep(0)  # requests that have been read from the socket get to the seam
        desk.begin(self._clock.now())
        self._notice_sleep()
        self._seam = self._inbox.take()
        self._seam.serve(desk)

        pace.enter("read")
        state = await _answered("reading", self._joints.read(), ANSWER)
        pace.enter("think")
        now = self._clock.now()
        desk.watch(state, now)
        look = desk.muscles.look(now)
        wishes: dict[str, Wishes] = {
            **operate(desk, look, now),
            "client": desk.clients.wishes(),
            "home": desk.goals.wishes(),
        }
        percept = desk.percept(self._ticks, due, gap, state, look.frame)
        desk.mind.predict(percept, pace.has_time)
        assistance = desk.mind.assist(percept, attended((*OPERATORS, "client"), wishes, desk.modes))
        wishes["assist"] = assistance.wishes
        decided = arbitrate(wishes, desk.modes, len(desk.specs))
        sent = self._limited(decided, state)

        pace.enter("write")
        await _answered("writing", self._joints.write(sent), ANSWER)
        await self._clear_errors()
        await self._switch_torque()
        pace.enter("think")
        desk.learn(pace.has_time)

        pace.enter("publish")
        deed = Deed(percept, look, wishes, assistance.frames, decided, sent)
        self._newest = frame(self._stamp(due, gap), desk, deed)
        self._publish(self._newest, desk.journal.take(), True)
        self._seam.answer(self._newest)

    async def run(self, ticks: int = 0) -> None:
        """Tick until `end` is called, or `ticks` times. A tick that is missed is counted, not made up for."""
        last = self._ticks + ticks
        self._due = self._clock.now() + self._period
        while not self._ending and (ticks == 0 or self._ticks < last):
            await self._once()

    def end(self) -> None:
        """Let the tick under way finish, and `run` return."""
        self._ending = True

    async def settle(self, limp: bool, patience: float = 1.0) -> tuple[bool, ...]:
        """Bring the arm to its end: stop, give it up to `patience` (s) to come to rest, let go if `limp`.

        Returns the torque that each joint is known to be left with. Nothing cuts this short.
        """
        self._desk.stop("the end of the daemon")
        self._due = max(self._due, self._clock.now())
        await self._once()  # one tick to write the stop, one to read what it did
        await self._once()
        deadline = self._clock.now() + patience
        while self._moves() and self._clock.now() < deadline:
            await self._once()
        if limp:
            self._desk.torque(range(len(self._desk.specs)), False)
            await self._let_go()
        return self._joints.torque()

    async def _let_go(self) -> None:
        for _ in range(LETTING_GO):
            await self._once()
            if not any(self._joints.torque()):
                return

    async def _once(self) -> None:
        """Wait for the next deadline that has not passed, and tick."""
        await self._clock.sleep_until(self._due)
        with self._gate.shut():
            await self._survive(self._due, self._gap)
        self._ticks += 1
        self._due, skipped = next_deadline(self._due, self._period, self._clock.now())
        self._missed += skipped
        self._gap = skipped > 0 or self._broken
        late = self._pace.end(self._due, skipped)
        if late:
            self._desk.journal.note("late", late.text, late.data)
        for chore in self.chores:
            chore(self._due)
        self._collector.collect(self._due)

    def _stamp(self, due: float, gap: bool) -> Stamp:
        pace, wall = self._pace, self._clock.wall()
        shed = self._desk.mind.shed
        return Stamp(
            self._ticks, due, wall, pace.lateness, self._missed, self._rate_hz, pace.costs, shed, gap
        )

    def _notice_sleep(self) -> None:
        """Whoever wakes from a suspend knows nothing of the arm: it is stopped, and requests may be old."""
        slept, before = self._slept(), self._slept_before
        self._slept_before = slept
        if slept - before > HELD_UP:
            self._desk.woke(slept - before)

    async def _survive(self, due: float, gap: bool) -> None:
        """A tick that breaks is a fault, not the end: joints stop, clients are told, the loop goes on."""
        try:
            await self.tick(due, gap)
            self._broken = False
        except Exception as error:  # noqa: BLE001 -- whatever broke, the arm must be stopped
            self._broken = True
            self._report(error, "broke")
            reason = _reason(error)
            self._desk.to_clear = ()
            self._desk.fault(reason)
            self._seam.refuse(reason)
            await self._stop_blindly()

    async def _stop_blindly(self) -> None:
        """Stop every joint, switch what is to lose torque, tell: each of it although the others break."""
        for step in (self._write_stops, self._switch_torque, self._tell_fault):
            try:
                await step()
            except Exception as error:  # noqa: BLE001 -- the next tick tries again
                self._report(error, "could not be ended cleanly")

    async def _write_stops(self) -> None:
        stops = [Stop() if on else None for on in self._joints.torque()]
        await _answered("writing", self._joints.write(stops), ANSWER)

    async def _tell_fault(self) -> None:
        if self._newest:
            self._newest = faulted(self._newest, self._ticks, self._due, self._desk.modes.fault)
            self._publish(self._newest, self._desk.journal.take(), False)

    def _report(self, error: Exception, what: str) -> None:
        """Log a traceback, but not thirty times a second."""
        kind, now = type(error).__name__, self._clock.now()
        if now >= self._quiet_until.get(kind, -math.inf):
            self._quiet_until[kind] = now + QUIET
            _log.error("tick %d %s", self._ticks, what, exc_info=error)

    async def _clear_errors(self) -> None:
        """Have servos clear their errors, if that was asked; they may be limp afterwards."""
        desk = self._desk
        joints, desk.to_clear = desk.to_clear, ()
        if joints:
            needs = await _answered("clearing errors", self._joints.clear_errors(joints), SWITCH)
            if needs is None:
                desk.to_clear = joints
            else:
                desk.errors_cleared(needs)
            self._torque = self._joints.torque()
            desk.torque_confirmed(self._torque)

    async def _switch_torque(self) -> None:
        """The only way to the servos' torque: carry out what `Modes` notes, and report what came of it.

        A servo that lost or gained torque by itself (it was rebooted, its power was cut) is believed, not
        corrected: only a request may arm a joint. What is to lose torque is told so until that is confirmed.
        """
        desk, found = self._desk, self._joints.torque()
        if found != self._torque:
            desk.torque_found(found)
            self._torque = found
        if desk.modes.wanted_torque == found:
            return
        try:
            switch = self._joints.set_torque(desk.modes.wanted_torque)
            await _answered("switching torque", switch, SWITCH)
        except BusError as error:
            desk.torque_failed(str(error))
        finally:
            self._torque = self._joints.torque()
            desk.torque_confirmed(self._torque)

    def _limited(self, decided: Sequence[Decision], state: State) -> list[Command | None]:
        """What is sent: within limits, and nothing that moves a joint whose reading is too old."""
        return self._desk.limiter.limit(decided, state, LONGEST * self._period)

    def _moves(self) -> bool:
        state = self._desk.state
        return state is not None and any(abs(joint.velocity) > AT_REST for joint in state.joints)


async def _answered(what: str, call: Awaitable[T], patience: float) -> T:
    """What the driver answers. Raises BusError: it took longer than `patience` (s) and was given up."""
    try:
        async with asyncio.timeout(patience) as bound:
            return await call
    except TimeoutError as error:
        if not bound.expired():
            raise
        raise BusError(f"the driver does not answer: {what} took longer than {patience:g} s") from error


def _reason(error: Exception) -> str:
    """A fault's, for an error that broke a tick."""
    if isinstance(error, BentodError):
        return str(error)
    return f"internal error in the tick: {type(error).__name__}: {error}"


def next_deadline(due: float, period: float, now: float) -> tuple[float, int]:
    """The next deadline that has not passed (s), and how many had to be skipped to get there."""
    skipped = max(0, math.ceil((now - due) / period - 1e-9) - 1)
    return due + (skipped + 1) * period, skipped
