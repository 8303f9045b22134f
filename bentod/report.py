"""One tick as one atomic message: what was read, asked, decided, sent and expected."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from bentod.control.arbiter import Decision, asked_of
from bentod.desk import Desk
from bentod.frames import (
    AssistFrame,
    Command,
    Costs,
    Frame,
    JointFrame,
    Mode,
    Stop,
    Wishes,
)
from bentod.learn.signals import Percept
from bentod.muscles import Look


@dataclass(frozen=True, slots=True)
class Stamp:
    """Which tick it was, and how it kept time."""

    tick: int
    due: float  # monotonic s
    wall: float  # s since the epoch
    lateness: float  # s
    missed: int
    rate_hz: float
    costs: Costs
    shed: int
    gap: bool  # ticks just before it were missed or broke


@dataclass(frozen=True, slots=True)
class Deed:
    """What one tick saw and did."""

    percept: Percept
    look: Look
    wishes: Mapping[str, Wishes]
    assists: tuple[AssistFrame, ...]
    decided: Sequence[Decision]
    sent: Sequence[Command | None]


def frame(stamp: Stamp, desk: Desk, deed: Deed) -> Frame:
    """The tick as it is published."""
    return Frame(
        tick=stamp.tick,
        time=stamp.due,
        wall=stamp.wall,
        lateness=stamp.lateness,
        missed=stamp.missed,
        costs=stamp.costs,
        shed=stamp.shed,
        rate_hz=stamp.rate_hz,
        mode=desk.modes.arm,
        fault=desk.modes.fault,
        joints=tuple(_joint(joint, desk, deed) for joint in range(len(desk.specs))),
        emg=deed.look.frame,
        groups=deed.percept.groups,
        assist=deed.assists[0],
        more_assists=deed.assists[1:],
        goal=desk.goals.frame,
        meta=desk.meta,
        gap=stamp.gap,
        read_at=deed.percept.state.time,
        trial=desk.trials.running,
        learn=desk.mind.frame(),
        joystick=desk.joystick.frame if desk.joystick else None,
    )


def faulted(last: Frame, tick: int, due: float, fault: str) -> Frame:
    """A tick that broke (due: monotonic s): what was last known, in fault, and everything told to stop."""
    joints = tuple(
        replace(
            joint,
            mode=Mode.FAULT,
            asked={},
            holder=Mode.FAULT,
            sent=Stop() if joint.torque else None,
            limited="",
        )
        for joint in last.joints
    )
    return replace(last, tick=tick, time=due, mode=Mode.FAULT, fault=fault, joints=joints, whole=False)


def _joint(joint: int, desk: Desk, deed: Deed) -> JointFrame:
    reading = deed.percept.state.joints[joint]
    holder, client = deed.decided[joint].holder, desk.clients.holder(joint)
    return JointFrame(
        name=desk.specs[joint].name,
        mode=desk.modes.of(joint),
        torque=desk.modes.has_torque(joint),
        position=reading.position,
        velocity=reading.velocity,
        load=reading.load,
        voltage=reading.voltage,
        temperature=reading.temperature,
        age=reading.age,
        freshness=reading.freshness,
        errors=reading.errors,
        stop=reading.stop,
        asked=asked_of(joint, deed.wishes),
        holder=f"client:{client.client if client else ''}" if holder == "client" else holder,
        sent=deed.sent[joint],
        limited=desk.limiter.limited[joint],
        predictions=desk.mind.predictions(joint),
    )
