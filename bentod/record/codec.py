"""Entries to bytes, and the topics that they go to."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from struct import Struct
from typing import TypeAlias, cast

import numpy as np

from bentod.frames import ClientCommand, EmgBlock, Event, Frame, JointSpec
from bentod.record.descriptors import JOINTS, LEVELS, LOG
from bentod.record.schema import MESSAGES, PACKAGE
from bentod.record.session import Entry, Mark, Report
from bentod.record.wire import Encode, encode_fields, encoder, sized, tag, utf8, varint

Recorded: TypeAlias = Entry | Mark | Report
"""What is read back: entries, and what the recorder adds."""

TOPICS: Mapping[str, type[Recorded]] = {
    "/frame": Frame,
    "/emg": EmgBlock,
    "/event": Event,
    "/command": ClientCommand,
    "/mark": Mark,
    "/recording": Report,
}
"""In the order of their channels, from 1."""

VIEWS = {"/log": LOG, "/joints": JOINTS}
"""Topics for viewers, made from the others and never read back."""

CHANNELS = {topic: number for number, topic in enumerate((*TOPICS, *VIEWS), 1)}

SCHEMAS = {topic: f"{PACKAGE}.{cls.__name__}" for topic, cls in TOPICS.items()} | VIEWS

CHANNEL_OF = {cls: CHANNELS[topic] for topic, cls in TOPICS.items()}

SEVERITY = {"fault": "ERROR", "servo": "WARNING", "recording": "WARNING"}
"""Of events in the log of viewers; all others are for information."""


@dataclass(frozen=True, slots=True)
class _Block:
    """An EMG block as the table of fields has it."""

    first_index: int
    time: float
    dropped: int
    length: int
    channels: int
    samples: bytes


def _encode_block(block: object) -> bytes:
    given = cast("EmgBlock", block)
    length, channels = given.samples.shape
    data = np.ascontiguousarray(given.samples, "<f4").tobytes()
    return _block_fields(_Block(given.first_index, given.time, given.dropped, length, channels, data))


_block_fields = encode_fields(MESSAGES["EmgBlock"].fields)

ENCODERS: Mapping[type[Recorded], Encode] = {
    cls: _encode_block if cls is EmgBlock else encoder(cls.__name__) for cls in TOPICS.values()
}


class Plots:
    """The joints of each frame, one field a joint by its name."""

    def __init__(self, joints: Sequence[JointSpec]) -> None:
        self._tags = [tag(number, 2) + varint(27) for number in range(1, len(joints) + 1)]
        self._pack = Struct("<BdBdBd").pack

    def encode(self, frame: Frame) -> bytes:
        """The message of `descriptors.JOINTS`."""
        pack = self._pack
        return b"".join(
            [
                start + pack(0x09, joint.position, 0x11, joint.velocity, 0x19, joint.load)
                for start, joint in zip(self._tags, frame.joints, strict=False)
            ]
        )


def encode_log(kind: str, text: str, log_time: int) -> bytes:
    """A sentence as viewers show it; `log_time`: ns since the epoch."""
    seconds, nanoseconds = divmod(log_time, 1_000_000_000)
    stamp = tag(1, 0) + varint(seconds) + tag(2, 0) + varint(nanoseconds)
    level = tag(2, 0) + varint(LEVELS.index(SEVERITY.get(kind, "INFO")))
    return sized(tag(1, 2), stamp) + level + sized(tag(3, 2), utf8(text)) + sized(tag(4, 2), utf8(kind))
