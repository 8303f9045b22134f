"""The values that flow through a tick: SI units and radians, frozen, one time base (monotonic seconds)."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from bentod.joystick_frame import JoystickFrame
from bentod.recognition_frame import RecognitionFrame

Value: TypeAlias = "bool | int | float | str | bytes | list[Value] | dict[str, Value] | None"
"""What a config file or a message can hold."""

Samples: TypeAlias = NDArray[np.float32]  # EMG in volts, shape (samples, channels)


class Mode(StrEnum):
    """What a joint is allowed to do; FAULT is of the whole arm."""

    LIMP = "limp"  # torque off
    HOLDING = "holding"  # torque on, pinned where it was found, not yet released to move
    ACTIVE = "active"  # obeys the arbiter
    PAUSED = "paused"  # stopped by an operator, holds
    FAULT = "fault"  # latched; waits for an explicit clear


class Freshness(StrEnum):
    """How far a joint's reading can be trusted."""

    FRESH = "fresh"  # read in this round
    STALE = "stale"  # not answered in this round; the last value stands
    LOST = "lost"  # silent for so long that the last value means nothing


@dataclass(frozen=True)
class Bounds:
    """What a joint may do besides its position and velocity."""

    acceleration: float = 10.0  # rad/s², of what is asked of it; a stop is never slowed down
    soft_zone: float = 0.05  # rad before a limit, within which it slows down towards the limit
    load: float = 0.8  # share of the greatest torque, above which it moves no further against the load
    warm: float = 60.0  # degrees Celsius, from which on it slows down
    hot: float = 68.0  # degrees Celsius, at which it goes limp; by itself an AX lets go at 70, an MX at 80


@dataclass(frozen=True, slots=True)
class JointSpec:
    """One joint as the config declares it."""

    name: str
    minimum: float  # rad
    maximum: float  # rad
    max_velocity: float  # rad/s, above 0
    home: float  # rad
    hardware: Mapping[str, Value]  # the driver's own keys, checked by the driver
    bounds: Bounds = Bounds()

    @property
    def spoken(self) -> str:
        """The name as in a sentence."""
        return self.name.replace("_", " ")

    def clamp(self, position: float) -> float:
        """`position` (rad) brought into the joint's limits."""
        return min(max(position, self.minimum), self.maximum)


@dataclass(frozen=True, slots=True)
class StopReport:
    """How a joint came to rest after the last time it was told to."""

    rule: str  # how the resting place was estimated
    time: float  # monotonic s, when it was told to stop
    travel: float  # rad, way from where it was read at that moment to where it came to rest, along its motion
    bounce: float  # rad, how far it came back from its farthest point; 0 or more


@dataclass(frozen=True, slots=True)
class JointState:
    """One joint as it was last read."""

    position: float  # rad
    velocity: float  # rad/s, positive towards `maximum`
    load: float  # share of the greatest torque, -1..1, positive towards `maximum`
    voltage: float  # V
    temperature: float  # degrees Celsius
    age: float  # s from the sampling of these values to the time of the State they are in
    freshness: Freshness
    errors: tuple[str, ...] = ()  # what the servo itself complains of, in its manual's words
    stop: StopReport | None = None  # of the last stop that has come to rest, if the driver reports it
    shut_down: bool = False  # the servo has switched itself off and does nothing until its errors are cleared


@dataclass(frozen=True, slots=True)
class State:
    """All joints after one round on the bus."""

    time: float  # monotonic s, end of the round
    joints: tuple[JointState, ...]
    problem: str = ""  # why no joint can be read at all, e.g. the port is gone


@dataclass(frozen=True, slots=True)
class Stop:
    """Come to rest and hold."""

    kind: Literal["stop"] = "stop"


@dataclass(frozen=True, slots=True)
class Velocity:
    """Keep moving at `velocity` (rad/s, signed, not 0)."""

    velocity: float
    kind: Literal["velocity"] = "velocity"


@dataclass(frozen=True, slots=True)
class Position:
    """Go to `position` (rad) at no more than `speed` (rad/s, above 0)."""

    position: float
    speed: float
    kind: Literal["position"] = "position"


Command: TypeAlias = Stop | Velocity | Position  # what one joint is told for one tick

Wishes: TypeAlias = Mapping[int, Command]
"""What one source asks for, by joint index; a joint that is absent is not asked for anything."""


@dataclass(frozen=True, slots=True)
class EmgBlock:
    """Samples as a source delivers them."""

    first_index: int  # index of the first sample since the source was opened, gaps included
    time: float  # monotonic s of the first sample
    samples: Samples  # V, shape (n, channels)
    dropped: int = 0  # samples known to be lost just before this block


@dataclass(frozen=True, slots=True)
class JointFrame:
    """One joint in one tick: what it did, what was asked, what was sent, and what is expected of it."""

    name: str
    mode: Mode
    torque: bool
    position: float  # rad
    velocity: float  # rad/s
    load: float  # -1..1
    voltage: float  # V
    temperature: float  # degrees Celsius
    age: float  # s
    freshness: Freshness
    errors: tuple[str, ...]
    stop: StopReport | None
    asked: Mapping[str, Command]  # by source: "client", "home", "emg", "joystick", "assist"
    holder: str  # the source that won, with the client's name; empty when nobody asks
    sent: Command | None  # None: nothing was written, the joint is limp or in fault
    limited: str  # which limit made `sent` differ from what was asked, in a word or two; empty if none did
    predictions: Mapping[str, float]  # rad, by timescale in steps, e.g. {"20": 0.31}


