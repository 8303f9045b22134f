"""What is known of one servo: its last reading, how old that is, and what it complains of."""

import logging
import math

from bentod.frames import Freshness, JointState, StopReport
from drivers.dynamixel.bus import Reply
from drivers.dynamixel.firmware2 import ALERT, TRIPPED
from drivers.dynamixel.tables import ALARM_SHUTDOWN, HARDWARE_ALERT, WATCHDOG, ServoModel
from drivers.dynamixel.units import Reading, hardware_errors, reading

log = logging.getLogger(__name__)

FASTEST = 10.0
"""rad/s: no servo turns faster; the fastest, an MX-64 at 14.8 V, makes 78 rev/min, which are 8.2."""

SLACK = 0.03
"""rad: what noise of the sensor and of the time stamps may add, about 20 positions of an MX."""


class Condition:
    """Of one servo."""

    def __init__(self, model: ServoModel, who: str, lost_after: float) -> None:
        """`who`: the servo, as the log calls it; `lost_after`: s of silence."""
        self.last = Reading(0.0, 0.0, 0.0, 0.0, 0.0)
        self.errors: tuple[str, ...] = ()
        """In the manual's words."""
        self.shut_down = False
        """It has switched itself off, or takes no goals, until that is cleared."""
        self.alert = False
        """Firmware 2: Hardware Error Status is not 0."""
        self.tripped = False
        """Firmware 2: the BUS Watchdog has stopped it."""
        self.fatal = model.layout.protected
        """The bits of Shutdown."""
        self._model = model
        self._who = who
        self._lost_after = lost_after
        self._hardware = 0
        self._read_at = -math.inf
        self._suspect: tuple[float, float] | None = None

    def heard(self, reply: Reply) -> bool:
        """Take over a reply to the usual window, unless it says what cannot be.

        A position that the servo cannot have reached since its last reading, from noise that the checksum
        let pass or from a glitch of its encoder, is only believed when the next reading agrees with it.
        """
        found = reading(self._model, reply.error, reply.data)
        if found is None or self._jumped(found.position, reply.time):
            return False
        self.last = found
        self._read_at = reply.time
        self.alert = self._model.layout.protocol == 2 and bool(reply.error & ALERT)
        if not self.alert:
            self._hardware = 0
        self._judge()
        return True

    def note_hardware(self, status: int) -> None:
        """Take over the Hardware Error Status."""
        self.alert = status != 0
        self._hardware = status
        self._judge()

    def note_watchdog(self, value: int) -> None:
        """Take over what the BUS Watchdog register holds."""
        self.tripped = value == TRIPPED
        self._judge()

    def age(self, now: float) -> float:
        """Seconds from the last reading to `now` (monotonic s)."""
        return now - self._read_at

    def state(self, now: float, fresh: bool, stop: StopReport | None) -> JointState:
        """The last reading as it looks at `now` (monotonic s)."""
        age = self.age(now)
        silent = Freshness.LOST if age > self._lost_after else Freshness.STALE
        return JointState(
            position=self.last.position,
            velocity=self.last.velocity,
            load=self.last.load,
            voltage=self.last.voltage,
            temperature=self.last.temperature,
            age=age,
            freshness=Freshness.FRESH if fresh else silent,
            errors=self.errors,
            stop=stop,
            shut_down=self.shut_down,
        )

    def _jumped(self, position: float, time: float) -> bool:
        suspect, self._suspect = self._suspect, None
        if _reachable(self.last.position, self._read_at, position, time):
            return False
        if suspect is not None and _reachable(*suspect, position, time):
            return False
        self._suspect = (position, time)
        return True

    def _judge(self) -> None:
        """Bring the complaints up to date; each is logged when it comes and when it goes."""
        errors = self.last.errors
        if self.alert:
            errors += hardware_errors(self._hardware) or (HARDWARE_ALERT,)
        if self.tripped:
            errors += (WATCHDOG,)
        self.shut_down = self.tripped or bool(self._hardware & self.fatal) or ALARM_SHUTDOWN in errors
        if errors != self.errors:
            log.warning("%s reports %s.", self._who, ", ".join(errors) or "no error any more")
        self.errors = errors


def _reachable(position: float, since: float, other: float, now: float) -> bool:
    return abs(other - position) <= FASTEST * (now - since) + SLACK
