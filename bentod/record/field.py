"""What a message of a recording is made of: fields, each with its number and the way it is written."""

from dataclasses import dataclass
from enum import Enum, auto


class Kind(Enum):
    """How a field is written."""

    DOUBLE = auto()
    INT = auto()  # of fixed size, so that it is written together with its neighbours
    BOOL = auto()
    ENUM = auto()
    TEXT = auto()
    TEXTS = auto()
    JSON = auto()  # text: a `Value`, readable in every tool
    FLOATS = auto()  # packed float32
    ONE = auto()  # a message
    MAYBE = auto()  # a message or nothing
    MANY = auto()  # messages
    NUMBERS = auto()  # messages of a name and a number
    NAMED = auto()  # messages of a name and a message


SCALARS = (Kind.DOUBLE, Kind.INT, Kind.BOOL)


@dataclass(frozen=True, slots=True)
class Field:
    """One field: its number, the name of the attribute that it holds, and how."""

    number: int
    name: str
    kind: Kind
    of: str = ""  # the message or enum that it holds


@dataclass(frozen=True, slots=True)
class Message:
    """One message, and the classes of which it holds any one."""

    name: str
    classes: tuple[type, ...]
    fields: tuple[Field, ...]
