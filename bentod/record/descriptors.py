"""The tables of `schema` as protobuf descriptors, which go into every file: it explains itself to tools."""

import dataclasses
import re
from collections.abc import Iterator, Sequence

from google.protobuf import timestamp_pb2
from google.protobuf.descriptor_pb2 import (
    DescriptorProto,
    EnumDescriptorProto,
    EnumValueDescriptorProto,
    FieldDescriptorProto,
    FileDescriptorProto,
    FileDescriptorSet,
    OneofDescriptorProto,
)

from bentod.frames import JointSpec
from bentod.record.field import SCALARS, Field, Kind, Message
from bentod.record.schema import ENUMS, PACKAGE, TABLE

_P = FieldDescriptorProto

_TYPES = {
    Kind.DOUBLE: _P.TYPE_DOUBLE,
    Kind.INT: _P.TYPE_SFIXED64,
    Kind.BOOL: _P.TYPE_BOOL,
    Kind.ENUM: _P.TYPE_ENUM,
    Kind.TEXT: _P.TYPE_STRING,
    Kind.TEXTS: _P.TYPE_STRING,
    Kind.JSON: _P.TYPE_STRING,
    Kind.FLOATS: _P.TYPE_FLOAT,
}

_REPEATED = (Kind.TEXTS, Kind.FLOATS, Kind.MANY, Kind.NUMBERS, Kind.NAMED)

LOG = "foxglove.Log"
"""Well known to viewers: https://docs.foxglove.dev/docs/sdk/schemas/log"""

LEVELS = ("UNKNOWN", "DEBUG", "INFO", "WARNING", "ERROR", "FATAL")

JOINTS = f"{PACKAGE}.Joints"

JOINT_FIELDS = ("position", "velocity", "load")
"""Of each joint in `JOINTS`, for plots: rad, rad/s, share of the greatest torque."""


def descriptor_set(joints: Sequence[JointSpec]) -> bytes:
    """What stands in a file: every message, one of them with a field for each joint."""
    stamp = FileDescriptorProto()
    timestamp_pb2.DESCRIPTOR.CopyToProto(stamp)
    return FileDescriptorSet(
        file=[stamp, _log_file(), messages_file(), _joints_file(joints)]
    ).SerializeToString()


def messages_file(*, blobs: bool = False) -> FileDescriptorProto:
    """The messages of the table; with `blobs`, packed floats are `bytes`, which are the same on the wire."""
    file = FileDescriptorProto(name=f"{PACKAGE}.proto", package=PACKAGE, syntax="proto3")
    file.enum_type.extend(_enum(name, values) for name, values in ENUMS.items())
    for message in TABLE:
        file.message_type.append(_message(message))
        file.message_type.extend(_named(field) for field in message.fields if field.kind is Kind.NAMED)
    file.message_type.append(_pair("NamedNumber", _field(2, "value", _P.TYPE_DOUBLE)))
    if blobs:
        _as_bytes(file)
    return file


def field_names(joints: Sequence[JointSpec]) -> tuple[str, ...]:
    """The joints' names as fields of a message: letters, digits and underscores, each once."""
    names: list[str] = []
    for joint in joints:
        name = re.sub(r"[^A-Za-z0-9_]", "_", joint.name)
        name = name if re.match(r"[A-Za-z]", name) else f"joint_{name}"
        names.append(name if name not in names else f"{name}_{len(names) + 1}")
    return tuple(names)


def _message(message: Message) -> DescriptorProto:
    made = DescriptorProto(name=message.name)
    for field in message.fields:
        of = _type_name(field)
        repeated = field.kind in _REPEATED
        made.field.append(_field(field.number, field.name, _TYPES.get(field.kind, 0), of, repeated))
        if has_default(message, field):
            made.field[-1].proto3_optional = True
            made.field[-1].oneof_index = len(made.oneof_decl)
            made.oneof_decl.append(OneofDescriptorProto(name=f"_{field.name}"))
    return made


