"""The seam between joints and a CAN protocol: what controllers report and are told, as motor-side values.

Another protocol is one more file with a `CanCodec`, and one line in `drivers.can.joints.CODECS`.
"""

from dataclasses import dataclass
from typing import Protocol, TypeAlias

from drivers.can.link import Frame


@dataclass(frozen=True, slots=True)
class Estimate:
    """Where the motor is."""

    position: float  # turns
    velocity: float  # turns/s


@dataclass(frozen=True, slots=True)
class Heartbeat:
    """The controller lives."""

    armed: bool  # whether it drives the motor in closed loop
    errors: tuple[str, ...]  # what keeps it from doing so, in its manual's words


@dataclass(frozen=True, slots=True)
class Disarmed:
    """Why the controller last let the motor go; empty when nothing but a request did."""

    reasons: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Current:
    """What the motor draws."""

    amperes: float  # signed as the motor's torque


@dataclass(frozen=True, slots=True)
class Supply:
    """What the controller is fed."""

    volts: float


@dataclass(frozen=True, slots=True)
class Heat:
    """The hotter of power stage and motor, where the motor has a sensor."""

    celsius: float


Report: TypeAlias = Estimate | Heartbeat | Disarmed | Current | Supply | Heat


@dataclass(frozen=True, slots=True)
class Spin:
    """Keep turning; the position is not controlled."""

    velocity: float  # turns/s


@dataclass(frozen=True, slots=True)
class Go:
    """Go to a position with bounded speed and acceleration, and stay."""

    position: float  # turns
    speed: float  # turns/s, above 0


@dataclass(frozen=True, slots=True)
class Rest:
    """Hold a position that the motor is at."""

    position: float  # turns


Motion: TypeAlias = Spin | Go | Rest


@dataclass(frozen=True, slots=True)
class Bounds:
    """What the controller must keep to by itself."""

    velocity: float  # turns/s
    acceleration: float  # turns/s²
    current: float  # A


class CanCodec(Protocol):
    """Frames to reports, motions to frames. No clock, no input or output."""

    def decode(self, frame: Frame) -> tuple[int, Report] | None:
        """The node that sent the frame and what it says; None for everything else, garbage included."""
        ...

    def prepare(self, node: int, bounds: Bounds, position: float) -> tuple[Frame, ...]:
        """Make a motor that is about to be armed hold `position` (turns), within bounds."""
        ...

    def arm(self, node: int, on: bool) -> Frame:
        """Drive the motor or let it go; the heartbeat confirms it."""
        ...

    def move(self, node: int, motion: Motion, before: Motion | None) -> tuple[Frame, ...]:
        """Tell `motion`; `before` is what was told last (None: unknown). Repeating it costs no motion."""
        ...

    def poll(self, node: int, turn: int) -> Frame:
        """Ask for something that is not sent by itself; `turn` counts up from 0."""
        ...

    def clear_errors(self, node: int) -> Frame:
        """Make the controller forget errors whose cause is gone. It stays disarmed."""
        ...

    def estop(self, node: int) -> Frame:
        """Let the motor go at once and refuse to be armed until errors are cleared."""
        ...
