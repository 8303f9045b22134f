"""Events as markers: what happened once, and trials that were started, marked and stopped."""

import json

from bentod.lsl.stream import Channel, Stream, Table


def events_stream(arm: str, about: dict[str, str]) -> Stream:
    """The stream of an arm's events, whenever they come."""
    channel = Channel("event", "", "Marker", "JSON with kind, text and data")
    return Stream("bentod events", "Markers", f"{arm}/events", 0.0, "string", (channel,), about)


def marker(event: Table) -> str:
    """One event as JSON, without its time: that is the sample's."""
    told = {key: event.get(key) for key in ("kind", "text", "data")}
    return json.dumps(told, ensure_ascii=False, default=repr)
