"""Blocks of muscle signals as samples: each has the time of its block, and gaps stay gaps."""

from collections import defaultdict

import numpy as np
from numpy.typing import NDArray

from bentod.frames import Value
from bentod.lsl.state import number
from bentod.lsl.stream import Channel, Stream, Table


def samples_of(block: Table) -> NDArray[np.float32]:
    """The samples (V), shape (n, channels); none if the block has none."""
    samples = np.asarray(block.get("samples") or [], dtype=np.float32)
    return samples if samples.ndim == 2 else np.empty((0, 0), np.float32)


def times_of(block: Table, count: int, rate_hz: float) -> list[float]:
    """When each of `count` samples was taken (monotonic s): the block's own time, and on from there."""
    first = number(block.get("time"))
    return [first + index / rate_hz for index in range(count)]


def rate_of(sites: Value) -> float:
    """The nominal rate (Hz) that `emg_get` tells; 0 if it does not."""
    rate = sites.get("rate_hz") if isinstance(sites, dict) else None
    return float(rate) if isinstance(rate, int | float) and rate > 0 else 0.0


def emg_stream(sites: Value, channels: int, arm: str, about: dict[str, str]) -> Stream:
    """The stream of a source with so many channels; `sites` is what `emg_get` tells."""
    names = _names(sites)
    labels = [names.get(index) or f"channel_{index}" for index in range(channels)]
    described = tuple(Channel(label, "volts", "EMG") for label in labels)
    return Stream("bentod EMG", "EMG", f"{arm}/emg", rate_of(sites), "float32", described, about)


def _names(sites: Value) -> dict[int, str]:
    """By channel, the sites that look at it."""
    found: dict[int, list[str]] = defaultdict(list)
    listed = sites.get("sites") if isinstance(sites, dict) else None
    for site in listed if isinstance(listed, list) else []:
        match site:
            case {"name": str(name), "channel": int(channel)}:
                found[channel].append(name)
    return {channel: "+".join(names) for channel, names in found.items()}
