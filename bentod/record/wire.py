"""Encoders made from the tables of `schema`: protobuf's wire format, in a few microseconds a message.

A frame has some 300 fields. Filling protobuf's own objects with them takes about four times as long, and for
all of that time nobody else can run Python, the tick included. Numbers have a fixed size on the wire, so all
those of a message are packed by one call, zeros too; text that was seen before is not encoded again.
https://protobuf.dev/programming-guides/encoding/
"""

import dataclasses
import struct
from collections.abc import Callable, Iterable, Mapping
from typing import TypeAlias, cast

from bentod.frames import Value
from bentod.record.field import SCALARS, Field, Kind, Message
from bentod.record.plain import to_json
from bentod.record.schema import ENUMS, MESSAGES

Encode: TypeAlias = Callable[[object], bytes]
"""A value to bytes: a whole message, or one field with its tag."""

_FIXED, _VARINT, _SIZED = 1, 0, 2
"""Wire types: 8 bytes, a varint, and bytes after their length."""

_FORMATS = {Kind.DOUBLE: ("d", _FIXED), Kind.INT: ("q", _FIXED), Kind.BOOL: ("?", _VARINT)}

_KNOWN_TEXTS = 1024
_KNOWN_LENGTH = 200

_double = struct.Struct("<d").pack


def varint(number: int) -> bytes:
    """A number of 0 or more, seven bits a byte, the lowest first."""
    made = bytearray()
    while number > 127:
        made.append(number & 127 | 128)
        number >>= 7
    made.append(number)
    return bytes(made)


_LENGTHS = tuple(map(varint, range(4096)))


def tag(number: int, wire: int) -> bytes:
    """What stands before a field."""
    return varint(number << 3 | wire)


def sized(start: bytes, data: bytes) -> bytes:
    """A field that tells its length."""
    length = len(data)
    return start + (_LENGTHS[length] if length < len(_LENGTHS) else varint(length)) + data


def encoder(name: str) -> Encode:
    """The encoder of the message `name`; it tells the classes apart that the message may hold.

    What it makes raises TypeError, AttributeError or struct.error for a value that does not fit the table.
    """
    message = MESSAGES[name]
    if len(message.classes) == 1:
        return encode_fields(message.fields)
    made = {cls: _member(message, cls) for cls in message.classes}
    return lambda value: made[type(value)](value)


def _member(message: Message, cls: type) -> Encode:
    """One class of several: what its `kind` says never changes, and only its own fields are written."""
    first, *rest = message.fields
    names = {field.name: field for field in dataclasses.fields(cls)}
    kind = _enum(first)(names[first.name].default)
    encode = encode_fields(field for field in rest if field.name in names)
    return lambda value: kind + encode(value)


def encode_fields(fields: Iterable[Field]) -> Encode:
    """The encoder of any object that has these fields as attributes. What is empty or None is not written.

    It is written out as a function and compiled, as `dataclasses` does: it runs 30 times a second, and going
    through the table for each value would take half as long again.
    """
    chosen = tuple(fields)
    scope: dict[str, object] = {}
    lines = ["def encode(value):", f"    made = [{_packed(chosen, scope)}]"]
    for field in chosen:
        if field.kind not in SCALARS:
            lines += _line(field, scope)
    lines.append("    return b''.join(made)")
    exec("\n".join(lines), scope)  # noqa: S102 -- names and numbers of our own table, and nothing else
    return cast("Encode", scope["encode"])


def _packed(fields: Iterable[Field], scope: dict[str, object]) -> str:
    """All numbers of a message in one call: tag, number, tag, number."""
    layout, arguments = "<", []
    for field in fields:
        if field.kind in SCALARS:
            letter, wire = _FORMATS[field.kind]
            start = tag(field.number, wire)
            layout += ("B" if len(start) == 1 else "H") + letter
            arguments.append(f"{int.from_bytes(start, 'little')}, value.{field.name}")
    scope["pack"] = struct.Struct(layout).pack
    return f"pack({', '.join(arguments)})"


