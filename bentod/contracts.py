"""What the daemon expects of clocks, joints, muscle signals, joysticks, learners and assists."""

import math
from collections.abc import AsyncIterator, Callable, Mapping, Sequence
from contextlib import AbstractAsyncContextManager
from dataclasses import dataclass
from typing import Protocol, TypeAlias, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from bentod.frames import Command, EmgBlock, JointSpec, State, Value


class Clock(Protocol):
    """Time, injected: real in the daemon, virtual in tests and studies."""

    def now(self) -> float:
        """Monotonic seconds, the time base of the event loop (`loop.time()`)."""
        ...

    def wall(self) -> float:
        """Seconds since the epoch; may jump, so it only labels."""
        ...

    async def sleep_until(self, deadline: float) -> None:
        """Return once `now()` has reached `deadline` (s); at once when it has passed."""
        ...


@dataclass(frozen=True, slots=True)
class ArmConfig:
    """What a driver of joints is given."""

    joints: tuple[JointSpec, ...]
    period: float  # s between ticks
    options: Mapping[str, Value]  # the driver's own table, checked by the driver


class Joints(Protocol):
    """An arm's joints behind one bus or several. Indices follow `ArmConfig.joints`.

    Only the controller calls these, one call at a time.
    """

    async def read(self) -> State:
        """One round on the bus, well within a tick. Never raises: what did not answer is stale or lost."""
        ...

    async def write(self, commands: Sequence[Command | None]) -> None:
        """Send each joint its command (None: do not touch it, it is limp). Never raises for a silent bus.

        Velocities and positions are within the joint's limits. Repeating a command costs no motion:
        a joint that was told to stop keeps the goal that the first `Stop` gave it.
        """
        ...

    async def set_torque(self, on: Sequence[bool]) -> None:
        """Bring each joint's torque to `on`. A joint that is switched on is first pinned where it is.

        Raises:
            BusError: a joint did not confirm; its torque is then unknown.
        """
        ...

    def torque(self) -> tuple[bool, ...]:
        """Torque of each joint as last confirmed by the hardware; at opening, as it was found.

        It may change by itself: a servo that was reset, or found again after the line was lost, has the
        torque that it was found with. Only `set_torque` ever asks for it.
        """
        ...

    async def clear_errors(self, joints: Sequence[int]) -> tuple[str, ...] | None:
        """Clear the errors of these joints as far as their hardware can; a joint may be limp afterwards.

        Returns a sentence for each joint that needs something else, e.g. a power cycle; None if that takes
        longer than a tick has, e.g. for a reboot: then ask again in the next. Never raises for a silent bus:
        that is a sentence too.
        """
        ...


OpenJoints: TypeAlias = Callable[[ArmConfig, Clock], AbstractAsyncContextManager[Joints]]
"""How a driver is opened.

Raises:
    BusError: the port cannot be opened, or a servo is absent or not the one in the config.
"""


@runtime_checkable
class FaultInjector(Protocol):
    """What simulated hardware offers besides: to be broken on purpose. Real hardware does not have it."""

    def faults(self) -> tuple[str, ...]:
        """Names of the faults that can be injected, e.g. "cable", "silent", "stuck"."""
        ...

    def inject(self, fault: str, joint: int | None, on: bool) -> None:
        """Switch a fault on or off, for one joint or (None) for the whole arm.

        Raises:
            BadRequest: no such fault, or it needs a joint.
        """
        ...


class EmgSource(Protocol):
    """A stream of muscle signals. Iteration ends when the source does."""

    rate_hz: float
    channels: int

    def __aiter__(self) -> AsyncIterator[EmgBlock]:
        """Blocks as they arrive, in order. Ends when there will be no more, which a recording may.

        Raises:
            InputFileError: the source broke, e.g. it was unplugged or is silent; it may be opened again.
        """
        ...


@runtime_checkable
class Promptable(Protocol):
    """What a source with a simulated wearer offers besides: to be told what to do. Real wearers read it."""

    def prompt(self, label: str) -> None:
        """Have the wearer make this movement until another is asked for; one that is unknown is rest."""
        ...


@dataclass(frozen=True, slots=True)
class EmgConfig:
    """What a source of muscle signals is given."""

    rate_hz: float
    channels: int  # least number of channels that the sites need
    options: Mapping[str, Value]  # the source's own table, checked by the source


OpenEmg: TypeAlias = Callable[[EmgConfig, Clock], AbstractAsyncContextManager[EmgSource]]
"""How a source is opened, and opened again when it broke. Another task may close it than opened it.

Raises:
    ConfigError: an option is unknown, out of bounds or does not fit the device.
    InputFileError: the file or device cannot be used.
"""


