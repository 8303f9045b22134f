"""MessagePack-RPC framing without input or output: bytes in, typed messages out, and values back to bytes."""

import functools
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass
from operator import attrgetter
from typing import NoReturn, TypeAlias

import msgpack
import numpy as np

from bentod.errors import BentodError
from bentod.frames import Value

REQUEST, RESPONSE, NOTIFICATION = 0, 1, 2
GREATEST_ID = 2**32 - 1


class BadFraming(BentodError):
    """The other side does not speak MessagePack-RPC; the connection must be closed.

    Examples: bytes that are no MessagePack, an array of five, a text as message id, a message too long.
    """

    code = "bad_framing"


@dataclass(frozen=True, slots=True)
class Request:
    """A call that wants an answer."""

    id: int  # 0..2^32-1, chosen by the caller
    method: str
    params: Value


@dataclass(frozen=True, slots=True)
class Response:
    """The answer to the request of the same id: `error` is None when it succeeded."""

    id: int
    error: Value
    result: Value


@dataclass(frozen=True, slots=True)
class Notification:
    """A call that wants no answer."""

    method: str
    params: Value


Message: TypeAlias = Request | Response | Notification


@dataclass(frozen=True, slots=True)
class Limits:
    """What one message may hold at most."""

    size: int = 64 * 1024  # bytes
    items: int = 4096  # of one array or map
    depth: int = 16  # arrays and maps within each other
    trusted: bool = False  # the sender is the daemon itself: depth and keys are as they should be


class Decoder:
    """Iterating gives the messages that are complete so far, and stops until more bytes are fed.

    Raises:
        BadFraming: while iterating; the decoder is of no use afterwards.
    """

    def __init__(self, limits: Limits | None = None) -> None:
        self._limits = limits or Limits()
        self._unpacker = msgpack.Unpacker(
            raw=False,
            strict_map_key=True,
            ext_hook=_refuse_extension,
            max_buffer_size=0,  # unpacked parts leave the buffer, so `size` is held here instead
            max_str_len=self._limits.size,
            max_bin_len=self._limits.size,
            max_array_len=self._limits.items,
            max_map_len=self._limits.items,
            max_ext_len=0,
        )
        self._fed = 0
        self._taken = 0

    def feed(self, data: bytes) -> None:
        """Add received bytes; iterate to the end before feeding more, and memory stays bounded."""
        self._unpacker.feed(data)
        self._fed += len(data)

    def __iter__(self) -> Iterator[Message]:
        return self

    def __next__(self) -> Message:
        try:
            raw = self._unpacker.unpack()
        except msgpack.OutOfData:
            self._check_size(self._fed)
            raise StopIteration from None
        except (ValueError, TypeError, msgpack.UnpackException) as error:
            raise BadFraming(f"These bytes are not a message: {error or type(error).__name__}.") from error
        end: int = self._unpacker.tell()
        self._check_size(end)
        self._taken = end
        if not self._limits.trusted:
            _check_depth(raw, self._limits.depth)
        return _typed(raw)

    def _check_size(self, end: int) -> None:
        if end - self._taken > self._limits.size:
            raise BadFraming(f"A message is longer than {self._limits.size} bytes.")


def _refuse_extension(code: int, _data: bytes) -> NoReturn:
    raise ValueError(f"extension type {code} has no meaning here")


def _check_depth(raw: Value, depth: int) -> None:
    level: list[Value] = [raw]
    for _ in range(depth + 1):
        level = [child for item in level if isinstance(item, list | dict) for child in _children(item)]
        if not level:
            return
    raise BadFraming(f"Arrays and maps are nested more than {depth} deep.")


def _children(item: list[Value] | dict[str, Value]) -> Iterable[Value]:
    if isinstance(item, list):
        return item
    if not all(type(key) is str for key in item):
        raise BadFraming("The keys of a map must be texts.")
    return item.values()


def _typed(raw: Value) -> Message:
    if not isinstance(raw, list) or not raw or type(raw[0]) is not int:
        raise BadFraming("A message is an array that begins with its type: 0, 1 or 2.")
    match raw:
        case [0, id_, str(method), params]:
            return Request(_message_id(id_), method, params)
        case [1, id_, error, result]:
            return Response(_message_id(id_), error, result)
        case [2, str(method), params]:
            return Notification(method, params)
    raise BadFraming(
        "A message is [0, id, method, params], [1, id, error, result] or [2, method, params], "
        f"not an array of {len(raw)} of type {raw[0]}."
    )


def _message_id(raw: Value) -> int:
    if type(raw) is not int or not 0 <= raw <= GREATEST_ID:
        raise BadFraming(f"A message id is a whole number from 0 to {GREATEST_ID}.")
    return raw


def encode_request(id_: int, method: str, params: object) -> bytes:
    """A request; `params` is a list or a map."""
    return pack((REQUEST, id_, method, params))


def encode_result(id_: int, result: object) -> bytes:
    """The response to a request that succeeded."""
    return pack((RESPONSE, id_, None, result))


def encode_error(id_: int, error: BentodError) -> bytes:
    """The response to a request that failed."""
    return pack((RESPONSE, id_, error_object(error), None))


def encode_notification(method: str, params: Sequence[object]) -> bytes:
    """A notification."""
    return pack((NOTIFICATION, method, params))


def error_object(error: BentodError) -> dict[str, Value]:
    """What a client sees of an error."""
    return {"code": error.code, "message": str(error), "field": error.field}


def pack(value: object) -> bytes:
    """MessagePack of plain data, dataclasses (maps of their fields), tuples, mappings and numpy scalars.

    Raises:
        TypeError: there is something else in `value`.
    """
    packed: bytes = msgpack.packb(value, default=_plain)
    return packed


def _plain(value: object) -> object:
    if is_dataclass(value) and not isinstance(value, type):
        return _as_map(type(value))(value)
    if isinstance(value, Mapping):
        return dict(value)
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"A message cannot hold a {type(value).__name__}.")


@functools.cache
def _as_map(kind: type) -> Callable[[object], dict[str, object]]:
    names = tuple(field.name for field in fields(kind))
    if len(names) < 2:  # attrgetter gives a tuple only from two names on
        return lambda value: {name: getattr(value, name) for name in names}
    values = attrgetter(*names)
    return lambda value: dict(zip(names, values(value), strict=True))
