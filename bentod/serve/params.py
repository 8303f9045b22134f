"""Parameters of a method: what each may be, and a sentence for the client when it is not."""

import math
import reprlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal, TypeAlias

from bentod.errors import BadRequest
from bentod.frames import Value
from bentod.messages import pack

MOST_ITEMS = 64
"""Of a list of names or numbers."""


@dataclass(frozen=True, slots=True)
class Number:
    """A finite number between two bounds, both allowed."""

    unit: str = ""
    minimum: float = -math.inf
    maximum: float = math.inf
    doc: str = ""


@dataclass(frozen=True, slots=True)
class Text:
    """A text, perhaps one of a few."""

    doc: str = ""
    max_length: int = 128
    choices: tuple[str, ...] = ()
    secret: bool = False  # never shown, not even to whoever sent it


@dataclass(frozen=True, slots=True)
class Flag:
    """True or false."""

    doc: str = ""


@dataclass(frozen=True, slots=True)
class Free:
    """Anything that a message can hold, up to a size in bytes of MessagePack."""

    doc: str = ""
    max_bytes: int = 4096


Note: TypeAlias = Number | Text | Flag | Free
Kind: TypeAlias = Literal["number", "integer", "text", "flag", "any"]


@dataclass(frozen=True, slots=True)
class Param:
    """One parameter of one method."""

    name: str
    kind: Kind
    note: Note
    one: bool  # a bare value will do
    many: bool  # a list of values will do
    nullable: bool
    required: bool
    default: Value = None

    def check(self, value: Value) -> Value:
        """`value` as the handler gets it; nil stands for the default of a parameter that has one.

        Raises:
            BadRequest: it is of another type or beyond a bound.
        """
        if self.kind == "any":
            return self._item(value)
        if value is None and (self.nullable or not self.required):
            return None if self.nullable else self.default
        if self.many and isinstance(value, list):
            return self._items(value)
        if self.many and not self.one:
            raise self.wrong(f"must be a list of {_NOUNS[self.kind]}s, not {shown(value)}")
        return self._item(value)

    def _items(self, values: list[Value]) -> list[Value]:
        if len(values) > MOST_ITEMS:
            raise self.wrong(f"has {len(values)} entries, more than {MOST_ITEMS}")
        return [self._item(value) for value in values]

    def _item(self, value: Value) -> Value:
        return _CHECKS[self.kind](self, value)

    def wrong(self, what: str) -> BadRequest:
        """The error that says what this parameter is but may not be."""
        return BadRequest(f"{self.name} {what}.", self.name)

    @property
    def type(self) -> str:
        """The type in words, e.g. "text, list of text or nil"."""
        words = [self.kind] * self.one + [f"list of {self.kind}"] * self.many + ["nil"] * self.nullable
        return " or ".join(filter(None, (", ".join(words[:-1]), words[-1])))

    def describe(self) -> dict[str, Value]:
        """Plain data for `list_methods`; a bound or default that does not exist is absent."""
        entry: dict[str, Value] = {"name": self.name, "type": self.type, "required": self.required}
        if not self.required:
            entry["default"] = self.default
        return entry | _described(self.note)


def _described(note: Note) -> dict[str, Value]:
    entry: dict[str, Value] = {"doc": note.doc}
    if isinstance(note, Number):
        bounds: Mapping[str, Value] = {"minimum": note.minimum, "maximum": note.maximum}
        entry |= {"unit": note.unit} | {name: bound for name, bound in bounds.items() if _finite(bound)}
    if isinstance(note, Text):
        entry |= {"choices": list(note.choices)} if note.choices else {"max_length": note.max_length}
    if isinstance(note, Free):
        entry["max_bytes"] = note.max_bytes
    return entry


def _finite(value: Value) -> bool:
    return isinstance(value, int | float) and math.isfinite(value)


def shown(value: Value) -> str:
    """`value`, shortened, for a sentence."""
    return "nil" if value is None else reprlib.repr(value)


def _number(param: Param, value: Value) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise param.wrong(f"must be a number{_in_unit(param)}, not {shown(value)}")
    if not math.isfinite(value):
        raise param.wrong(f"must be a finite number{_in_unit(param)}, not {value}")
    _check_bounds(param, value)
    return float(value)


def _integer(param: Param, value: Value) -> int:
    if isinstance(value, bool) or not isinstance(value, int):
        raise param.wrong(f"must be a whole number{_in_unit(param)}, not {shown(value)}")
    _check_bounds(param, value)
    return value


def _in_unit(param: Param) -> str:
    return f" in {param.note.unit}" if isinstance(param.note, Number) and param.note.unit else ""


def _check_bounds(param: Param, value: float) -> None:
    note = param.note
    if not isinstance(note, Number) or note.minimum <= value <= note.maximum:
        return
    unit = f" {note.unit}" if note.unit else ""
    if value < note.minimum:
        raise param.wrong(f"= {value:g}{unit} is below its minimum, {note.minimum:g}{unit}")
    raise param.wrong(f"= {value:g}{unit} is above its maximum, {note.maximum:g}{unit}")


def _text(param: Param, value: Value) -> str:
    if not isinstance(value, str):
        secret = isinstance(param.note, Text) and param.note.secret
        raise param.wrong(f"must be a {_NOUNS['text']}" + ("" if secret else f", not {shown(value)}"))
    if not isinstance(param.note, Text):
        return value
    if len(value) > param.note.max_length:
        raise param.wrong(f"has {len(value)} characters, more than {param.note.max_length}")
    if param.note.choices and value not in param.note.choices:
        raise param.wrong(f"must be one of {', '.join(param.note.choices)}, not {shown(value)}")
    return value


def _flag(param: Param, value: Value) -> bool:
    if not isinstance(value, bool):
        raise param.wrong(f"must be {_NOUNS['flag']}, not {shown(value)}")
    return value


def _any(param: Param, value: Value) -> Value:
    size = len(pack(value))
    if isinstance(param.note, Free) and size > param.note.max_bytes:
        raise param.wrong(f"takes {size} bytes, more than {param.note.max_bytes}")
    return value


_NOUNS: Mapping[Kind, str] = {
    "number": "number",
    "integer": "whole number",
    "text": "text",
    "flag": "true or false",
    "any": "value",
}

_CHECKS: Mapping[Kind, Callable[[Param, Value], Value]] = {
    "number": _number,
    "integer": _integer,
    "text": _text,
    "flag": _flag,
    "any": _any,
}