class AudioPlayer(Protocol):
    """What makes sound. No call ever waits: what cannot be heard is dropped, and that is logged once."""

    def play(self, wav: bytes) -> None:
        """Play a whole WAV file at once; one that still sounds ends."""
        ...

    def hum(self, source: Callable[[], bytes] | None, rate_hz: int = 0) -> None:
        """From now on play, besides, what `source` gives: None for nothing.

        `source` is asked for a little at a time, in the loop, and no sooner than it can be heard. It gives
        samples (mono, 16 bits, the least first, `rate_hz` a second), or nothing while there is silence.
        """
        ...


OpenAudio: TypeAlias = Callable[[], AbstractAsyncContextManager[AudioPlayer]]
"""How a player is opened. It is silent at the end, and leaves no process behind.

Where nothing can play sound at all, what is opened plays nothing, and logs why.
"""


@dataclass(frozen=True, slots=True)
class Pad:
    """A joystick or gamepad as it is now."""

    connected: bool = False
    reason: str = ""  # why it is not connected, as a sentence
    axes: tuple[float, ...] = ()  # -1..1, by number
    buttons: tuple[bool, ...] = ()  # whether each is down, by number
    presses: tuple[int, ...] = ()  # how often each was pressed since the pad was opened
    openings: int = 0  # how often it was opened so far
    seen: float = -math.inf  # monotonic s, when it was last certain that this is how it is
    changed: float = -math.inf  # monotonic s, when the pad last said that something of it has changed


class JoystickSource(Protocol):
    """A joystick or gamepad, which may come and go: whoever was opened looks for it again by itself.

    A button that is down when the pad is opened is no press. Many pads say nothing while nothing changes, so
    `seen` means that whoever would be told has just asked, and `changed` is all that the pad itself says.
    """

    def latest(self) -> Pad:
        """The newest that is known. Never waits and never raises: what is not there is not connected."""
        ...


OpenJoystick: TypeAlias = Callable[[Mapping[str, Value], Clock], AbstractAsyncContextManager[JoystickSource]]
"""How a source is opened, given its own table. That no pad is plugged in is no error.

Raises:
    ConfigError: an option is unknown or out of bounds, or a library is missing.
"""


Features: TypeAlias = NDArray[np.intp]
"""Indices of the active binary features, unique and ascending, shape (k,)."""


Vector: TypeAlias = NDArray[np.float64]
"""A dense vector, shape (n,)."""


@dataclass(frozen=True, slots=True)
class Arrival:
    """What arriving in a state brings to one question about it."""

    cumulant: float  # R_{t+1}; NaN: not observed, and nothing is to be learned from this step
    gamma: float  # γ_{t+1}, 0..1: the chance to continue past this state; its n-th power after n ticks
    lam: float  # λ_{t+1}, 0..1; its n-th power after n ticks
    rho: float = 1.0  # ρ_t, 0 or more: how much likelier the question's policy was to do what was done


@dataclass(frozen=True, slots=True)
class LearnerSettings:
    """What a learner of one general value function is built from."""

    size: int  # n, number of features
    active: float  # the greatest |φ|² that is expected: of binary features, how many are active
    step_size: float  # α · active, above 0 and up to 1: the share of an error that one step may take away
    initial: float  # of every weight
    options: Mapping[str, float]  # the algorithm's own parameters, by the names its file gives them


class Learner(Protocol):
    """Learns one general value function on line, with weights of its own. No clock, no input or output.

    `bentod.learners` is the group of entry points for learners from outside: a factory that takes
    `LearnerSettings` and raises ValueError for an option that it does not know or that is out of bounds.
    """

    delta: float
    """δ_t of the last step; NaN where nothing was learned."""
    resets: int
    """How often it had to begin anew, because it was not finite or beyond all reason."""

    def step(self, phi: Vector, arrival: Arrival) -> float:
        """Learn from the transition into `phi` (φ_{t+1}), then predict from there: w_{t+1}ᵀφ_{t+1}.

        The first call, and the first after `cut`, only predicts. `phi` is not changed and may be kept.
        """
        ...

    def cut(self) -> None:
        """Forget the previous step and the traces (not the weights): the next `step` only predicts."""
        ...

    def memory(self) -> dict[str, Vector]:
        """Copies of all that the learner has learned and remembers, by name; "weights" among them."""
        ...

    def recall(self, memory: Mapping[str, Vector]) -> None:
        """Become what `memory` told. Raises ValueError: it is not that of such a learner of this size."""
        ...


OpenLearner: TypeAlias = Callable[[LearnerSettings], Learner]
"""How a learner is made."""
