"""The loop: read → think → arbitrate → limit → write → publish, once a period, on absolute deadlines."""

import asyncio
import logging
import math
from collections.abc import Callable, Sequence

from bentod.contracts import Clock, Joints
from bentod.control.arbiter import Decision, arbitrate, attended
from bentod.control.limits import limit
from bentod.desk import Desk
from bentod.errors import BusError
from bentod.frames import Command, Costs, Event, Frame, State, Stop, Wishes
from bentod.inbox import Inbox, Seam
from bentod.report import Deed, Stamp, faulted, frame

_log = logging.getLogger(__name__)

Publish = Callable[[Frame, Sequence[Event], bool], None]
"""Where a tick's frame and events go, and whether the tick was whole. Must not wait and must not raise."""

AT_REST = 0.02
"""Rad/s; the least speed that an MX servo reports is 0.012."""


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
    ) -> None:
        self._joints = joints
        self._desk = desk
        self._inbox = inbox
        self._clock = clock
        self._rate_hz = rate_hz
        self._period = 1 / rate_hz
        self._due = 0.0
        self._gap = False
        self._broken = ""
        self._publish = publish
        self._seam = Seam([])
        self._torque = joints.torque()
        self._newest: Frame | None = None
        self._ticks = 0
        self._missed = 0
        self._ending = False

    async def tick(self, due: float, gap: bool) -> None:
        """One tick, due at `due` (monotonic s); `gap`: ticks just before it were missed."""
        lateness = self._clock.now() - due
        desk = self._desk
        await asyncio.sleep(0)  # requests that have been read from the socket get to the seam
        desk.begin(self._clock.now())
        self._seam = self._inbox.take()
        self._seam.serve(desk)

        state = await self._joints.read()
        now = self._clock.now()
        desk.watch(state, now)

        look = desk.muscles.look(now)
        wishes: dict[str, Wishes] = {
            "emg": desk.operator(look.efforts, look.toggles),
            "client": desk.clients.wishes(),
            "home": desk.goals.wishes(),
        }
        desk.mind.predict(state, gap)
        assistance = desk.mind.assist(state, attended(("emg", "client"), wishes, desk.modes))
        wishes["assist"] = assistance.wishes

        decided = arbitrate(wishes, desk.modes, len(desk.specs))

        sent = self._limited(decided, state)

        await self._joints.write(sent)
        await self._clear_errors()
        await self._switch_torque()

        stamp = Stamp(
            self._ticks, due, self._clock.wall(), lateness, self._missed, self._rate_hz, Costs(0, 0, 0, 0), 0
        )
        self._newest = frame(stamp, desk, Deed(state, look, wishes, assistance.frame, decided, sent))
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
            await self._once()
        return self._joints.torque()

    async def _once(self) -> None:
        """Wait for the next deadline that has not passed, and tick."""
        await self._clock.sleep_until(self._due)
        await self._survive(self._due, self._gap)
        self._ticks += 1
        self._due, skipped = next_deadline(self._due, self._period, self._clock.now())
        self._missed += skipped
        self._gap = skipped > 0 or self._broken != ""

    async def _survive(self, due: float, gap: bool) -> None:
        """A tick that breaks is a fault, not the end: joints stop, clients are told, the loop goes on."""
        try:
            await self.tick(due, gap)
            self._broken = ""
        except Exception as error:  # noqa: BLE001 -- whatever broke, the arm must be stopped
            reason = f"internal error in the tick: {type(error).__name__}: {error}"
            if reason != self._broken:
                _log.exception("tick %d broke", self._ticks)
            self._broken = reason
            self._desk.fault(reason)
            self._seam.refuse(reason)
            await self._stop_blindly()

    async def _stop_blindly(self) -> None:
        """Stop every joint and publish the fault, with as little as possible that could break, too."""
        try:
            await self._joints.write([Stop() if on else None for on in self._joints.torque()])
            await self._switch_torque()
            if self._newest:
                self._newest = faulted(self._newest, self._ticks, self._due, self._desk.modes.fault)
                self._publish(self._newest, self._desk.journal.take(), False)
        except Exception:  # noqa: BLE001 -- the next tick tries again
            _log.exception("tick %d could not be stopped cleanly", self._ticks)

    async def _clear_errors(self) -> None:
        """Have servos clear their errors, if that was asked; they may be limp afterwards."""
        if self._desk.to_clear:
            self._desk.errors_cleared(await self._joints.clear_errors(self._desk.to_clear))
            self._torque = self._joints.torque()
            self._desk.torque_confirmed(self._torque)

    async def _switch_torque(self) -> None:
        """The only way to the servos' torque: carry out what `Modes` notes, and report what came of it.

        A servo that lost or gained torque by itself (it was rebooted, its power was cut) is believed, not
        corrected: only a request may arm a joint.
        """
        found = self._joints.torque()
        if found != self._torque:
            self._desk.torque_found(found)
        elif self._desk.modes.wanted_torque != found:
            try:
                await self._joints.set_torque(self._desk.modes.wanted_torque)
            except BusError as error:
                self._desk.torque_failed(str(error))
            self._desk.torque_confirmed(self._joints.torque())
        self._torque = self._joints.torque()

    def _limited(self, decided: Sequence[Decision], state: State) -> list[Command | None]:
        """What is sent: within limits, and nothing that moves a joint whose reading is too old."""
        old = self._desk.rules.ladder.too_old_to_move(state)
        commands = [
            Stop() if joint in old and decision.command else decision.command
            for joint, decision in enumerate(decided)
        ]
        return list(map(limit, commands, self._desk.specs, state.joints))

    def _moves(self) -> bool:
        state = self._desk.state
        return state is not None and any(abs(joint.velocity) > AT_REST for joint in state.joints)


def next_deadline(due: float, period: float, now: float) -> tuple[float, int]:
    """The next deadline that has not passed (s), and how many had to be skipped to get there."""
    skipped = max(0, math.ceil((now - due) / period - 1e-9) - 1)
    return due + (skipped + 1) * period, skipped
