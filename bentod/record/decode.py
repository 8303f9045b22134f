"""Bytes to entries. What reads is protobuf itself, so it also checks what `wire` writes."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import MISSING, fields
from operator import attrgetter
from typing import Protocol, TypeAlias, cast

import numpy as np
from google.protobuf.descriptor_pool import DescriptorPool
from google.protobuf.message import Message as Decoded
from google.protobuf.message_factory import GetMessageClass

from bentod.frames import EmgBlock, Frame
from bentod.record.codec import TOPICS, Recorded
from bentod.record.descriptors import has_default, messages_file
from bentod.record.field import Field, Kind, Message
from bentod.record.plain import from_json
from bentod.record.schema import ENUMS, MESSAGES, PACKAGE, UNKNOWN
from bentod.record.tally import Point


class _Decoder:
    """Protobuf's object to ours, for one message."""

    def __init__(self, message: Message, cls: type) -> None:
        by_name = {field.name: field for field in message.fields}
        self._cls = cls
        self._names = [field.name for field in fields(cls)]
        self._get = attrgetter(*self._names)
        self._converts = [
            (index, convert)
            for index, name in enumerate(self._names)
            if (convert := _converter(message, by_name[name], cls)) is not None
        ]

    def __call__(self, given: Decoded) -> object:
        got = self._get(given)
        values = list(got) if len(self._names) > 1 else [got]
        for index, convert in self._converts:
            values[index] = convert(given, values[index])
        return self._cls(*values)


Convert: TypeAlias = Callable[[Decoded, object], object]


def _converter(message: Message, field: Field, cls: type) -> Convert | None:
    """How protobuf's value of a field becomes ours; None: it is ours."""
    name = field.name
    if has_default(message, field):
        default = next(f.default for f in fields(cls) if f.name == name and f.default is not MISSING)
        return lambda given, value: value if given.HasField(name) else default
    if field.kind is Kind.ENUM:
        members = _members(field.of)
        return lambda given, value: members.get(cast("int", value), UNKNOWN[field.of])
    if field.kind is Kind.MAYBE:
        one = _decode(field.of)
        return lambda given, value: one(cast("Decoded", value)) if given.HasField(name) else None
    return _PLAIN[field.kind](field) if field.kind in _PLAIN else None


def _members(enum: str) -> dict[int, str]:
    return dict(enumerate(ENUMS[enum], 1))


def _one(field: Field) -> Convert:
    one = _decode(field.of)
    return lambda given, value: one(cast("Decoded", value))


def _many(field: Field) -> Convert:
    one = _decode(field.of)
    return lambda given, value: tuple([one(item) for item in cast("Sequence[Decoded]", value)])


def _named(field: Field) -> Convert:
    one = _decode(field.of)
    return lambda given, value: {item.name: one(item.value) for item in value}  # type: ignore[attr-defined]


def _numbers(field: Field) -> Convert:
    return lambda given, value: {item.name: item.value for item in value}  # type: ignore[attr-defined]


_PLAIN: Mapping[Kind, Callable[[Field], Convert]] = {
    Kind.ONE: _one,
    Kind.MANY: _many,
    Kind.NAMED: _named,
    Kind.NUMBERS: _numbers,
    Kind.TEXTS: lambda field: lambda given, value: tuple(cast("Sequence[str]", value)),
    Kind.JSON: lambda field: lambda given, value: from_json(cast("str", value)),
}


def _decode(name: str) -> Callable[[Decoded], object]:
    """The decoder of the message `name`; the first field of a union says which class it is."""
    message = MESSAGES[name]
    if len(message.classes) == 1:
        return _Decoder(message, message.classes[0])
    made = [_Decoder(message, cls) for cls in message.classes]
    return lambda given: made[max(given.kind - 1, 0)](given)  # type: ignore[attr-defined]


def _block(given: Decoded) -> EmgBlock:
    block = cast("_Block", given)
    samples = np.frombuffer(block.samples, "<f4").reshape(block.length, block.channels)
    return EmgBlock(block.first_index, block.time, samples, block.dropped)


class _Block(Protocol):
    """Protobuf's object of an EMG block, its samples as bytes."""

    first_index: int
    time: float
    dropped: int
    length: int
    channels: int
    samples: bytes


_pool = DescriptorPool()
_pool.Add(messages_file(blobs=True))

_READERS: Mapping[type[Recorded], tuple[type[Decoded], Callable[[Decoded], object]]] = {
    cls: (
        GetMessageClass(_pool.FindMessageTypeByName(f"{PACKAGE}.{cls.__name__}")),
        _block if cls is EmgBlock else _decode(cls.__name__),
    )
    for cls in TOPICS.values()
}


def brief(cls: type[Recorded], data: bytes) -> Point:
    """Only what is counted of an entry, in a tenth of the time.

    Raises:
        google.protobuf.message.DecodeError: these bytes are no such message.
    """
    given = _READERS[cls][0].FromString(data)
    names = _COUNTED.get(cls, ("time",))
    return Point(*[getattr(given, name) for name in names])


_COUNTED: Mapping[type[Recorded], tuple[str, ...]] = {
    Frame: ("time", "tick", "missed"),
    EmgBlock: ("time", "first_index", "length"),
}


def decode(cls: type[Recorded], data: bytes) -> Recorded:
    """The entry that was encoded.

    Raises:
        google.protobuf.message.DecodeError: these bytes are no such message.
    """
    made, read = _READERS[cls]
    return cast("Recorded", read(made.FromString(data)))
