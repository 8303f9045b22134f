"""The servos of one arm, advanced together through time, and everything that can be broken about them."""

from collections.abc import Callable, Mapping, Sequence
from typing import TypeAlias

from bentod.errors import BadRequest
from sim.servo import Servo

SUBSTEP = 0.001
"""s"""

HOT = 90.0
"""Degrees Celsius around an overheated servo, above every model's limit."""

FLAT = 5.5
"""V of a supply that is too low for every model."""

SLOW = 0.033
"""s of dead time that a slow servo has in addition."""

GONE = "The simulated cable is pulled."


def _silent(servo: Servo, on: bool) -> None:
    servo.silent = on


def _stuck(servo: Servo, on: bool) -> None:
    servo.stuck = on


def _blocked(servo: Servo, on: bool) -> None:
    servo.block(on)


def _reboot(servo: Servo, on: bool) -> None:
    if on:
        servo.reboot()


def _overload(servo: Servo, on: bool) -> None:
    if on:
        servo.trip("overload")
    else:
        servo.restore()


def _overheat(servo: Servo, on: bool) -> None:
    servo.ambient = servo.temperature = HOT if on else servo.room
    if on:
        servo.trip("overheat")
    else:
        servo.restore()


def _low_voltage(servo: Servo, on: bool) -> None:
    servo.supply = FLAT if on else 12.0


def _encoder_glitch(servo: Servo, on: bool) -> None:
    servo.glitch_rate = 0.05 if on else 0.0


def _load_offset(servo: Servo, on: bool) -> None:
    servo.load_offset = 0.2 if on else 0.0


def _slow(servo: Servo, on: bool) -> None:
    servo.slowness = SLOW if on else 0.0


SERVO_FAULTS: Mapping[str, Callable[[Servo, bool], None]] = {
    "silent": _silent,
    "stuck": _stuck,
    "blocked": _blocked,
    "reboot": _reboot,
    "overload": _overload,
    "overheat": _overheat,
    "low_voltage": _low_voltage,
    "encoder_glitch": _encoder_glitch,
    "load_offset": _load_offset,
    "slow": _slow,
}
"""Faults of one servo; without a joint they befall every servo. A blocked one can only go back."""

ARM_FAULTS = ("cable", "power", "noise")
"""Faults of the whole arm: the port is gone, the supply is off, bytes are lost and flipped."""

Inject: TypeAlias = Callable[[int, bool], None]
"""Switches one fault on or off, for the joint of that index; raises BadRequest if it cannot have it."""


class Arm:
    """Servos that share a clock, a cable and a supply; what it does depends on its seed and inputs only."""

    def __init__(self, servos: Sequence[Servo], time: float = 0.0, catch_up: float = 60.0) -> None:
        self.servos = tuple(servos)
        self.time = time
        self.catch_up = catch_up
        """Most s simulated in one call; what is beyond passes without motion."""
        self.plugged = True
        self.noise = 0.0
        """Chance that a packet on the line is lost, and as much again that a byte of it flips."""
        self.latency = 0.0
        """s by which every reply on the line is late."""
        self._watchers: list[Callable[[bool], None]] = []
        self._offered: dict[str, Inject] = {}

    def advance(self, to: float) -> None:
        """Simulate in substeps of 1 ms until the next one would pass `to` (monotonic s)."""
        steps = int((to - self.time) / SUBSTEP + 1e-6)
        if steps <= 0:
            return
        self.time += steps * SUBSTEP
        allowed = min(steps, int(self.catch_up / SUBSTEP))
        for servo in self.servos:
            servo.run(allowed, SUBSTEP)

    def watch_cable(self, watcher: Callable[[bool], None]) -> None:
        """Call `watcher` with False when the cable is pulled, and with True when it is back."""
        self._watchers.append(watcher)

    def unwatch_cable(self, watcher: Callable[[bool], None]) -> None:
        """Call `watcher` no more; idempotent."""
        if watcher in self._watchers:
            self._watchers.remove(watcher)

    def offer(self, faults: Mapping[str, Inject]) -> None:
        """Take up faults of what stands in front of the servos, e.g. of their registers."""
        self._offered.update(faults)

    def faults(self) -> tuple[str, ...]:
        """Names of the faults that can be injected."""
        return (*ARM_FAULTS, *SERVO_FAULTS, *self._offered)

    def inject(self, fault: str, joint: int | None, on: bool) -> None:
        """Switch a fault on or off; see `bentod.contracts.FaultInjector`."""
        if fault in ARM_FAULTS:
            self._inject_everywhere(fault, joint, on)
        elif fault in SERVO_FAULTS:
            for chosen in self._chosen(joint):
                SERVO_FAULTS[fault](self.servos[chosen], on)
        elif fault in self._offered:
            for chosen in self._chosen(joint):
                self._offered[fault](chosen, on)
        else:
            raise BadRequest(f"there is no fault '{fault}' (known: {', '.join(self.faults())})", "fault")

    def _inject_everywhere(self, fault: str, joint: int | None, on: bool) -> None:
        if joint is not None:
            raise BadRequest(f"'{fault}' is of the whole arm and takes no joint", "joint")
        if fault == "noise":
            self.noise = 0.05 if on else 0.0
        elif fault == "power":
            for servo in self.servos:
                servo.power(not on)
        elif self.plugged is on:
            self.plugged = not on
            for watcher in tuple(self._watchers):
                watcher(self.plugged)

    def _chosen(self, joint: int | None) -> Sequence[int]:
        """Indices."""
        if joint is None:
            return range(len(self.servos))
        if not 0 <= joint < len(self.servos):
            raise BadRequest(f"joint {joint} does not exist: the arm has {len(self.servos)} joints", "joint")
        return (joint,)
