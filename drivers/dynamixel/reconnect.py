"""Bringing a lost bus back: open the port again, and believe it only when the same servos are on it.

Torque is taken as it is found and never asked for here: whether the arm may hold again is for a person.
"""

import asyncio
import logging
from collections.abc import Callable, Sequence
from typing import TypeAlias

from bentod.contracts import Clock
from bentod.errors import BusError
from drivers.dynamixel.audit import audit
from drivers.dynamixel.bus import Bus
from drivers.dynamixel.servo import Servo
from drivers.stream import ByteStream

log = logging.getLogger(__name__)

Connect: TypeAlias = Callable[[], ByteStream]
"""Opens the line, once at first and again whenever it was lost; raises BusError when there is none."""

FIRST_PAUSE, LONGEST_PAUSE = 0.1, 1.0
"""s between two attempts; doubled after each, so that a port that is gone for long costs nothing."""

NOBODY = "No servo answers any more; check the power of the arm."


class Connection:
    """A bus and the line that it uses at present; nobody else may use the bus while there is a `problem`."""

    def __init__(self, connect: Connect, make_bus: Callable[[ByteStream], Bus], clock: Clock) -> None:
        """Open the line.

        Raises:
            BusError: it cannot be opened.
        """
        self._connect = connect
        self._clock = clock
        self._stream = connect()
        self._lost = asyncio.Event()
        self.bus = make_bus(self._stream)
        self.problem = ""
        """Why no servo can be reached, and what is being done; empty while all is well."""

    def close(self) -> None:
        """Give the line back."""
        self._stream.close()

    def lose(self, reason: str) -> None:
        """Begin to reconnect, if that has not begun; `reason`: a sentence."""
        if not self.problem:
            self.problem = f"{reason} Reconnecting."
            log.warning("%s", self.problem)
            self._lost.set()

    async def keep(self, servos: Sequence[Servo], on_return: Callable[[], None]) -> None:
        """Reconnect whenever the bus is lost, for ever; `on_return` is the last step of it."""
        while True:
            await self._lost.wait()
            self._lost.clear()
            await self._reconnect(servos)
            on_return()
            self.problem = ""
            log.warning("The servos are back, with torque %s.", _torque(servos))

    async def _reconnect(self, servos: Sequence[Servo]) -> None:
        pause = FIRST_PAUSE
        while reason := await self._attempt(servos):
            self.problem = f"{reason} Reconnecting."
            await self._clock.sleep_until(self._clock.now() + pause)
            pause = min(2 * pause, LONGEST_PAUSE)

    async def _attempt(self, servos: Sequence[Servo]) -> str:
        """Why it failed; empty when it did not."""
        self._stream.close()
        try:
            self._stream = self._connect()
            self.bus.attach(self._stream)
            await audit_all(self.bus, servos)
        except BusError as error:
            return str(error)
        return ""


async def audit_all(bus: Bus, servos: Sequence[Servo]) -> None:
    """Find and check every servo.

    Raises:
        BusError: at least one is absent or not as it should be; all of those are named.
    """
    problems: list[str] = []
    for servo in servos:
        try:
            bus.set_return_delay(servo.id, await audit(servo))
        except BusError as error:
            problems.append(str(error))
    if problems:
        raise BusError(" ".join(dict.fromkeys(problems)))


def _torque(servos: Sequence[Servo]) -> str:
    on = [servo.spec.name for servo in servos if servo.torque]
    return f"on: {', '.join(on)}" if on else "off"
