"""What a general value function asks: a cumulant, a discount, and how the answer is to be learned."""

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class Estimates:
    """What is to be told about how far the answer can be believed (thesis 6.1)."""

    confidence: bool = True
    confidence_range: float | None = None  # of the cumulant, its unit; None: the span seen so far
    interval: int = 0  # past weight vectors
    variance: bool = False


@dataclass(frozen=True, slots=True)
class Question:
    """One general value function. Equal questions have equal answers, given the same experience."""

    name: str
    cumulant: str  # an expression of the state, see `bentod.learn.expression`
    gamma: float | str  # per tick: a constant 0..1, or an expression of the state
    scaled: bool  # whether R = (1 − γ)·cumulant, so that the answer is in the cumulant's unit
    lam: float
    step_size: float  # α times the number of active features
    algorithm: str
    representation: str
    policy: str = ""  # expression of ρ; empty: on policy, ρ = 1
    initial: float = 0.0  # what is answered before anything is learned
    options: Mapping[str, float] = field(default_factory=dict)
    estimates: Estimates = Estimates()
    guess: str = ""  # expression of an answer to begin with, of which only the error is learned; empty: none
