"""Streams on the network, by pylsl and the liblsl that comes with it."""

from collections.abc import Sequence

import pylsl
from pylsl.info import XMLElement

from bentod.lsl.stream import Channel, Rows, Stream


class LslOutlet:
    """One stream on the network until it is closed."""

    def __init__(self, stream: Stream) -> None:
        self.stream = stream
        self._outlet = pylsl.StreamOutlet(_info(stream))

    def push(self, rows: Rows, times: Sequence[float]) -> None:
        """Send samples with their times, s of LSL's clock. Never waits for those who listen."""
        self._outlet.push_chunk(rows, list(times))

    def close(self) -> None:
        """Take the stream from the network: liblsl does so when nobody refers to it any more."""
        self._outlet = None


def local_clock() -> float:
    """LSL's clock (s)."""
    return float(pylsl.local_clock())


def _info(stream: Stream) -> pylsl.StreamInfo:
    """The description that recorders keep, in the words of XDF's pages on meta-data."""
    info = pylsl.StreamInfo(
        stream.name, stream.type, len(stream.channels), stream.rate_hz, stream.format, stream.source_id
    )
    desc = info.desc()
    acquisition = desc.append_child("acquisition")
    for key, value in stream.about.items():
        acquisition.append_child_value(key, value)
    desc.append_child("synchronization").append_child_value("can_drop_samples", "true")
    channels = desc.append_child("channels")
    for channel in stream.channels:
        _describe(channels.append_child("channel"), channel)
    return info


def _describe(element: XMLElement, channel: Channel) -> None:
    told = {
        "label": channel.label,
        "unit": channel.unit,
        "type": channel.type,
        "object": channel.joint,
        "meaning": channel.meaning,
    }
    for key, value in told.items():
        if value:
            element.append_child_value(key, value)
    if not channel.codes:
        return
    codes = element.append_child("codes")
    for number, meaning in enumerate(channel.codes):
        code = codes.append_child("code")
        code.append_child_value("value", str(number))
        code.append_child_value("meaning", meaning)
