"""What a stream of the lab streaming layer is, whoever carries it."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from bentod.frames import Value

Table: TypeAlias = dict[str, Value]
"""A frame, a block or an event as it comes from the socket."""

Rows: TypeAlias = NDArray[np.float64] | NDArray[np.float32] | list[str]
"""Samples: shape (samples, channels), or one text a sample."""


@dataclass(frozen=True, slots=True)
class Channel:
    """One channel as the XDF format wants it described."""

    label: str
    unit: str
    type: str
    meaning: str = ""
    joint: str = ""  # empty: of no joint
    codes: tuple[str, ...] = ()  # what 0, 1, ... stand for


@dataclass(frozen=True, slots=True)
class Stream:
    """A stream as others find it."""

    name: str
    type: str  # content type, in XDF's words where it has one
    source_id: str  # the same after a restart, by which recorders find it again
    rate_hz: float  # nominal; 0: irregular
    format: Literal["double64", "float32", "string"]
    channels: tuple[Channel, ...]
    about: Mapping[str, str]  # of the system that it comes from


class Outlet(Protocol):
    """A stream that others can record."""

    stream: Stream

    def push(self, rows: Rows, times: Sequence[float]) -> None:
        """Send samples with their times, s of LSL's clock. Never waits for those who listen."""
        ...

    def close(self) -> None:
        """Take the stream from the network."""
        ...


OpenOutlet: TypeAlias = Callable[[Stream], Outlet]
"""How a stream is put on the network."""
