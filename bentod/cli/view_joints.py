"""Joints as rows of the live view: where each is and is expected to be, how sure that is, who moves it."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from bentod.cli.view_style import BOLD, DIM, OFF
from bentod.cli.view_values import Table, as_number, degrees, entries, fields, number, text

WIDE = 100
"""Columns from which on there is room for velocities and long bars."""

_LONG, _SHORT = 17, 11


@dataclass(frozen=True, slots=True)
class Range:
    """A joint's limits, rad."""

    minimum: float
    maximum: float


def joint_rows(frame: Table, ranges: Mapping[str, Range], group: str, width: int) -> list[str]:
    """A head, and a row for each joint; what is selected in `group` (empty: the first) is marked."""
    bar = _LONG if width >= WIDE else _SHORT
    speed = "  velocity  " if width >= WIDE else "  "
    head = f"{DIM}    joint               angle  {'':{bar}}   {speed}mode     expected sure  moved by{OFF}"
    groups = [fields(one) for one in entries(frame, "groups")]
    shown = next((one for one in groups if text(one, "name") == group), groups[0] if groups else {})
    marked = selected(shown)
    joints = [fields(joint) for joint in entries(frame, "joints")]
    return [head, *(_row(joint, frame, ranges, text(joint, "name") in marked, width) for joint in joints)]


def selected(group: Table) -> list[str]:
    """The joints of a group that operators move now."""
    return (
        [str(joint) for joint in entries(group, "joints")]
        if group.get("together")
        else [text(group, "active")]
    )


def _row(joint: Table, frame: Table, ranges: Mapping[str, Range], marked: bool, width: int) -> str:
    name, freshness = text(joint, "name"), text(joint, "freshness")
    position = number(joint, "position")
    expected, sure = _expected(joint, frame)
    mark = f"{BOLD}▸{OFF}" if marked else " "
    why = text(joint, "holder") if freshness == "fresh" else f"{freshness} {number(joint, 'age'):.1f} s"
    bar = _bar(position, expected, ranges.get(name), _LONG if width >= WIDE else _SHORT)
    speed = f"  {degrees(number(joint, 'velocity'))}/s" if width >= WIDE else ""
    return (
        f"  {mark} {name:<18.18} {degrees(position)}  {bar}{speed}"
        f"  {text(joint, 'mode'):<7}  {degrees(expected)} {sure:>4}  {why}"
    )


def _expected(joint: Table, frame: Table) -> tuple[float, str]:
    """Where the joint is expected at its longest timescale (rad), and how sure that is, if anything says."""
    predictions = fields(joint.get("predictions"))
    if not predictions:
        return math.nan, ""
    timescale = list(predictions)[-1]
    confidence = fields(fields(frame.get("learn")).get("confidence"))
    sure = as_number(confidence.get(f"{text(joint, 'name')}.position@{timescale}"))
    return as_number(predictions[timescale]), f"{max(sure, 0.0):.0%}" if math.isfinite(sure) else ""


def _bar(position: float, expected: float, limits: Range | None, width: int) -> str:
    """Where the joint is (●) and is expected to be (○) between its limits."""
    cells = ["·"] * width
    for value, sign in ((expected, "○"), (position, "●")):
        if limits and math.isfinite(value):
            share = (value - limits.minimum) / (limits.maximum - limits.minimum)
            cells[min(max(round(share * (width - 1)), 0), width - 1)] = sign
    return "".join(cells)
