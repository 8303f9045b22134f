"""Many expressions at once, tick by tick: what they have in common is worked out and remembered once."""

import hashlib
import math
from collections.abc import Callable, Mapping, Sequence
from typing import Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from bentod.learn.expression import Expression
from bentod.learn.expression_nodes import PURE, Call, Node, Number, Prediction, Signal, SquaredError
from bentod.learn.traces import Delay, Difference, HistoryTrace, Memory

_Places: TypeAlias = NDArray[np.intp]
_STEPS = 0  # the slot that holds how many ticks have passed


class Told(Protocol):
    """What other questions have answered and learned in this tick; NaN: nothing."""

    def prediction(self, name: str) -> float:
        """The answer of the question `name`."""
        ...

    def squared_error(self, name: str) -> float:
        """Its δ²."""
        ...


class Nobody:
    """No question has answered anything."""

    def prediction(self, name: str) -> float:
        """NaN."""
        return math.nan

    def squared_error(self, name: str) -> float:
        """NaN."""
        return math.nan


_NOBODY = Nobody()


class Program:
    """Evaluates `expressions`, in their order. Equal parts of them are one, and share what they remember."""

    def __init__(self, expressions: Sequence[Expression]) -> None:
        self._values = [1.0]  # by slot
        self._slots: dict[Node, int] = {}
        self._perceived: list[tuple[int, int]] = []  # (slot, signal)
        self._predicted: list[tuple[int, str]] = []  # (slot, question)
        self._squared: list[tuple[int, str]] = []
        self._calls: list[tuple[int, Callable[..., float], tuple[int, ...]]] = []  # (slot, function, slots)
        self._memories: dict[str, Memory] = {}
        self._size = len(expressions)
        signals = [(place, it.signal) for place, it in enumerate(expressions) if it.signal is not None]
        made = [(place, self._slot(it.node)) for place, it in enumerate(expressions) if it.signal is None]
        self._plain, self._signals = _columns(signals)
        self._made, results = _columns(made)
        self._results: list[int] = results.tolist()

    def evaluate(
        self, signals: NDArray[np.float64], told: Told = _NOBODY, steps: int = 1
    ) -> NDArray[np.float64]:
        """The values in this tick, shape (expressions,); to be called once for each tick, in order.

        `signals`: as in the vocabulary that the expressions were parsed with. `steps`: ticks since the last
        call; 0: what came before has nothing to do with this tick, and is forgotten.
        """
        if not steps:
            self.restart()
        found = np.empty(self._size)
        found[self._plain] = signals[self._signals]
        if self._results:
            self._work(signals, told, max(steps, 1))
            found[self._made] = [self._values[slot] for slot in self._results]
        return found

    def restart(self) -> None:
        """Forget what was remembered: the next tick is the first."""
        for memory in self._memories.values():
            memory.restart()

    def memory(self) -> dict[str, NDArray[np.float64]]:
        """Copies of all that is remembered, named after what it is of."""
        return {name: memory.memory() for name, memory in self._memories.items()}

    def recall(self, memory: Mapping[str, NDArray[np.float64]]) -> None:
        """Remember it again. Raises ValueError: it is not that of these expressions."""
        if set(memory) != set(self._memories):
            raise ValueError(f"{len(self._memories)} memories were expected, not these {len(memory)}.")
        for name, array in memory.items():
            self._memories[name].recall(array)

    def _work(self, signals: NDArray[np.float64], told: Told, steps: int) -> None:
        values = self._values
        values[_STEPS] = steps
        for slot, index in self._perceived:
            values[slot] = float(signals[index])
        for slot, name in self._predicted:
            values[slot] = told.prediction(name)
        for slot, name in self._squared:
            values[slot] = told.squared_error(name)
        for slot, function, arguments in self._calls:
            values[slot] = function(*[values[argument] for argument in arguments])

    def _slot(self, node: Node) -> int:
        """Where the value of a node is found; its arguments' come first."""
        if node not in self._slots:
            arguments = [self._slot(part) for part in node.arguments] if isinstance(node, Call) else []
            slot = len(self._values)
            self._values.append(node.value if isinstance(node, Number) else math.nan)
            self._slots[node] = slot
            if isinstance(node, Signal):
                self._perceived.append((slot, node.index))
            elif isinstance(node, Prediction):
                self._predicted.append((slot, node.name))
            elif isinstance(node, SquaredError):
                self._squared.append((slot, node.name))
            elif isinstance(node, Call):
                self._calls.append((slot, *self._prepared(node, arguments)))
        return self._slots[node]

    def _prepared(self, node: Call, arguments: Sequence[int]) -> tuple[Callable[..., float], tuple[int, ...]]:
        """What to call for a node, and with which slots."""
        if node.function in PURE:
            return PURE[node.function], tuple(arguments)
        memory = _remembering(node)
        self._memories[_title(node)] = memory
        return memory.step, (arguments[0], _STEPS)


def _remembering(node: Call) -> Memory:
    if node.function == "diff":
        return Difference()
    constant = node.arguments[1]
    if not isinstance(constant, Number):
        raise TypeError(f"{node} must have a constant, which the parser sees to.")
    return HistoryTrace(constant.value) if node.function == "trace" else Delay(int(constant.value))


def _title(node: Call) -> str:
    """A name that only equal nodes have, whatever else there is to remember."""
    return f"{node.function}.{hashlib.sha256(str(node).encode()).hexdigest()[:16]}"


def _columns(pairs: Sequence[tuple[int, int]]) -> tuple[_Places, _Places]:
    both = np.array(pairs, dtype=np.intp).reshape(-1, 2)
    return both[:, 0].copy(), both[:, 1].copy()
