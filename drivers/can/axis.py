"""One controller on the bus and the joint that it drives: what it last said, and what it was last told."""

import math

from bentod.errors import BusError
from bentod.frames import Command, Freshness, JointSpec, JointState, Stop
from drivers.can.codec import (
    CanCodec,
    Current,
    Disarmed,
    Estimate,
    Heartbeat,
    Heat,
    Motion,
    Report,
    Supply,
)
from drivers.can.link import Frame
from drivers.can.motion import JointMotion, Sample
from drivers.can.options import Hardware, Options

NEVER = -math.inf


class Axis:
    """A joint and its controller. Holds values and makes frames; never touches the bus."""

    def __init__(
        self, spec: JointSpec, hardware: Hardware, options: Options, codec: CanCodec, period: float
    ) -> None:
        """`period`: s between ticks."""
        self.spec = spec
        self.node = hardware.node
        self.armed = False
        """As the last heartbeat said."""
        self.errors: tuple[str, ...] = ()
        self.heartbeat = NEVER
        """Monotonic s of the last one."""
        self.command: Command | None = None
        """What keeps being told while the joint has torque, or is about to."""
        self._sample: Sample | None = None
        self._reasons: tuple[str, ...] = ()
        self._amperes = self._volts = self._celsius = math.nan
        self._turn = 0
        self._told: Motion | None = None
        self._motion = JointMotion(spec, hardware, options, period)
        self._hardware = hardware
        self._options = options
        self._codec = codec

    def __str__(self) -> str:
        return f"{self.spec.name} (node {self.node})"

    @property
    def complete(self) -> bool:
        """Whether both cyclic frames have been heard."""
        return self._sample is not None and self.heartbeat > NEVER

    def hear(self, report: Report, now: float) -> None:
        """Take in what the controller says."""
        match report:
            case Estimate():
                self._sample = self._motion.gear.sample(report, now)
                self._motion.watch(self._sample)
            case Heartbeat(armed, errors):
                if self.armed and not armed:
                    self.command = self._told = None
                self.armed, self.errors, self.heartbeat = armed, errors, now
            case Disarmed(reasons):
                self._reasons = reasons
            case Current(amperes):
                self._amperes = amperes
            case Supply(volts):
                self._volts = volts
            case Heat(celsius):
                self._celsius = celsius

    def age(self, now: float) -> float:
        """Of the position, s. Without a heartbeat, of that: nobody knows whether the motor is driven."""
        position = now - self._sample.time if self._sample else math.inf
        heartbeat = now - self.heartbeat
        return max(position, heartbeat) if heartbeat > self._options.heartbeat_s else position

    def state(self, now: float, deaf: float = 0.0) -> JointState:
        """The joint as it was last read; `deaf`: s for which nothing could be sent to it.

        A joint that cannot be told to stop is no better than one that cannot be read.
        """
        assert self._sample is not None  # noqa: S101 -- nobody is given an axis that was never heard
        age = max(self.age(now), deaf)
        share = self._motion.gear.sign * self._amperes / self._hardware.current_limit_a
        return JointState(
            position=self._sample.position,
            velocity=self._sample.velocity,
            load=max(-1.0, min(1.0, share)),
            voltage=self._volts,
            temperature=self._celsius,
            age=age,
            freshness=self._freshness(age),
            errors=self.errors + self._disarmed(),
            stop=self._motion.stopped,
        )

    def pin(self, now: float) -> tuple[Frame, ...]:
        """Frames that make the joint hold where it is, once it is armed.

        Raises:
            BusError: its position is not known now, it has errors, or it is too far outside its limits.
        """
        if self._sample is None or self.age(now) > self._options.stale_after_s:
            raise BusError(f"{self} is silent: its torque was not switched on.")
        if self.errors:
            raise BusError(f"{self} reports {', '.join(self.errors)}: clear its errors first.")
        self._check_limits(self._sample.position)
        self.command = Stop()
        self._told = self._motion.pin(self._sample.position)
        return self._codec.prepare(self.node, self._motion.gear.bounds, self._told.position)

    def tell(self, now: float) -> tuple[Frame, ...]:
        """Frames of the present command; none without one. Those not sent must be told by `forget`."""
        if self.command is None or self._sample is None:
            return ()
        motion = self._motion.command(self.command, self._sample, now)
        frames = self._codec.move(self.node, motion, self._told)
        self._told = motion
        return frames

    def forget(self) -> None:
        """What was last told may not have arrived: tell all of it the next time."""
        self._told = None

    def release(self) -> None:
        """Tell nothing any more: the joint is limp, or about to be."""
        self.command = self._told = None

    def poll(self) -> Frame:
        """The next question."""
        self._turn += 1
        return self._codec.poll(self.node, self._turn)

    def confirms(self, on: bool, since: float) -> bool:
        """Whether a heartbeat after `since` (monotonic s) says that the motor is driven, or is not."""
        return self.heartbeat > since and self.armed is on

    def clear(self) -> Frame:
        """Forget what it complained of, and make it forget."""
        self._reasons = ()
        return self._codec.clear_errors(self.node)

    def _freshness(self, age: float) -> Freshness:
        if age <= self._options.stale_after_s:
            return Freshness.FRESH
        return Freshness.STALE if age <= self._options.lost_after_s else Freshness.LOST

    def _disarmed(self) -> tuple[str, ...]:
        """Why it let go, as far as that is not among its errors any more."""
        if self.armed:
            return ()
        return tuple(f"disarmed by {reason}" for reason in self._reasons if reason not in self.errors)

    def _check_limits(self, position: float) -> None:
        outside = abs(position - self.spec.clamp(position))
        if outside > self._options.limit_margin_rad:
            raise BusError(
                f"{self} stands at {math.degrees(position):.1f} degrees, {math.degrees(outside):.1f} degrees "
                f"outside its limits, which is more than {math.degrees(self._options.limit_margin_rad):.1f}; "
                "move it back by hand, or check offset_rad and gear_ratio."
            )
