"""Expressions of the state, as configs and clients write them: a small language in Python's grammar.

Numbers, names of signals, definitions, + - * /, and

| function | value |
|---|---|
| `abs(x)`, `square(x)`, `min(x, y, …)`, `max(x, y, …)` | as in mathematics |
| `clip(x, low, high)` | x, kept within the two |
| `norm(x)`, `norm(x, low, high)` | x over its known, or the given, range: 0..1, kept within |
| `logistic(x, k, x0)` | 1 / (1 + exp(−k (x − x0))), between 0 and 1 |
| `above(x, bound)`, `below(x, bound)`, `near(x, y, tolerance)` | 1 if it is, else 0 |
| `diff(x)` | change per tick |
| `trace(x, xi)` | fading trace (thesis 4.7) |
| `delay(x, n)` | x as it was n ticks ago |
| `prediction("name")` | what another question answers in this tick |
| `delta2("name")` | δ² of another question's learning in this tick |
| `advice("adviser", "name")` | what one of `learn.advisers` answers in this tick |

What is not known is NaN, and so is all that is made of it; so is a division by zero. No text is executed.
"""

import ast
import math
import warnings
from collections.abc import Collection, Mapping
from copy import copy
from dataclasses import dataclass

from bentod.errors import ConfigError, nearest
from bentod.learn.expression_advice import advice
from bentod.learn.expression_arguments import ARGUMENTS, checked
from bentod.learn.expression_nodes import (
    NEGATIVE,
    PURE,
    Call,
    Node,
    Number,
    Prediction,
    Signal,
    SquaredError,
    call,
    range_of,
)
from bentod.learn.signals import Named, Range

LENGTH = 600  # characters; a config allows 500, and a companion adds a few
DEPTH = 64  # of functions and definitions inside one another
NODES = 1000  # definitions written out

_EXAMPLE = 'prediction("elbow.position@20")'
_OPERATORS = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/"}
_INSTEAD: Mapping[type[ast.AST], str] = {
    ast.Compare: "a comparison is written above(x, bound), below(x, bound) or near(x, y, tolerance)",
    ast.BoolOp: "'and' is written min(x, y) and 'or' max(x, y)",
    ast.Not: "'not x' is written 1 - x",
    ast.Pow: "a power is written square(x) or x * x",
    ast.MatMult: f"a name with @ in it is that of a question, and is written in quotes: {_EXAMPLE}",
    ast.Starred: "a star stands for many signals, which only a name by itself may",
    ast.Subscript: "names are joined with dots, not with brackets",
}


class Vocabulary:
    """What expressions may speak of: `signals`, names in `define`, and questions as `asking` tells.

    Raises:
        ConfigError: a definition is wrong, is made from itself, or has the name of a signal.
    """

    def __init__(self, signals: Named, define: Mapping[str, str] = {}) -> None:
        self.names = signals.names
        self.signals = signals
        self._nodes: dict[str, Node] = {
            name: Signal(index, name, signals.range(name)) for index, name in enumerate(signals.names)
        }
        self._questions: frozenset[str] | None = None
        self._define = dict(define)
        self._open: list[str] = []
        for name in self._define:
            if name in self._nodes or name in ARGUMENTS:
                what = "signal" if name in self._nodes else "function"
                raise ConfigError(f"learn.define.{name}: is the name of a {what} already")
        for name in self._define:
            self.node(name, 0)

    def asking(self, questions: Collection[str]) -> "Vocabulary":
        """The same, and only these `questions` have predictions; before, any name is taken for one."""
        vocabulary = copy(self)
        vocabulary._questions = frozenset(questions)
        return vocabulary

    def __contains__(self, name: str) -> bool:
        return name in self._nodes or name in self._define

    def node(self, name: str, depth: int) -> Node:
        """What a known name stands for; `depth`: of the expression that uses it."""
        if name not in self._nodes:
            self._nodes[name] = self._defined(name, depth)
        return self._nodes[name]

    def asked(self, name: str) -> str:
        """The name of a question. Raises ConfigError: it is not one."""
        if self._questions is not None and name not in self._questions:
            raise ConfigError(f"there is no question '{name}'{_brief(nearest(name, self._questions))}")
        return name

    def unknown(self, name: str) -> str:
        """The end of a sentence about a name that is not known."""
        return _brief(nearest(name, [*self.names, *self._define]))

    def _defined(self, name: str, depth: int) -> Node:
        where = f"learn.define.{name}: "
        if name in self._open:
            path = " -> ".join([*self._open[self._open.index(name) :], name])
            raise ConfigError(f"{where}is made from itself: {path}")
        if depth > DEPTH:
            raise ConfigError(f"{where}goes deeper than {DEPTH} definitions")
        self._open.append(name)
        try:
            return _Parser(self._define[name], self).parse(depth)
        except ConfigError as error:
            told = str(error)
            raise ConfigError(told if told.startswith("learn.define.") else where + told) from error
        finally:
            self._open.pop()


