"""Random experience, and what a learner makes of it."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from bentod import registry
from bentod.contracts import Arrival, Learner, LearnerSettings

SIZE = 5

Numbers = list[float]


@dataclass(frozen=True)
class Journey:
    """φ_0 … φ_T, and what arriving in each but the first brought."""

    phis: list[Numbers]
    arrivals: list[Arrival]

    def transitions(self) -> Iterator[tuple[Numbers, Numbers, Arrival]]:
        return zip(self.phis, self.phis[1:], self.arrivals, strict=False)


def journey(seed: int, steps: int = 40, binary: bool = True, rho: bool = False, gaps: bool = True) -> Journey:
    """γ and λ change all the time; `gaps`: some cumulants are NaN."""
    rng = np.random.default_rng(seed)
    dense = rng.random((steps + 1, SIZE)) < 0.5 if binary else rng.normal(scale=0.7, size=(steps + 1, SIZE))
    arrivals = [
        Arrival(
            math.nan if gaps and rng.random() < 0.1 else rng.normal(),
            rng.uniform(0, 1),
            rng.uniform(0, 1),
            rng.uniform(0, 2) if rho else 1.0,
        )
        for _ in range(steps)
    ]
    return Journey(dense.astype(np.float64).tolist(), arrivals)


def settings(
    step_size: float = 0.3,
    size: int = SIZE,
    active: float = SIZE,
    initial: float = 0.0,
    options: Mapping[str, float] | None = None,
) -> LearnerSettings:
    return LearnerSettings(size, active, step_size, initial, options or {})


def learner(name: str, given: LearnerSettings) -> Learner:
    return registry.open_learner(name)(given)


def predictions(taught: Learner, experience: Journey) -> Numbers:
    """P_0 … P_T."""
    nowhere = Arrival(0.0, 0.0, 0.0)
    return [
        taught.step(np.array(phi), arrival)
        for phi, arrival in zip(experience.phis, [nowhere, *experience.arrivals], strict=True)
    ]


def told(arrival: Arrival, v: float, v_next: float) -> float:
    """R, or where it was not observed, what was expected."""
    return arrival.cumulant if math.isfinite(arrival.cumulant) else v - arrival.gamma * v_next


def error(arrival: Arrival, v: float, v_next: float) -> float:
    """δ by (2.2): exactly 0 where R was not observed."""
    return arrival.cumulant + arrival.gamma * v_next - v if math.isfinite(arrival.cumulant) else 0.0


def imputed(experience: Journey, place: int, cumulant: float) -> Journey:
    """The same journey with another cumulant of one arrival."""
    arrivals = list(experience.arrivals)
    arrivals[place] = replace(arrivals[place], cumulant=cumulant)
    return replace(experience, arrivals=arrivals)