def has_default(message: Message, field: Field) -> bool:
    """Whether a file without this field means something else than zero, so that absence must be seen."""
    if field.kind not in SCALARS:
        return False
    known = {f.name: f for cls in message.classes for f in dataclasses.fields(cls)}
    default = known[field.name].default if field.name in known else dataclasses.MISSING
    return default is not dataclasses.MISSING and bool(default)


def _type_name(field: Field) -> str:
    if field.kind is Kind.NUMBERS:
        return f".{PACKAGE}.NamedNumber"
    if field.kind is Kind.NAMED:
        return f".{PACKAGE}.Named{field.of}"
    return f".{PACKAGE}.{field.of}" if field.of else ""


def _field(
    number: int, name: str, kind: "_P.Type.ValueType | int", of: str = "", repeated: bool = False
) -> FieldDescriptorProto:
    # The JSON name is given, because two names may be one in camel case.
    made = FieldDescriptorProto(name=name, number=number, json_name=name)
    made.label = _P.LABEL_REPEATED if repeated else _P.LABEL_OPTIONAL
    made.type = kind or _P.TYPE_MESSAGE  # type: ignore[assignment]
    if of:
        made.type_name = of
    return made


def _named(field: Field) -> DescriptorProto:
    return _pair(f"Named{field.of}", _field(2, "value", _P.TYPE_MESSAGE, f".{PACKAGE}.{field.of}"))


def _pair(name: str, value: FieldDescriptorProto) -> DescriptorProto:
    return DescriptorProto(name=name, field=[_field(1, "name", _P.TYPE_STRING), value])


def _enum(name: str, values: Sequence[str]) -> EnumDescriptorProto:
    names = [f"{name.upper()}_UNKNOWN", *(value.upper() for value in values)]
    return EnumDescriptorProto(
        name=name, value=[EnumValueDescriptorProto(name=n, number=i) for i, n in enumerate(names)]
    )


def _as_bytes(file: FileDescriptorProto) -> None:
    for message in file.message_type:
        for field in message.field:
            if field.type == _P.TYPE_FLOAT:
                field.type = _P.TYPE_BYTES
                field.label = _P.LABEL_OPTIONAL


def _joints_file(joints: Sequence[JointSpec]) -> FileDescriptorProto:
    """A field for each joint by its own name: plots then say `/joints/elbow_flexion/position`."""
    one = DescriptorProto(name="Joint")
    one.field.extend(_field(i, name, _P.TYPE_DOUBLE) for i, name in enumerate(JOINT_FIELDS, 1))
    made = DescriptorProto(name="Joints")
    made.field.extend(_joint_fields(joints))
    file = FileDescriptorProto(name=f"{PACKAGE}.joints.proto", package=PACKAGE, syntax="proto3")
    file.message_type.extend([one, made])
    return file


def _joint_fields(joints: Sequence[JointSpec]) -> Iterator[FieldDescriptorProto]:
    for number, name in enumerate(field_names(joints), 1):
        yield _field(number, name, _P.TYPE_MESSAGE, f".{PACKAGE}.Joint")


def _log_file() -> FileDescriptorProto:
    file = FileDescriptorProto(name="foxglove/Log.proto", package="foxglove", syntax="proto3")
    file.dependency.append("google/protobuf/timestamp.proto")
    log = DescriptorProto(name="Log")
    level = EnumDescriptorProto(
        name="Level", value=[EnumValueDescriptorProto(name=n, number=i) for i, n in enumerate(LEVELS)]
    )
    log.enum_type.append(level)
    log.field.extend(
        [
            _field(1, "timestamp", _P.TYPE_MESSAGE, ".google.protobuf.Timestamp"),
            _field(2, "level", _P.TYPE_ENUM, ".foxglove.Log.Level"),
            _field(3, "message", _P.TYPE_STRING),
            _field(4, "name", _P.TYPE_STRING),
            _field(5, "file", _P.TYPE_STRING),
            _field(6, "line", _P.TYPE_FIXED32),
        ]
    )
    file.message_type.append(log)
    return file