@dataclass(frozen=True, slots=True)
class EmgFrame:
    """Muscle signals in one tick."""

    alive: bool
    paused: bool
    problem: str  # why the source is not alive, or must be seen at rest first; empty otherwise
    next_index: int  # index after the newest sample
    age: float  # s since the newest sample
    dropped: int  # samples lost since the source was opened
    effort: Mapping[str, float]  # by site, 0..1
    toggles: int  # since the start
    recognition: RecognitionFrame | None = None  # None: the config asks for none


@dataclass(frozen=True, slots=True)
class GroupFrame:
    """One joint group in one tick."""

    name: str
    joints: tuple[str, ...]
    active: str
    effort: float  # -1..1, what the operator asks of the active joint
    operator: str  # who drives the group, e.g. "emg" or "client:joystick"; empty when nobody does
    together: bool = False  # all joints at once are selected, and an assist moves them as the operator pushes


@dataclass(frozen=True, slots=True)
class GoalFrame:
    """A long-running request in one tick."""

    id: int
    kind: str  # "go_home"
    status: Literal["accepted", "moving", "done", "cancelled"]
    progress: float  # 0..1
    reason: str = ""  # why it was cancelled


@dataclass(frozen=True, slots=True)
class AssistFrame:
    """What collaborative control does in one tick, and why."""

    mode: str
    engaged: bool
    reason: str
    attended: str = ""  # the joint of its group that the operator is moving, by name; empty when none is
    group: str = ""  # which it helps with
    moving: Mapping[str, float] = field(default_factory=dict)  # rad/s, what it asks of joints, by name
    offers_together: bool = False  # all joints at once may be selected now


@dataclass(frozen=True, slots=True)
class LearnFrame:
    """What the general value functions say in one tick, by their names."""

    predictions: Mapping[str, float] = field(default_factory=dict)  # in the unit of the cumulant
    older: Mapping[str, float] = field(default_factory=dict)  # age in ticks of those not made in this one
    confidence: Mapping[str, float] = field(default_factory=dict)  # C, thesis 6.1.1: none at 0, all at 1
    surprise: Mapping[str, float] = field(default_factory=dict)  # Z, (6.1)
    error: Mapping[str, float] = field(default_factory=dict)  # RMSE against the return, cumulant's unit
    familiarity: Mapping[str, float] = field(default_factory=dict)  # 0..1, by representation


@dataclass(frozen=True, slots=True)
class Trial:
    """One trial of a session, from the moment an experimenter starts it."""

    number: int  # from 1 since the daemon started
    name: str  # e.g. the task's
    condition: str  # e.g. "dpcc" or "toggling"
    started: float  # monotonic s


@dataclass(frozen=True, slots=True)
class Costs:
    """What the phases of a tick took (s)."""

    read: float  # the round on the bus
    think: float  # requests, muscles, learners, assist, arbiter, limits
    write: float  # commands and torque
    publish: float  # of the tick before: the frame to subscribers


@dataclass(frozen=True, slots=True)
class Frame:
    """Everything about one tick, published as one atomic message."""

    tick: int
    time: float  # monotonic s, the tick's deadline
    wall: float  # s since the epoch
    lateness: float  # s from the deadline to the start of the tick
    missed: int  # ticks skipped since the start
    costs: Costs
    shed: int  # updates of learners left out since the start, because their ticks' time was spent
    rate_hz: float
    mode: Mode  # FAULT, or the mode that the least restrained joint is in
    fault: str  # why; empty when there is none
    joints: tuple[JointFrame, ...]
    emg: EmgFrame
    groups: tuple[GroupFrame, ...]
    assist: AssistFrame
    goal: GoalFrame | None
    meta: Value
    gap: bool = False  # whether ticks just before it were missed or broke, so that no learner may bridge them
    read_at: float = 0.0  # monotonic s, end of the round on the bus
    trial: Trial | None = None  # the one that is running
    whole: bool = True  # False: the tick broke, and tells of its joints what was last known
    learn: LearnFrame = LearnFrame()
    more_assists: tuple[AssistFrame, ...] = ()  # those of other groups, if several are helped with
    joystick: JoystickFrame | None = None  # None: the config has no such table


@dataclass(frozen=True, slots=True)
class ClientCommand:
    """What a client asked of the arm, and what came of it."""

    time: float  # monotonic s, when it was carried out or refused
    tick: int  # the tick in whose seam that was
    client: str
    method: str
    params: Value  # as sent
    error: str  # why it was refused; empty if it was not


@dataclass(frozen=True, slots=True)
class Event:
    """Something that happened once."""

    time: float  # monotonic s
    kind: str  # "mode", "fault", "group", "goal", "emg", "servo", "late", "learn", "diverged", "reward" …
    text: str  # a sentence
    data: Mapping[str, Value]
