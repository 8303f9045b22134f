"""Values of a frame as the live view needs them: what comes from outside may be anything."""

import math
from collections.abc import Mapping
from typing import TypeAlias

from bentod.cli.telling import printable
from bentod.frames import Value

Table: TypeAlias = Mapping[str, Value]


def fields(value: Value) -> Table:
    """`value` if it is a map, else an empty one."""
    return value if isinstance(value, dict) else {}


def entries(table: Table, key: str) -> list[Value]:
    """A list in a table; empty if there is none."""
    value = table.get(key)
    return value if isinstance(value, list) else []


def text(table: Table, key: str) -> str:
    """A text in a table, without what would steer the terminal."""
    return printable(str(table.get(key, "")))


def number(table: Table, key: str) -> float:
    """A number in a table; nan if there is none."""
    return as_number(table.get(key))


def as_number(value: Value) -> float:
    """A number; nan for what is none."""
    return float(value) if isinstance(value, int | float) else math.nan


def degrees(radians: float) -> str:
    """An angle, eight columns wide."""
    return f"{math.degrees(radians):+7.1f}°" if math.isfinite(radians) else "      – "


def clock_time(seconds: float) -> str:
    """A duration (s) as minutes and seconds, with hours if there are any."""
    if not math.isfinite(seconds):
        return "–"
    minutes, rest = divmod(int(max(seconds, 0.0)), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{rest:02d}" if hours else f"{minutes}:{rest:02d}"
