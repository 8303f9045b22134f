"""Joints made of motor controllers on one CAN bus, which report by themselves and keep velocities.

Readings are what arrived since: nothing waits in a tick. Each tick sends every joint that has torque its
command anew, which also feeds the controller's watchdog: an axis that hears no command for
`axis0.config.watchdog_timeout` lets its motor go. CANSimple has no frame to set that up, so it must be
done once on each ODrive (0.5 s is plenty; `enable_watchdog`, `save_configuration()`). An arm that is left
with torque on, as a config may ask, therefore goes limp that long after the daemon's end.

Never tried on hardware; on software buses only.
"""

import logging
from collections.abc import AsyncIterator, Callable, Iterable, Sequence
from contextlib import asynccontextmanager

from bentod.contracts import ArmConfig, Clock
from bentod.errors import BusError, ConfigError
from bentod.frames import Command, State, Stop
from drivers.can.axis import NEVER, Axis
from drivers.can.cansimple import CanSimple
from drivers.can.codec import CanCodec
from drivers.can.link import CanLink, Frame
from drivers.can.options import Options, parse_hardware, parse_options

log = logging.getLogger(__name__)

CODECS: dict[str, Callable[[], CanCodec]] = {"cansimple": CanSimple}

BEAT = 0.01
"""s between two looks at what has arrived, outside ticks; commands are repeated as often."""


