"""What is recognised in muscle signals, as every frame tells it."""

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class RecognitionFrame:
    """What is recognised in the muscles' signals in one tick: the newest decision."""

    index: int  # of the sample that completed its window; -1: there is none
    label: str  # what is decided, after rejection and votes; "rest" moves nothing
    speed: float  # 0..1
    probabilities: Mapping[str, float]  # by class, of the window
    likely: str  # the most probable class of the window, rejected or not
    rejected: bool
    reason: str  # why nothing is recognised, or obeyed; empty otherwise
    model: str  # its name; empty when there is none
    prompted: str  # what a guided collection asks for now; empty when there is none
    weight: float = 0.0  # 0..1, of what was predicted in this decision: β C of (6.6)
    unaided: str = ""  # the most probable class without it; empty when nothing is predicted
