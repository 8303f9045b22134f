"""The numbers that a classifier can be told, each with a default and bounds."""

from collections.abc import Mapping
from dataclasses import dataclass

from bentod.errors import ConfigError, nearest


@dataclass(frozen=True, slots=True)
class Bound:
    """One option of a classifier."""

    default: float
    low: float
    high: float
    whole: bool = False  # only whole numbers make sense


def taken(classifier: str, bounds: Mapping[str, Bound], options: Mapping[str, float]) -> dict[str, float]:
    """Every option of `bounds`, as it was told or by default.

    Raises:
        ConfigError: an option is unknown, out of bounds, or not whole where it must be.
    """
    for name, value in options.items():
        if name not in bounds:
            raise ConfigError(
                f"the classifier {classifier} has no option '{name}'{nearest(name, bounds)}", name
            )
        bound = bounds[name]
        if not bound.low <= value <= bound.high:
            raise ConfigError(
                f"the option '{name}' of the classifier {classifier} is {value:g}; "
                f"it must be from {bound.low:g} to {bound.high:g}",
                name,
            )
        if bound.whole and value != int(value):
            raise ConfigError(
                f"the option '{name}' of the classifier {classifier} is {value:g}; it must be whole", name
            )
    return {name: options.get(name, bound.default) for name, bound in bounds.items()}