class CanJoints:
    """The `Joints` contract over one bus."""

    def __init__(
        self, link: CanLink, axes: Sequence[Axis], options: Options, codec: CanCodec, clock: Clock
    ) -> None:
        """Axes in the order of the config."""
        self._link = link
        self._axes = tuple(axes)
        self._by_node = {axis.node: axis for axis in axes}
        self._options = options
        self._codec = codec
        self._clock = clock
        self._strangers: set[int] = set()
        self._hearing = ""
        self._sending = ""
        self._deaf_since: float | None = None
        link.listen(self._hear, self._trouble)

    async def read(self) -> State:
        """What has arrived, and a question to each controller; see `bentod.contracts.Joints.read`."""
        for axis in self._axes:
            self._send(axis.poll())
        now = self._clock.now()
        deaf = 0.0 if self._deaf_since is None else now - self._deaf_since
        return State(now, tuple(axis.state(now, deaf) for axis in self._axes), self._problem(now))

    async def write(self, commands: Sequence[Command | None]) -> None:
        """A command, mode and input as needed, to each; see `bentod.contracts.Joints.write`.

        A motor that is driven and that nobody commands is held: a controller would keep its last velocity.
        """
        for axis, command in zip(self._axes, commands, strict=True):
            axis.command = (command or Stop()) if axis.armed else None
        self._tell()

    async def set_torque(self, on: Sequence[bool]) -> None:
        """Off before on, each joint even if another failed; see `bentod.contracts.Joints.set_torque`."""
        problems: list[str] = []
        for switch in (False, True):
            now = self._clock.now()
            wanted = [axis for axis, want in zip(self._axes, on, strict=True) if want is switch]
            problems += await self._switch(
                [axis for axis in wanted if self._in_doubt(axis, switch, now)], switch
            )
        if problems:
            raise BusError(" ".join(dict.fromkeys(problems)))

    def torque(self) -> tuple[bool, ...]:
        """As the last heartbeats said."""
        return tuple(axis.armed for axis in self._axes)

    async def clear_errors(self, joints: Sequence[int]) -> tuple[str, ...]:
        """Clear_Errors to each; see `bentod.contracts.Joints.clear_errors`."""
        chosen = [self._axes[joint] for joint in joints]
        since = self._clock.now()
        for axis in chosen:
            self._send(axis.clear())
        await self._until(lambda: all(_clear(axis, since) for axis in chosen))
        return tuple(_complaint(axis, since) for axis in chosen if not _clear(axis, since))

    def estop(self) -> None:
        """Let every motor go at once, whatever its state; it stays so until its errors are cleared."""
        for axis in self._axes:
            axis.release()
            self._send(self._codec.estop(axis.node))

    async def meet(self) -> None:
        """Wait until every controller has been heard.

        Raises:
            BusError: one was not; all of them are named, and who else is on the bus.
        """
        deadline = self._clock.now() + self._options.open_s
        while not all(axis.complete for axis in self._axes):
            if self._clock.now() >= deadline:
                raise BusError(" ".join(self._absent()))
            await self._clock.sleep_until(self._clock.now() + BEAT)

    def halt(self) -> None:
        """Leave no velocity behind: a controller would keep it."""
        for axis in self._axes:
            axis.command = Stop() if axis.armed else None
        self._tell()

    def _hear(self, frame: Frame) -> None:
        decoded = self._codec.decode(frame)
        if decoded is None:
            return
        node, report = decoded
        self._hearing = ""
        if node in self._by_node:
            self._by_node[node].hear(report, self._clock.now())
        else:
            self._strangers.add(node)

    def _trouble(self, reason: str) -> None:
        if reason != self._hearing:
            log.warning("%s", reason)
        self._hearing = reason

    def _tell(self) -> None:
        now = self._clock.now()
        for axis in self._axes:
            if not self._send(*axis.tell(now)):
                axis.forget()

    def _send(self, *frames: Frame) -> bool:
        """Whether the bus took all of them."""
        try:
            for frame in frames:
                self._link.send(frame)
                self._sending, self._deaf_since = "", None
        except BusError as error:
            self._sending = str(error)
            self._deaf_since = self._clock.now() if self._deaf_since is None else self._deaf_since
            return False
        return True

    def _problem(self, now: float) -> str:
        if self._hearing or self._sending:
            return " ".join(dict.fromkeys(filter(None, (self._hearing, self._sending))))
        silence = min(axis.age(now) for axis in self._axes)
        if silence <= self._options.lost_after_s:
            return ""
        return f"No controller was heard on the CAN bus for {silence:.1f} s: check its cable and its supply."

    def _in_doubt(self, axis: Axis, on: bool, now: float) -> bool:
        return axis.armed is not on or now - axis.heartbeat > self._options.heartbeat_s

    async def _switch(self, axes: Iterable[Axis], on: bool) -> list[str]:
        """Switch joints, and wait for all of them; what went wrong, in sentences."""
        since = self._clock.now()
        problems: list[str] = []
        asked: list[Axis] = []
        for axis in axes:
            try:
                first = axis.pin(since) if on else ()
            except BusError as error:
                problems.append(str(error))
                continue
            if not on:
                axis.release()
            self._send(*first, self._codec.arm(axis.node, on))
            asked.append(axis)
        await self._until(lambda: all(axis.confirms(on, since) for axis in asked))
        failed = [axis for axis in asked if not axis.confirms(on, since)]
        for axis in failed:
            axis.release()
        return problems + [self._unconfirmed(axis, on, since) for axis in failed]

    async def _until(self, done: Callable[[], bool]) -> None:
        """Wait for `done`, not forever; meanwhile everyone goes on being told, so that no watchdog bites."""
        deadline = self._clock.now() + self._options.confirm_s
        while not done() and self._clock.now() < deadline:
            await self._clock.sleep_until(self._clock.now() + BEAT)
            self._tell()

    def _unconfirmed(self, axis: Axis, on: bool, since: float) -> str:
        if axis.heartbeat <= since:
            why = self._sending or "it is silent."
        else:
            reported = axis.state(self._clock.now()).errors
            why = f"it reports {', '.join(reported)}." if reported else "it gives no reason."
        return f"{axis} did not confirm that its torque is {'on' if on else 'off'}: {why}"

    def _absent(self) -> list[str]:
        others = ", ".join(str(node) for node in sorted(self._strangers))
        known = f" (heard from others: nodes {others})" if others else ""
        patience = f"within {self._options.open_s:g} s"
        return [
            f"{axis} sent no encoder estimates {patience}: set axis0.config.can.encoder_msg_rate_ms = 10."
            if axis.heartbeat > NEVER
            else f"{axis} sent no heartbeat {patience}{known}: check its cable, its supply and the bit rate."
            for axis in self._axes
            if not axis.complete
        ]


def _clear(axis: Axis, since: float) -> bool:
    return axis.heartbeat > since and not axis.errors


def _complaint(axis: Axis, since: float) -> str:
    if axis.heartbeat <= since:
        return f"{axis} did not answer: its errors may not be cleared."
    return f"{axis} still reports {', '.join(axis.errors)}: remove the cause, then clear again."


@asynccontextmanager
async def open_over(link: CanLink, config: ArmConfig, clock: Clock) -> AsyncIterator[CanJoints]:
    """Joints over a bus that the caller owns and closes. Leaving stops what moves and switches nothing.

    Raises:
        ConfigError: the driver's options or a joint's hardware are not valid.
        BusError: a controller was not heard; all of them are named.
    """
    options = parse_options(config.options)
    codec = CODECS[options.protocol]()
    hardware = [parse_hardware(spec) for spec in config.joints]
    nodes = [found.node for found in hardware]
    if len(set(nodes)) < len(nodes):
        raise ConfigError(f"CAN bus: every joint needs a node of its own, and these are {nodes}.", "node")
    axes = [
        Axis(spec, found, options, codec, config.period)
        for spec, found in zip(config.joints, hardware, strict=True)
    ]
    joints = CanJoints(link, axes, options, codec, clock)
    await joints.meet()
    try:
        yield joints
    finally:
        joints.halt()