def _brief(said: str) -> str:
    """A list of all that is known helps only while it is short."""
    return said if len(said) <= 400 else ""


@dataclass(frozen=True, slots=True)
class Expression:
    """A number that can be told of each tick. `str` writes it out: definitions, ranges and all brackets."""

    node: Node

    @classmethod
    def parse(cls, text: str, vocabulary: Vocabulary) -> "Expression":
        """Raises ConfigError: a sentence that says what is wrong, and at which column of the text."""
        return cls(_Parser(text, vocabulary).parse(0))

    def __str__(self) -> str:
        return str(self.node)

    @property
    def signal(self) -> int | None:
        """The place of the signal that it is, if it is just one."""
        return self.node.index if isinstance(self.node, Signal) else None

    @property
    def predictions(self) -> frozenset[str]:
        """The other questions that must have learned and been answered before it can be told."""
        return frozenset(_asked(self.node))

    def range(self) -> Range:
        """Where its values are expected to lie, as far as that is known."""
        return range_of(self.node)


def _asked(node: Node) -> set[str]:
    if isinstance(node, Call):
        return set().union(*map(_asked, node.arguments))
    return {node.name} if isinstance(node, Prediction | SquaredError) else set()


class _Parser:
    """Reads one text."""

    def __init__(self, text: str, vocabulary: Vocabulary) -> None:
        self._text = text
        self._line = "".join(" " if letter.isspace() else letter for letter in text).lstrip()
        self._indent = len(text) - len(self._line)
        self._vocabulary = vocabulary

    def parse(self, depth: int) -> Node:
        if len(self._text) > LENGTH:
            raise ConfigError(f"an expression has at most {LENGTH} characters, not {len(self._text)}")
        if self._text in self._vocabulary:
            return self._vocabulary.node(self._text, depth + 1)
        return self._node(self._tree(), depth)

    def _tree(self) -> ast.expr:
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                return ast.parse(self._line, mode="eval").body
        except SyntaxError as error:
            raise self._error(error.msg, (error.offset or 1) - 1) from None
        except (ValueError, MemoryError, RecursionError, Warning) as error:
            raise self._error(str(error) or "too deep", 0) from None

    def _node(self, tree: ast.expr, depth: int) -> Node:
        if depth > DEPTH:
            raise self._refused(tree, f"goes deeper than {DEPTH}, definitions included")
        if isinstance(tree, ast.Constant):
            return self._constant(tree, depth)
        if isinstance(tree, ast.Name | ast.Attribute):
            return self._named(self._dotted(tree), tree, depth)
        if isinstance(tree, ast.UnaryOp) and isinstance(tree.op, ast.USub | ast.UAdd):
            operand = self._node(tree.operand, depth + 1)
            return operand if isinstance(tree.op, ast.UAdd) else self._call(NEGATIVE, [operand], tree)
        if isinstance(tree, ast.BinOp) and type(tree.op) in _OPERATORS:
            sides = [self._node(side, depth + 1) for side in (tree.left, tree.right)]
            return self._call(_OPERATORS[type(tree.op)], sides, tree)
        if isinstance(tree, ast.Call):
            return self._function(tree, depth)
        kinds = [type(tree), *(type(part) for part in ast.iter_child_nodes(tree))]
        hints = [_INSTEAD[kind] for kind in kinds if kind in _INSTEAD]
        raise self._refused(
            tree, hints[0] if hints else "only numbers, names, + - * / and functions are known"
        )

    def _constant(self, tree: ast.Constant, depth: int) -> Node:
        if isinstance(tree.value, str):
            return self._named(tree.value, tree, depth)
        if isinstance(tree.value, bool) or not isinstance(tree.value, int | float):
            raise self._refused(tree, f"{str(tree.value)[:32]!r} is not a number")
        try:
            value = float(tree.value)
        except OverflowError:
            value = math.inf
        if not math.isfinite(value):
            raise self._refused(tree, "the number is too big")
        return Number(value)

    def _named(self, name: str, tree: ast.expr, depth: int) -> Node:
        if name in ARGUMENTS:
            raise self._refused(tree, f"'{name}' is a function and needs arguments in brackets")
        if name not in self._vocabulary:
            raise self._refused(tree, f"unknown name '{name}'{self._vocabulary.unknown(name)}")
        return self._vocabulary.node(name, depth + 1)

    def _dotted(self, tree: ast.expr) -> str:
        parts: list[str] = []
        while isinstance(tree, ast.Attribute):
            parts.append(tree.attr)
            tree = tree.value
        if not isinstance(tree, ast.Name):
            raise self._refused(tree, "a dot stands within a name, and brackets behind that of a function")
        return ".".join([tree.id, *reversed(parts)])

    def _function(self, tree: ast.Call, depth: int) -> Node:
        name = self._dotted(tree.func)
        if name not in ARGUMENTS:
            raise self._refused(tree, f"unknown function '{name}'{nearest(name, ARGUMENTS)}")
        least, most = ARGUMENTS[name]
        if tree.keywords or not least <= len(tree.args) <= most:
            many = f"{least}" if least == most else f"{least} to {most}"
            raise self._refused(tree, f"{name} takes {many} arguments in order, without names")
        if name in ("prediction", "delta2"):
            return (Prediction if name == "prediction" else SquaredError)(self._other(tree.args[0]))
        if name == "advice":
            return self._advice(tree)
        arguments = [self._node(argument, depth + 1) for argument in tree.args]
        try:
            return self._call(name, checked(name, arguments), tree)
        except ConfigError as error:
            raise self._refused(tree, str(error)) from None

    def _advice(self, tree: ast.Call) -> Node:
        try:
            return advice(self._vocabulary.signals, [getattr(it, "value", None) for it in tree.args])
        except ConfigError as error:
            raise self._refused(tree, str(error)) from None

    def _other(self, tree: ast.expr) -> str:
        if isinstance(tree, ast.Constant) and isinstance(tree.value, str):
            name = tree.value
        elif isinstance(tree, ast.Name | ast.Attribute):
            name = self._dotted(tree)
        else:
            raise self._refused(tree, f"needs the name of a question, in quotes: {_EXAMPLE}")
        try:
            return self._vocabulary.asked(name)
        except ConfigError as error:
            raise self._refused(tree, str(error)) from None

    def _call(self, name: str, arguments: list[Node], tree: ast.expr) -> Node:
        node = call(name, arguments)
        if isinstance(node, Call):
            if name in PURE and all(isinstance(argument, Number) for argument in arguments):
                raise self._refused(tree, f"{str(node)[:80]} is not a finite number")
            if node.depth > DEPTH:
                raise self._refused(tree, f"goes deeper than {DEPTH}, definitions included")
            if node.size > NODES:
                raise self._refused(tree, f"has more than {NODES} parts, definitions written out")
        return node

    def _refused(self, tree: ast.expr, why: str) -> ConfigError:
        before = self._line.encode("utf-8")[: tree.col_offset].decode("utf-8", "ignore")
        return self._error(why, len(before))

    def _error(self, why: str, place: int) -> ConfigError:
        shown = self._text if len(self._text) <= 80 else f"{self._text[:80]}…"
        return ConfigError(f"column {self._indent + place + 1} of {shown!r}: {why}")
