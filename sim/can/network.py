"""Simulated axes on one bus: time, cyclic frames, the wire, and everything that can be broken about them."""

import asyncio
import random
from collections.abc import Callable, Mapping, Sequence

from bentod.errors import BadRequest, BusError, nearest
from drivers.can.link import Frame
from sim.can import axis as odrive
from sim.can import frames
from sim.can.axis import SimAxis
from sim.can.motor import SUBSTEP

CYCLE = 0.01
"""s between encoder estimates, ODrive's default."""

BEATS = 10
"""Cycles between heartbeats: 100 ms, ODrive's default."""

CATCH_UP = 1.0
"""Most s simulated in one go; what is beyond passes without motion."""

QUEUE = 10
"""Frames that fit into the adapter's buffer, as in Linux' default for CAN."""

FULL = "The simulated CAN bus takes no frames: its buffer is full, because nobody acknowledges."


def _silent(axis: SimAxis, on: bool) -> None:
    axis.silent = on


def _heartbeat(axis: SimAxis, on: bool) -> None:
    axis.beating = not on


def _stuck(axis: SimAxis, on: bool) -> None:
    axis.motor.stuck = on


def _overload(axis: SimAxis, on: bool) -> None:
    """A moment's: the error remains until it is cleared."""
    if on:
        axis.disarm(odrive.CURRENT_LIMIT)


def _overheat(axis: SimAxis, on: bool) -> None:
    axis.celsius += 100.0 if on else -100.0
    _cause(axis, odrive.MOTOR_HOT, on)


def _low_voltage(axis: SimAxis, on: bool) -> None:
    axis.supply = 8.0 if on else 12.0
    _cause(axis, odrive.UNDER_VOLTAGE, on)


def _cause(axis: SimAxis, error: int, on: bool) -> None:
    """The error stays when its cause is gone, until it is cleared."""
    if on:
        axis.causes.add(error)
        axis.disarm(error)
    else:
        axis.causes.discard(error)


AXIS_FAULTS: Mapping[str, Callable[[SimAxis, bool], None]] = {
    "silent": _silent,
    "stuck": _stuck,
    "heartbeat": _heartbeat,
    "overload": _overload,
    "overheat": _overheat,
    "low_voltage": _low_voltage,
}
"""Faults of one axis; without a joint they befall every axis."""

BUS_FAULTS = ("cable", "power", "noise")
"""Faults of the whole bus: nobody is heard, the supply is off, frames are lost."""


class Network:
    """Axes that share a bus, on the running loop. What it does depends on its seed and inputs only."""

    def __init__(self, axes: Sequence[SimAxis], seed: int, speak: Callable[[Frame], None]) -> None:
        """`speak` takes what the axes send."""
        self.axes = tuple(axes)
        self.plugged = True
        self._speak = speak
        self._noise = 0.0
        self._random = random.Random(f"{seed}/can")
        self._loop = asyncio.get_running_loop()
        self._time = self._loop.time()
        self._cycle = 0
        self._due = self._time + CYCLE
        self._timer = self._loop.call_at(self._due, self._beat)

    def hear(self, frame: Frame) -> None:
        """A frame from the host."""
        if not self._passes():
            return
        self.advance()
        for axis in self.axes:
            if axis.node == frame.id >> 5 and axis.answers:
                reply = axis.hear(frame.id & 31, frame.data, frame.remote)
                if reply is not None:
                    self._send(axis, *reply)

    def advance(self) -> None:
        """Bring every axis to the present."""
        steps = int((self._loop.time() - self._time) / SUBSTEP + 1e-6)
        self._time += steps * SUBSTEP
        allowed = min(steps, int(CATCH_UP / SUBSTEP))
        for axis in self.axes:
            for _ in range(allowed):
                axis.step(SUBSTEP)

    def close(self) -> None:
        """Send nothing more."""
        self._timer.cancel()

    def faults(self) -> tuple[str, ...]:
        """See `bentod.contracts.FaultInjector`."""
        return (*BUS_FAULTS, *AXIS_FAULTS)

    def inject(self, fault: str, joint: int | None, on: bool) -> None:
        """See `bentod.contracts.FaultInjector`."""
        if fault in BUS_FAULTS:
            self._inject_everywhere(fault, joint, on)
            return
        if fault not in AXIS_FAULTS:
            raise BadRequest(f"there is no fault '{fault}'{nearest(fault, self.faults())}", "fault")
        if joint is not None and not 0 <= joint < len(self.axes):
            raise BadRequest(f"joint {joint} does not exist: the bus has {len(self.axes)} joints", "joint")
        for axis in self.axes if joint is None else (self.axes[joint],):
            AXIS_FAULTS[fault](axis, on)

    def _inject_everywhere(self, fault: str, joint: int | None, on: bool) -> None:
        if joint is not None:
            raise BadRequest(f"'{fault}' is of the whole bus and takes no joint", "joint")
        if fault == "noise":
            self._noise = 0.05 if on else 0.0
        elif fault == "cable":
            self.plugged = not on
        else:
            for axis in self.axes:
                axis.power(not on)

    def _beat(self) -> None:
        self.advance()
        for index, axis in enumerate(self.axes):
            self._send(axis, frames.ENCODER_ESTIMATES.command, axis.estimates())
            if (self._cycle + 3 * index) % BEATS == 0 and axis.beating:
                self._send(axis, frames.HEARTBEAT.command, axis.heartbeat())
        self._cycle += 1
        self._due = max(self._due + CYCLE, self._loop.time())
        self._timer = self._loop.call_at(self._due, self._beat)

    def _send(self, axis: SimAxis, command: int, data: bytes) -> None:
        if axis.answers and self._passes():
            self._speak(Frame(axis.node << 5 | command, data))

    def _passes(self) -> bool:
        return self.plugged and not (self._noise and self._random.random() < self._noise)


class Wire:
    """A `CanLink` to simulated axes in this process and in the loop's own time, without python-can."""

    def __init__(self, axes: Sequence[SimAxis], seed: int, bitrate: int) -> None:
        self.network = Network(axes, seed, self._deliver)
        self._bitrate = bitrate
        self._loop = asyncio.get_running_loop()
        self._on_frame: Callable[[Frame], None] = _ignore
        self._free = 0.0
        self._unheard = 0

    def listen(self, on_frame: Callable[[Frame], None], on_trouble: Callable[[str], None]) -> None:
        """See `CanLink`; there is never trouble in receiving."""
        self._on_frame = on_frame

    def send(self, frame: Frame) -> None:
        """See `CanLink`. What waits in the adapter while the cable is pulled is forgotten."""
        self._unheard = 0 if self.network.plugged else self._unheard + 1
        if self._unheard > QUEUE:
            raise BusError(FULL)
        self._later(self.network.hear, frame)

    def close(self) -> None:
        """Let nothing arrive any more."""
        self.network.close()
        self._on_frame = _ignore

    def _deliver(self, frame: Frame) -> None:
        self._later(self._arrive, frame)

    def _arrive(self, frame: Frame) -> None:
        self._on_frame(frame)

    def _later(self, arrive: Callable[[Frame], None], frame: Frame) -> None:
        """One frame after the other, each as long as its bits: 47 and the data, a fifth of it stuffing."""
        bits = 1.2 * (47 + 8 * len(frame.data))
        self._free = max(self._free, self._loop.time()) + bits / self._bitrate
        self._loop.call_at(self._free, arrive, frame)


def _ignore(frame: Frame) -> None:
    """Nobody listens yet, or any more."""