def _line(field: Field, scope: dict[str, object]) -> list[str]:
    """The lines that add one field. Text and enums that were seen before cost one look-up."""
    name, encode = field.name, f"encode_{field.name}"
    scope[encode] = made = _FIELDS[field.kind](field)
    if field.kind is Kind.JSON:  # 0 and "" are something here
        return [f"    made.append({encode}(value.{name}))"]
    encoded = f"{encode}(item)"
    if isinstance(made, _Known):
        scope[f"known_{name}"] = made.known
        encoded = f"known_{name}.get(item) or {encoded}"
    return [f"    item = value.{name}", "    if item:", f"        made.append({encoded})"]


class _Known:
    """Encodes a field whose values recur, and remembers them."""

    def __init__(self, encode: Encode, bound: int) -> None:
        self.known: dict[object, bytes] = {}
        self._encode = encode
        self._bound = bound

    def __call__(self, value: object) -> bytes:
        found = self.known.get(value)
        if found is None:
            found = self._encode(value)
            if len(self.known) < self._bound and len(found) < _KNOWN_LENGTH:
                self.known[value] = found
        return found


def _text(field: Field) -> Encode:
    return _remembered(tag(field.number, _SIZED))


def _remembered(start: bytes) -> _Known:
    """Text that is mostly the same from tick to tick, as a field; empty text is no field."""
    return _Known(lambda value: sized(start, utf8(value)) if value else b"", _KNOWN_TEXTS)


def utf8(text: object) -> bytes:
    """Text as protobuf wants it. What cannot be encoded (a file's name may be anything) is spelled out."""
    return cast("str", text).encode("utf-8", "backslashreplace")


def _texts(field: Field) -> Encode:
    start = tag(field.number, _SIZED)
    return lambda value: b"".join([sized(start, utf8(text)) for text in cast("Iterable[str]", value)])


def _enum(field: Field) -> Encode:
    start = tag(field.number, _VARINT)
    numbers = {name: start + varint(number) for number, name in enumerate(ENUMS[field.of], 1)}
    return _Known(lambda value: numbers[cast("str", value)], len(numbers))


def _one(field: Field) -> Encode:
    start, encode = tag(field.number, _SIZED), encoder(field.of)
    return lambda value: sized(start, encode(value))


def _many(field: Field) -> Encode:
    one = _one(field)
    return lambda value: b"".join([one(item) for item in cast("Iterable[object]", value)])


def _numbers(field: Field) -> Encode:
    start, number = tag(field.number, _SIZED), tag(2, _FIXED)
    known: dict[str, bytes] = {}

    def prefix(name: str) -> bytes:
        inner = sized(tag(1, _SIZED), utf8(name)) + number
        found = start + varint(len(inner) + 8) + inner
        if len(known) < _KNOWN_TEXTS:
            known[name] = found
        return found

    def encode(value: object) -> bytes:
        items = cast("Mapping[str, float]", value).items()
        return b"".join([(known.get(name) or prefix(name)) + _double(number) for name, number in items])

    return encode


def _named(field: Field) -> Encode:
    start, named = tag(field.number, _SIZED), encoder(field.of)
    name_of, value_tag = _remembered(tag(1, _SIZED)), tag(2, _SIZED)

    def encode(value: object) -> bytes:
        items = cast("Mapping[str, object]", value).items()
        return b"".join([sized(start, name_of(name) + sized(value_tag, named(item))) for name, item in items])

    return encode


def _json(field: Field) -> Encode:
    start = tag(field.number, _SIZED)
    last: tuple[object, bytes] = (None, b"")

    def encode(value: object) -> bytes:
        nonlocal last
        known = last
        if value is not known[0]:  # metadata are the same object in frame after frame
            known = last = (value, sized(start, to_json(cast("Value", value)).encode()))
        return known[1]

    return encode


def _floats(field: Field) -> Encode:
    start = tag(field.number, _SIZED)
    return lambda value: sized(start, cast("bytes", value))


_FIELDS: dict[Kind, Callable[[Field], Encode]] = {
    Kind.TEXT: _text,
    Kind.TEXTS: _texts,
    Kind.ENUM: _enum,
    Kind.ONE: _one,
    Kind.MAYBE: _one,
    Kind.MANY: _many,
    Kind.NUMBERS: _numbers,
    Kind.NAMED: _named,
    Kind.JSON: _json,
    Kind.FLOATS: _floats,
}
