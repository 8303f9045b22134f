"""What learners are built from, checked: their settings, and the parameters that only one algorithm has."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from bentod.contracts import LearnerSettings
from bentod.errors import nearest


@dataclass(frozen=True, slots=True)
class Option:
    """A parameter of one algorithm, and its bounds."""

    default: float
    least: float
    most: float


def check(settings: LearnerSettings, longest: float) -> None:
    """Raises ValueError: no learner can be built from this. `longest`: bound of the weights' length."""
    if settings.size < 1:
        raise ValueError(f"A learner needs at least 1 feature, not {settings.size}.")
    if not 0 < settings.active < math.inf:
        raise ValueError(f"The expected |φ|² must be above 0 and finite, not {settings.active:g}.")
    if not 0 < settings.step_size <= 1:
        raise ValueError(f"The step size must be above 0 and up to 1, not {settings.step_size:g}.")
    if not abs(settings.initial) * math.sqrt(settings.size) <= longest:
        raise ValueError(f"The initial weights must together not be above {longest:g}.")


def chosen(given: Mapping[str, float], options: Mapping[str, Option]) -> dict[str, float]:
    """Each option's value: the one `given`, or the default. Raises ValueError: unknown, or out of bounds."""
    for name, value in given.items():
        if name not in options:
            raise ValueError(f"There is no option '{name}' of this algorithm{nearest(name, options)}")
        option = options[name]
        if not option.least <= value <= option.most:
            raise ValueError(f"The option {name} must be {option.least:g} to {option.most:g}, not {value:g}.")
    return {name: given.get(name, option.default) for name, option in options.items()}
