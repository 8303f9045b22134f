"""What a tick shows to all learners."""

from dataclasses import dataclass

from bentod.contracts import Vector
from bentod.learn.answers import Answers


@dataclass(frozen=True, slots=True)
class Scene:
    """One tick, as seen by whatever evaluates and learns."""

    signals: Vector  # of this tick, in the order of `Signals.names`
    answers: Answers  # of all questions so far
    elapsed: int  # ticks since the one before: 1, or more if some were missed
    steps: int  # the same if it may be learned across, else 0
