"""What the daemon expects of assists: what they are told, and what they may ask for."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol, TypeAlias, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from bentod.errors import BadRequest
from bentod.frames import JointSpec, State, Value, Wishes

TOGETHER = -1
"""In an order of joints: all of them at once."""


class Outlook(Protocol):
    """What is expected of the near future, as far as it was learned in this tick."""

    def position(self, joint: int, timescale: float) -> float:
        """Where a joint is expected (rad), `timescale` ticks ahead; NaN if nobody said in this tick."""
        ...

    def confidence(self, joint: int, timescale: float) -> float:
        """C of that prediction, up to 1; 0 or less: none; NaN where nobody estimates it."""
        ...

    def surprise(self, joint: int, timescale: float) -> float:
        """Z of that prediction; NaN where nobody estimates it."""
        ...

    def familiarity(self) -> float:
        """How well the learners know a state like this one, 0..1; NaN where nobody counts."""
        ...

    def answer(self, name: str) -> float:
        """The prediction of any general value function, by name; NaN if it was not made in this tick."""
        ...

    @property
    def timescales(self) -> tuple[float, ...]:
        """Those (ticks) at which the joints' positions are predicted, ascending."""
        ...


@dataclass(frozen=True, slots=True)
class Situation:
    """What an assist is told of one tick. Everything in it can be had again from a recording."""

    time: float  # monotonic s
    rate_hz: float
    joints: tuple[int, ...]  # of the group
    active: int  # the joint that is selected
    attended: int | None  # the joint of the group that the operator is moving; None: none
    effort: float  # -1..1, what the operator asks of what is selected
    together: bool  # the operator has selected all joints of the group at once
    state: State
    outlook: Outlook
    group: str = ""  # its name


@dataclass(frozen=True, slots=True)
class Assistance:
    """What an assist asks for in one tick, and why: a sentence that a wearer understands."""

    wishes: Wishes
    engaged: bool
    reason: str


TIMESCALE_BY = ("fixed", "sarsa", "blend", "state")
"""Ways to find how far an assist looks ahead (thesis 6.3)."""

MOST_REWARD = 10.0
"""Of one reward, either way."""


@dataclass(frozen=True, slots=True)
class AssistSettings:
    """What all assists have in common, and what belongs to one of them."""

    timescale: float = 20.0  # ticks; which prediction to follow
    k: float = 0.025  # share of the way a tick, 0 < k < 1
    velocity_limit: float = 10.0  # rad/s; a joint's own maximum holds as well
    manual: float = 0.5  # s without assistance after a toggle
    options: Mapping[str, float] = field(default_factory=dict)  # the assist's own
    timescale_by: str = "fixed"  # how another is found than `timescale`: "sarsa", "blend", "state"
    toggle_reward: float = -1.0  # of each toggle, for what finds timescales
    contact_reward: float = -1.0  # of each mark "contact" in a trial

    def __post_init__(self) -> None:
        bounds = {
            "timescale": (1 <= self.timescale < math.inf, "at least 1 tick"),
            "k": (0 < self.k < 1, "above 0 and below 1"),
            "velocity_limit": (0 < self.velocity_limit < math.inf, "above 0 rad/s"),
            "manual": (0 <= self.manual < math.inf, "at least 0 s"),
            "timescale_by": (self.timescale_by in TIMESCALE_BY, f"one of {', '.join(TIMESCALE_BY)}"),
            "toggle_reward": (abs(self.toggle_reward) <= MOST_REWARD, f"within ±{MOST_REWARD:g}"),
            "contact_reward": (abs(self.contact_reward) <= MOST_REWARD, f"within ±{MOST_REWARD:g}"),
        }
        for name, (holds, bound) in bounds.items():
            if not holds:
                raise BadRequest(f"The assistance's {name} must be {bound}, not {getattr(self, name)}.", name)


class Assist(Protocol):
    """Helps with the joints of a group. No clock, no input or output: the same again in every replay.

    `bentod.assists` is the group of entry points for assists from outside: a factory `OpenAssist`. Whatever
    an assist asks for, it is only given joints of its group that the operator is not moving, only while the
    operator moves (or pushes all of them together), and only finite velocities within the limits.

    Whoever inherits from it need only say what to wish for, how to adjust, and what a toggle changes.
    """

    def wish(self, situation: Situation) -> Assistance:
        """What to ask of the joints of the group in this tick; called in every tick."""
        ...

    def adjust(self, settings: AssistSettings) -> None:
        """Go on with other settings. Raises BadRequest: one is out of its bounds; nothing has changed."""
        ...

    def toggled(self, now: float) -> None:
        """The operator has selected another joint (monotonic s)."""
        ...

    def rewarded(self, reward: float) -> None:
        """Somebody was pleased (above 0) or not (below 0) with what the arm did."""
        return None

    def order(self, situation: Situation) -> tuple[int, ...] | None:
        """In which order joints are to be selected by the toggles to come; None: as the config lists them.

        The joint before those to come is the last, for the order is a ring. `TOGETHER` in it says where all
        at once have their place, if they may be selected; left out, they come after the last.
        """
        return None

    def needs_all(self) -> bool:
        """Whether it looks at all timescales, and not only at that of its settings."""
        return False

    def offers_together(self) -> bool:
        """Whether all joints at once may be selected now, as one more entry of the toggle list."""
        return False

    def told(self) -> Mapping[str, Value]:
        """What the assist has found out, for whoever asks how it goes."""
        return {}

    def memory(self) -> dict[str, NDArray[np.float64]]:
        """Copies of what is to be known again in the next session, by names of its own."""
        return {}

    def recall(self, memory: Mapping[str, NDArray[np.float64]]) -> None:
        """Go on with it. Raises ValueError: it does not fit, and nothing has changed."""
        return None


@runtime_checkable
class Asking(Protocol):
    """An assist that needs answers of its own, besides where joints will be."""

    def asks(self, group: str, joints: Sequence[str]) -> tuple[Mapping[str, Value], ...]:
        """Tables like those of `learn.gvfs`, about a group and its joints, by name.

        They are asked while the assist is in use, and answered before it is called, from the next tick on.
        """
        ...


OpenAssist: TypeAlias = Callable[[Sequence[JointSpec], float, AssistSettings], Assist]
"""How an assist is made, for joints and a rate (Hz).

Raises:
    BadRequest: a setting or option is out of its bounds, or unknown; `field` is its name.
"""
