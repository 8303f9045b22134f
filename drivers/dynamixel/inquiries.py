"""What servos are asked besides their windows: their torque when that is in doubt, slow registers in turn."""

import logging
from collections.abc import Sequence

from bentod.contracts import Clock
from drivers.dynamixel.bus import Bus
from drivers.dynamixel.options import Options
from drivers.dynamixel.planner import Planner
from drivers.dynamixel.servo import Servo

log = logging.getLogger(__name__)


class Inquiries:
    """Asked after the windows of a round, while there is time."""

    def __init__(
        self, servos: Sequence[Servo], planner: Planner, bus: Bus, clock: Clock, options: Options
    ) -> None:
        self._servos = servos
        self._planner = planner
        self._bus = bus
        self._clock = clock
        self._dead_man = options.dead_man_s or 0.0
        self._unwatched: set[Servo] = set()
        self._turn = 0

    def begin(self) -> None:
        """A round begins: if the bus was quiet for so long that watchdogs tripped, they are asked."""
        if self._dead_man < self._clock.now() - self._bus.last_sent:
            self._unwatched.update(servo for servo in self._servos if self._watched(servo))

    async def ask(self, fresh: Sequence[Servo], deadline: float) -> None:
        """Of servos just heard: every torque that is in doubt, then one slow register (`deadline`: s).

        One doubt is asked about whether there is time or not, each round another one: a joint in doubt is
        told nothing, not even to stop.
        """
        doubtful = [servo for servo in fresh if servo.in_doubt]
        first = self._turn % len(doubtful) if doubtful else 0
        for place, servo in enumerate(doubtful[first:] + doubtful[:first]):
            if place == 0 or self._in_time(servo, deadline):
                await self._ask_torque(servo)
        self._turn += 1
        slow = [(s, name) for s in fresh for name in self._slow(s)]
        if slow:
            servo, name = slow[self._turn % len(slow)]
            if self._in_time(servo, deadline):
                await self._ask_slow(servo, name)

    def _watched(self, servo: Servo) -> bool:
        return self._dead_man > 0 and servo.torque and "BUS Watchdog" in servo.model.table

    def _slow(self, servo: Servo) -> list[str]:
        names = ["Hardware Error Status"] if servo.condition.alert else []
        return names + (["BUS Watchdog"] if servo in self._unwatched else [])

    async def _ask_torque(self, servo: Servo) -> None:
        """A servo that is back from silence may have been without power; one in alert may have let go.

        A change faults the arm, so it is read twice: the checksum of protocol 1.0 lets some damage pass.
        """
        found = await servo.glance("Torque Enable")
        if found is not None and servo.torque != (found != 0):
            found = found if await servo.glance("Torque Enable") == found else None
        if found is None:
            return
        servo.in_doubt = False
        if self._watched(servo):
            self._unwatched.add(servo)  # who was silent may have heard nothing either, and then has stopped
        if servo.torque != (found != 0):
            servo.torque = found != 0
            log.warning("%s was silent or in alarm; its torque is now %s.", servo, "on" if found else "off")

    async def _ask_slow(self, servo: Servo, name: str) -> None:
        found = await servo.glance(name)
        if found is None:
            return
        if name == "BUS Watchdog":
            self._unwatched.discard(servo)
            servo.condition.note_watchdog(found)
        else:
            servo.condition.note_hardware(found)

    def _in_time(self, servo: Servo, deadline: float) -> bool:
        return self._planner.in_time(servo.model.layout, (servo.id,), deadline)
