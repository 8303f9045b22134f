"""MessagePack-RPC framing without input or output: bytes in, typed messages out, and values back to bytes."""

import functools
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass
from operator import attrgetter
from typing import NoReturn, TypeAlias

import msgpack
import numpy as np

from bentod.errors import BentodError
from bentod.frames import Value
from bentod.framing import BadFraming, Limits, Scanner

REQUEST, RESPONSE, NOTIFICATION = 0, 1, 2
GREATEST_ID = 2**32 - 1


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


class Decoder:
    """Iterating gives the messages that are complete so far, and stops until more bytes are fed.

    Raises:
        BadFraming: while iterating; the decoder is of no use afterwards.
    """

    def __init__(self, limits: Limits | None = None) -> None:
        limits = limits or Limits()
        self._values: _Trusted | _Untrusted = _Trusted(limits) if limits.trusted else _Untrusted(limits)
        self._take = self._values.take

    def feed(self, data: bytes) -> None:
        """Add received bytes; iterate to the end before feeding more, and memory stays bounded."""
        self._values.feed(data)

    @property
    def pending(self) -> int:
        """Bytes of a message that has begun; once iterated to the end, 0 means that none has."""
        return self._values.pending

    @property
    def weight(self) -> float:
        """What the message given last cost to take in, in small requests."""
        return self._values.weight

    @property
    def rest(self) -> bytes:
        """Of an untrusted sender, the bytes that follow the last message given."""
        return self._values.rest

    def __iter__(self) -> Iterator[Message]:
        return self

    def __next__(self) -> Message:
        return _typed(self._take())


class _Untrusted:
    """Builds a value only once all of it is there and known to be within bounds."""

    def __init__(self, limits: Limits) -> None:
        self._scanner = Scanner(limits)
        self.feed = self._scanner.feed

    @property
    def pending(self) -> int:
        return self._scanner.pending

    @property
    def rest(self) -> bytes:
        return self._scanner.rest

    @property
    def weight(self) -> float:
        return self._scanner.weight

    def take(self) -> Value:
        value = self._scanner.take()
        if value is None:
            raise StopIteration
        try:
            built: Value = msgpack.unpackb(value, object_hook=_with_texts_as_keys)
        except (ValueError, msgpack.UnpackException) as error:
            raise BadFraming(f"These bytes are not a message: {error or type(error).__name__}.") from error
        return built


class _Trusted:
    """Builds values while they arrive, which is quicker for long ones, and holds little but their size."""

    rest = b""
    weight = 1.0

    def __init__(self, limits: Limits) -> None:
        self._size = limits.size
        self._unpacker = msgpack.Unpacker(
            ext_hook=_refuse_extension,
            max_buffer_size=0,  # unpacked parts leave the buffer, so the size is held here instead
            max_str_len=limits.size,
            max_bin_len=limits.size,
            max_array_len=limits.items,
            max_map_len=limits.items,
            max_ext_len=0,
        )
        self._fed = 0
        self._taken = 0

    @property
    def pending(self) -> int:
        return self._fed - self._taken

    def feed(self, data: bytes) -> None:
        self._unpacker.feed(data)
        self._fed += len(data)

    def take(self) -> Value:
        try:
            built: Value = self._unpacker.unpack()
        except msgpack.OutOfData:
            self._check_size(self._fed)
            raise StopIteration from None
        except (ValueError, TypeError, msgpack.UnpackException) as error:
            raise BadFraming(f"These bytes are not a message: {error or type(error).__name__}.") from error
        end: int = self._unpacker.tell()
        self._check_size(end)
        self._taken = end
        return built

    def _check_size(self, end: int) -> None:
        if end - self._taken > self._size:
            raise BadFraming(f"A message is longer than {self._size} bytes.")


def _refuse_extension(code: int, _data: bytes) -> NoReturn:
    raise ValueError(f"extension type {code} has no meaning here")


def _with_texts_as_keys(built: dict[str, Value]) -> dict[str, Value]:
    if not all(type(key) is str for key in built):
        raise BadFraming("The keys of a map must be texts.")
    return built


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


class Packed(bytes):
    """A value that is MessagePack already."""


class Memo:
    """The MessagePack of a value that many ask for, made once for as long as it stays the same value."""

    def __init__(self) -> None:
        self._value: object = None
        self._packed = Packed(pack(None))

    def of(self, value: object) -> Packed:
        """`value` as bytes."""
        if value is not self._value:
            self._value, self._packed = value, Packed(pack(value))
        return self._packed


def encode_result(id_: int, result: object) -> bytes:
    """The response to a request that succeeded."""
    if isinstance(result, Packed):
        return pack((RESPONSE, id_, None, None))[:-1] + result  # the last byte is nil
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
