"""Methods made from typed functions: one function gives the name, the checks and the description."""

import inspect
from collections.abc import Awaitable, Callable, Iterable, Mapping
from dataclasses import dataclass, field
from types import NoneType, UnionType
from typing import Annotated, TypeAlias, Union, get_args, get_origin

from bentod.errors import BadRequest, nearest
from bentod.frames import Value
from bentod.serve.params import Flag, Free, Kind, Note, Number, Param, Text, shown
from bentod.serve.peers import Role

Handler: TypeAlias = Callable[..., Awaitable[object]]
"""`async def name(session, …)`: a function or a bound method; what it returns is packed into the answer."""


@dataclass(frozen=True, slots=True)
class Method:
    """One entry of the table."""

    name: str
    doc: str  # what it does, in one sentence
    details: str  # the rest of the docstring
    params: tuple[Param, ...]
    handler: Handler
    role: Role = Role.OBSERVER  # that a client needs

    async def __call__(self, session: object, params: Value) -> object:
        """Check `params` and run the handler.

        Raises:
            BentodError: BadRequest for the parameters, or whatever the handler raises.
        """
        return await self.handler(session, *self.bind(params))

    def bind(self, params: Value) -> list[Value]:
        """Checked values in the table's order, from an array, one map of names, or an array of one such map.

        Raises:
            BadRequest: a parameter is missing, unknown, of another type or beyond a bound.
        """
        given = self._by_name(params)
        return [self._value(param, given) for param in self.params]

    def _by_name(self, params: Value) -> dict[str, Value]:
        match params:
            case None:
                return {}
            case dict():
                return self._known(params)
            case [dict() as named] if not self.params or self.params[0].kind != "any":
                return self._known(named)
            case list():
                return self._in_order(params)
        raise BadRequest(
            f"The parameters of {self.name} are an array or a map of names, not {shown(params)}.", "params"
        )

    def _known(self, named: dict[str, Value]) -> dict[str, Value]:
        names = [param.name for param in self.params]
        for name in named:
            if name not in names:
                raise BadRequest(f"{self.name} has no parameter {name}{nearest(name, names)}", name)
        return named

    def _in_order(self, values: list[Value]) -> dict[str, Value]:
        if len(values) > len(self.params):
            raise BadRequest(
                f"{self.name} takes at most {len(self.params)} parameters, not {len(values)}.", "params"
            )
        return {param.name: value for param, value in zip(self.params, values, strict=False)}

    def _value(self, param: Param, given: Mapping[str, Value]) -> Value:
        if param.name in given:
            return param.check(given[param.name])
        if param.required:
            raise BadRequest(f"{self.name} needs the parameter {param.name}.", param.name)
        return param.default

    def describe(self) -> dict[str, Value]:
        """Plain data for `list_methods`."""
        return {
            "name": self.name,
            "role": self.role,
            "doc": self.doc,
            "details": self.details,
            "parameters": [param.describe() for param in self.params],
        }


def method(handler: Handler, role: Role = Role.OBSERVER) -> Method:
    """The table's entry for `handler`, which needs `role`.

    Raises:
        TypeError: its signature cannot be checked or described.
    """
    name = str(getattr(handler, "__name__", ""))
    parameters = list(inspect.signature(handler).parameters.values())
    if not parameters or parameters[0].name != "session":
        raise TypeError(f"The first parameter of {name} must be the session.")
    doc, _, details = (inspect.getdoc(handler) or "").partition("\n\n")
    if not doc:
        raise TypeError(f"{name} needs a docstring: it is what clients read.")
    params = tuple(_param(name, parameter) for parameter in parameters[1:])
    return Method(name, " ".join(doc.split()), details, params, handler, role)


def table(*, observer: Iterable[Handler] = (), operator: Iterable[Handler] = ()) -> dict[str, Method]:
    """Methods by name, in the given order: open to whoever may connect, and to operators only."""
    methods = [method(handler) for handler in observer]
    methods += [method(handler, Role.OPERATOR) for handler in operator]
    named = {entry.name: entry for entry in methods}
    if len(named) < len(methods):
        raise TypeError("Two methods have the same name.")
    return named


def find(methods: Mapping[str, Method], name: str) -> Method:
    """The method called `name`.

    Raises:
        BadRequest: there is none.
    """
    if name not in methods:
        raise BadRequest(f"There is no method {shown(name)}{nearest(name, methods)}", "method")
    return methods[name]


@dataclass(slots=True)
class _Shape:
    """What an annotation says, gathered while walking through it."""

    kinds: set[Kind] = field(default_factory=set)
    notes: list[Note] = field(default_factory=list)
    one: bool = False
    many: bool = False
    nullable: bool = False


_KINDS: Mapping[object, Kind] = {float: "number", int: "integer", str: "text", bool: "flag"}
_NOTES: Mapping[Kind, Callable[[], Note]] = {
    "number": Number,
    "integer": Number,
    "text": Text,
    "flag": Flag,
    "any": Free,
}


def _param(owner: str, parameter: inspect.Parameter) -> Param:
    shape = _Shape()
    positional = parameter.kind is inspect.Parameter.POSITIONAL_OR_KEYWORD
    if not positional or not _walk(parameter.annotation, shape) or len(shape.kinds) != 1:
        raise TypeError(f"{owner}: a client cannot give {parameter}.")
    (kind,) = shape.kinds
    expected = _NOTES[kind]
    note = shape.notes[0] if shape.notes else expected()
    if len(shape.notes) > 1 or expected is not type(note):
        raise TypeError(f"{owner}: the notes on {parameter.name} do not fit its type.")
    required = parameter.default is inspect.Parameter.empty
    default = None if required else parameter.default
    return Param(parameter.name, kind, note, shape.one, shape.many, shape.nullable, required, default)


def _walk(annotation: object, shape: _Shape, in_list: bool = False) -> bool:
    """Gather what `annotation` says; false when it says something that no message can hold."""
    origin, inner = get_origin(annotation), get_args(annotation)
    if origin is Annotated:
        return _walk_noted(inner[0], inner[1], shape, in_list)
    if origin in (Union, UnionType) and not in_list:
        return all(_walk(member, shape) for member in inner)
    if origin is list and not in_list:
        return _walk(inner[0], shape, in_list=True)
    if annotation in (None, NoneType) and not in_list:
        shape.nullable = True
        return True
    kind = "any" if annotation == Value else _KINDS.get(annotation)
    return kind is not None and _gather(kind, shape, in_list)


def _walk_noted(annotation: object, note: Note, shape: _Shape, in_list: bool) -> bool:
    shape.notes.append(note)
    if isinstance(note, Free):  # the annotation is Value, a name that only its own module can resolve
        return _gather("any", shape, in_list)
    return _walk(annotation, shape, in_list)


def _gather(kind: Kind, shape: _Shape, in_list: bool) -> bool:
    shape.kinds.add(kind)
    shape.one |= not in_list
    shape.many |= in_list
    return True
