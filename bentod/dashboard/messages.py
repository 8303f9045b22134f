"""What browsers and the page's server say to each other: MessagePack in WebSocket messages; no I/O."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import msgpack

from bentod.errors import BadRequest
from bentod.frames import Value
from bentod.framing import BadFraming, Limits, Scanner

LONGEST = 16 * 1024
"""Bytes of a message from a browser, as of one to the daemon."""


@dataclass(frozen=True, slots=True)
class Token:
    """Who the browser is: the first thing that it says."""

    token: str


@dataclass(frozen=True, slots=True)
class Call:
    """A method that is asked for once, and answered under `number`."""

    number: int
    method: str
    params: dict[str, Value]
    seen: int  # number of the newest frame that the person can have seen


@dataclass(frozen=True, slots=True)
class Hold:
    """A motion that goes on for as long as this is said again and again."""

    key: str  # of the control that is held
    method: str
    params: dict[str, Value]
    seen: int  # number of the newest frame that the person can have seen


@dataclass(frozen=True, slots=True)
class Release:
    """The control is let go."""

    key: str


@dataclass(frozen=True, slots=True)
class Seen:
    """The page has taken in every frame up to this number."""

    frame: int


Message: TypeAlias = Token | Call | Hold | Release | Seen


def parse(data: bytes) -> Message:
    """One message of a browser.

    Raises:
        BadRequest: it is none.
    """
    scanner = Scanner(Limits(LONGEST))
    scanner.feed(data)
    try:
        value = scanner.take()
        if value is None or scanner.pending:
            raise BadRequest("The browser sent something that is not one MessagePack value.")
        entry: object = msgpack.unpackb(value, strict_map_key=True)
    except (BadFraming, ValueError, msgpack.UnpackException) as error:
        raise BadRequest("The browser sent something that the daemon would not take.") from error
    if isinstance(entry, list) and entry and isinstance(entry[0], str):
        reader = _READERS.get(entry[0])
        message = reader(entry[1:]) if reader else None
        if message:
            return message
    raise BadRequest("The browser sent a message that nobody knows.")


def _token(words: Sequence[object]) -> Message | None:
    match words:
        case [str(token)]:
            return Token(token)
    return None


def _call(words: Sequence[object]) -> Message | None:
    match words:
        case [int(number), str(method), dict(params), int(seen)]:
            return Call(number, method, params, seen)
    return None


def _hold(words: Sequence[object]) -> Message | None:
    match words:
        case [str(key), str(method), dict(params), int(seen)]:
            return Hold(key, method, params, seen)
    return None


def _release(words: Sequence[object]) -> Message | None:
    match words:
        case [str(key)]:
            return Release(key)
    return None


def _seen(words: Sequence[object]) -> Message | None:
    match words:
        case [int(frame)]:
            return Seen(frame)
    return None


_READERS: dict[str, Callable[[Sequence[object]], Message | None]] = {
    "token": _token,
    "call": _call,
    "hold": _hold,
    "release": _release,
    "seen": _seen,
}


def pack(*words: object) -> bytes:
    """A message to browsers."""
    packed: bytes = msgpack.packb(words)
    return packed
