"""What an expression is made of: numbers, signals, other questions' answers, and functions of these."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from keyword import iskeyword
from types import MappingProxyType
from typing import TypeAlias

from bentod.learn.signals import Range


@dataclass(frozen=True, slots=True)
class Number:
    """A constant."""

    value: float  # finite

    def __str__(self) -> str:
        return repr(self.value)


@dataclass(frozen=True, slots=True)
class Signal:
    """What is perceived, by its place among all signals."""

    index: int
    name: str
    range: Range = field(default=None, compare=False)

    def __str__(self) -> str:
        return name_text(self.name)


@dataclass(frozen=True, slots=True)
class Advice(Signal):
    """What an adviser answers, which is perceived like a signal; named adviser/question/digest."""

    def __str__(self) -> str:
        return f"advice({', '.join(map(repr, self.name.split('/')))})"


@dataclass(frozen=True, slots=True)
class Prediction:
    """What another question answers in this tick."""

    name: str

    def __str__(self) -> str:
        return f"prediction({self.name!r})"


@dataclass(frozen=True, slots=True)
class SquaredError:
    """δ² of another question's learning in this tick."""

    name: str

    def __str__(self) -> str:
        return f"delta2({self.name!r})"


@dataclass(frozen=True, slots=True)
class Call:
    """A function of other nodes. Equal calls remember the same, so one memory serves them all."""

    function: str
    arguments: "tuple[Node, ...]"
    range: Range = field(default=None, compare=False)
    size: int = field(default=1, compare=False)  # nodes, itself included
    depth: int = field(default=1, compare=False)

    def __str__(self) -> str:
        arguments = [str(argument) for argument in self.arguments]
        if self.function in OPERATORS:
            return f"({f' {self.function} '.join(arguments)})"
        if self.function == NEGATIVE:
            return f"(-{arguments[0]})"
        return f"{self.function}({', '.join(arguments)})"


Node: TypeAlias = Number | Signal | Prediction | SquaredError | Call


def call(function: str, arguments: Sequence[Node]) -> Node:
    """The node of a function; of numbers alone, the number that it gives, if it is finite."""
    numbers = [node.value for node in arguments if isinstance(node, Number)]
    if function in PURE and len(numbers) == len(arguments):
        value = PURE[function](*numbers)
        if math.isfinite(value):
            return Number(value)
    return Call(
        function,
        tuple(arguments),
        _bounded(RANGES[function]([range_of(node) for node in arguments])),
        1 + sum(node.size if isinstance(node, Call) else 1 for node in arguments),
        1 + max(node.depth if isinstance(node, Call) else 1 for node in arguments),
    )


def range_of(node: Node) -> Range:
    """Where its value is expected to lie, as far as that is known."""
    if isinstance(node, Number):
        return node.value, node.value
    return node.range if isinstance(node, Signal | Call) else None


def name_text(name: str) -> str:
    """A signal's name as an expression says it: in quotes, if Python's grammar has other plans for it."""
    plain = all(part.isidentifier() and not iskeyword(part) for part in name.split("."))
    return name if plain else repr(name)


def _divided(a: float, b: float) -> float:
    return a / b if b else math.nan


def _least(*values: float) -> float:
    return math.nan if any(map(math.isnan, values)) else min(values)


def _greatest(*values: float) -> float:
    return math.nan if any(map(math.isnan, values)) else max(values)


def _clip(x: float, low: float, high: float) -> float:
    return _least(_greatest(x, low), high)


def _norm(x: float, low: float, high: float) -> float:
    return math.nan if math.isnan(x) else min(max((x - low) / (high - low), 0.0), 1.0)


def _logistic(x: float, k: float, middle: float) -> float:
    """1 / (1 + exp(−k (x − x0))), thesis (6.7), in a form that overflows nowhere."""
    return 0.5 * (1 + math.tanh(0.5 * k * (x - middle)))


def _truth(known: float, truth: bool) -> float:
    return math.nan if math.isnan(known) else float(truth)


NEGATIVE = "negative"
OPERATORS = ("+", "-", "*", "/")

PURE: Mapping[str, Callable[..., float]] = MappingProxyType(
    {
        "+": lambda a, b: a + b,
        "-": lambda a, b: a - b,
        "*": lambda a, b: a * b,
        "/": _divided,
        NEGATIVE: lambda x: -x,
        "square": lambda x: x * x,
        "abs": abs,
        "min": _least,
        "max": _greatest,
        "clip": _clip,
        "norm": _norm,
        "logistic": _logistic,
        "above": lambda x, bound: _truth(x + bound, x > bound),
        "below": lambda x, bound: _truth(x + bound, x < bound),
        "near": lambda x, y, tolerance: _truth(x + y + tolerance, abs(x - y) <= tolerance),
    }
)
"""Functions of this tick's values alone. NaN makes NaN, and so does a division by zero."""

MEMORIES = ("diff", "trace", "delay")
"""Functions of the first argument's past as well: `bentod.learn.traces`."""


def _bounded(found: Range) -> Range:
    return found if found and math.isfinite(found[0]) and math.isfinite(found[1]) else None


def _corners(function: Callable[[float, float], float]) -> Callable[[Sequence[Range]], Range]:
    """Of a function of two that is monotonic in both."""

    def of(ranges: Sequence[Range]) -> Range:
        first, second = ranges
        if first is None or second is None:
            return None
        values = [function(a, b) for a in first for b in second]
        return _least(*values), _greatest(*values)

    return of


def _quotient(ranges: Sequence[Range]) -> Range:
    divisor = ranges[1]
    if divisor is None or divisor[0] <= 0 <= divisor[1]:
        return None
    return _corners(_divided)(ranges)


def _mirrored(ranges: Sequence[Range]) -> Range:
    found = ranges[0]
    return (-found[1], -found[0]) if found else None


def _magnitude(ranges: Sequence[Range]) -> Range:
    found = ranges[0]
    return (max(found[0], -found[1], 0.0), max(found[1], -found[0])) if found else None


def _squared(ranges: Sequence[Range]) -> Range:
    found = _magnitude(ranges)
    return (found[0] * found[0], found[1] * found[1]) if found else None


def _extreme(pick: Callable[..., float]) -> Callable[[Sequence[Range]], Range]:
    def of(ranges: Sequence[Range]) -> Range:
        known = [found for found in ranges if found]
        if len(known) < len(ranges):
            return None
        return pick(low for low, _ in known), pick(high for _, high in known)

    return of


def _clipped(ranges: Sequence[Range]) -> Range:
    x, low, high = ranges
    if low is None or high is None:
        return None
    least, most = x or (low[0], high[1])
    return _clip(least, low[0], high[0]), _clip(most, low[1], high[1])


def _changed(ranges: Sequence[Range]) -> Range:
    found = ranges[0]
    return (found[0] - found[1], found[1] - found[0]) if found else None


def _share(_: Sequence[Range]) -> Range:
    return 0.0, 1.0


RANGES: Mapping[str, Callable[[Sequence[Range]], Range]] = MappingProxyType(
    {
        "+": _corners(lambda a, b: a + b),
        "-": _corners(lambda a, b: a - b),
        "*": _corners(lambda a, b: a * b),
        "/": _quotient,
        NEGATIVE: _mirrored,
        "square": _squared,
        "abs": _magnitude,
        "min": _extreme(min),
        "max": _extreme(max),
        "clip": _clipped,
        **dict.fromkeys(("norm", "logistic", "above", "below", "near"), _share),
        "diff": _changed,
        "trace": lambda ranges: ranges[0],
        "delay": lambda ranges: ranges[0],
    }
)
"""Where a function's value lies, from where its arguments do."""
