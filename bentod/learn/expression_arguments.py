"""What the functions of expressions take: how many arguments, and which of them must be constants."""

import math
from collections.abc import Sequence

from bentod.errors import ConfigError
from bentod.learn.expression_nodes import Node, Number, range_of

LONGEST_DELAY = 1000  # ticks

ARGUMENTS = {
    "abs": (1, 1), "square": (1, 1), "min": (2, 64), "max": (2, 64), "clip": (3, 3), "norm": (1, 3),
    "logistic": (3, 3),
    "above": (2, 2), "below": (2, 2), "near": (3, 3), "diff": (1, 1), "trace": (2, 2), "delay": (2, 2),
    "prediction": (1, 1), "delta2": (1, 1), "advice": (2, 3),
}  # fmt: skip
"""By function, the least and the greatest number of arguments."""


def checked(function: str, arguments: Sequence[Node]) -> list[Node]:
    """The arguments, those of `norm` completed. Raises ConfigError: one is not a constant within bounds."""
    numbers = [node.value if isinstance(node, Number) else math.nan for node in arguments[1:]]
    if function == "trace" and not 0 <= numbers[0] < 1:
        raise ConfigError("the decay of a trace must be a number of at least 0 and below 1")
    if function == "delay" and not (1 <= numbers[0] <= LONGEST_DELAY and numbers[0].is_integer()):
        raise ConfigError(f"a delay must be a whole number of ticks, 1 to {LONGEST_DELAY}")
    if function == "clip" and numbers[0] > numbers[1]:
        raise ConfigError(f"clip(x, low, high) needs the lower bound first, not {numbers[0]:g}")
    if function == "norm":
        return [arguments[0], *_bounds(arguments[0], numbers)]
    return list(arguments)


def _bounds(x: Node, given: Sequence[float]) -> tuple[Number, Number]:
    bounds = given or range_of(x)
    if bounds is None:
        raise ConfigError(f"the range of {str(x)[:80]} is not known: write norm(x, low, high)")
    if len(bounds) != 2 or not bounds[0] < bounds[1] or not math.isfinite(bounds[1] - bounds[0]):
        raise ConfigError("norm(x, low, high) needs two numbers, the lower one first")
    return Number(bounds[0]), Number(bounds[1])
