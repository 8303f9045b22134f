"""The live view as lines of text: what the arm does, why, and what it expects. Pure; `watch` draws it."""

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from bentod.frames import Value

WIDTH = 100
"""Columns that the view needs."""

_COLOUR = re.compile(r"(\x1b\[[0-9;]*m)")
_BOLD, _DIM, _RED, _OFF = "\x1b[1m", "\x1b[2m", "\x1b[31;1m", "\x1b[0m"

Table = Mapping[str, Value]


@dataclass(frozen=True, slots=True)
class Range:
    """A joint's limits, rad."""

    minimum: float
    maximum: float


def lines(frame: Table, ranges: Mapping[str, Range], events: Sequence[str]) -> list[str]:
    """One frame as the lines of a screen; `events`: the latest sentences, oldest first."""
    joints = [_table(joint) for joint in _list(frame, "joints")]
    selected = {name for group in _list(frame, "groups")[:1] for name in _selected(_table(group))}
    screen = [
        *_head(frame),
        f"{_DIM}    joint               angle  {'':21}     velocity  mode      expected  moved by{_OFF}",
        *(_joint(joint, ranges, _text(joint, "name") in selected) for joint in joints),
        "",
        *_muscles(frame),
        *_assist(frame),
        *_goal(frame),
        "",
        *(f"{_DIM}  {_printable(event)}{_OFF}" for event in events),
    ]
    return [_cut(line) for line in screen]


def _head(frame: Table) -> list[str]:
    mode, fault = _text(frame, "mode").upper(), _text(frame, "fault")
    late = _number(frame, "lateness") * 1e3
    return [
        f"  {_RED if fault else _BOLD}{mode:<8}{_OFF}"
        f"   tick {_number(frame, 'tick'):.0f}   {_number(frame, 'rate_hz'):g} Hz"
        f"   late {late:5.2f} ms   missed {_number(frame, 'missed'):.0f}",
        f"  {_RED}{fault}{_OFF}" if fault else "",
    ]


def _joint(joint: Table, ranges: Mapping[str, Range], selected: bool) -> str:
    name = _text(joint, "name")
    position, velocity = _number(joint, "position"), _number(joint, "velocity")
    predictions = [_as_number(value) for value in _table(joint["predictions"]).values()]
    expected = predictions[-1] if predictions else math.nan
    mark = f"{_BOLD}▸{_OFF}" if selected else " "
    freshness = _text(joint, "freshness")
    why = _text(joint, "holder") if freshness == "fresh" else f"{freshness} {_number(joint, 'age'):.1f} s"
    return (
        f"  {mark} {name:<18} {_degrees(position)}  {_bar(position, expected, ranges.get(name))}"
        f"  {_degrees(velocity)}/s  {_text(joint, 'mode'):<8}  {_degrees(expected)}  {why}"
    )


def _bar(position: float, expected: float, limits: Range | None, width: int = 21) -> str:
    """Where the joint is (●) and is expected to be (○) between its limits."""
    cells = ["·"] * width
    for value, sign in ((expected, "○"), (position, "●")):
        if limits and math.isfinite(value):
            share = (value - limits.minimum) / (limits.maximum - limits.minimum)
            cells[min(max(round(share * (width - 1)), 0), width - 1)] = sign
    return "".join(cells)


def _muscles(frame: Table) -> list[str]:
    emg = _table(frame["emg"])
    problem = _text(emg, "problem")
    if problem:
        return [f"  muscles   {_RED}{problem}{_OFF}"]
    sites = "   ".join(f"{site} {_gauge(_as_number(v))}" for site, v in _table(emg["effort"]).items())
    paused = "   (paused)" if emg["paused"] else ""
    return [f"  muscles   {sites}   toggles {_number(emg, 'toggles'):.0f}{paused}"]


def _gauge(effort: float, width: int = 10) -> str:
    full = round(effort * width)
    return "█" * full + "░" * (width - full)


def _selected(group: Table) -> list[str]:
    return [str(j) for j in _list(group, "joints")] if group.get("together") else [_text(group, "active")]


def _assist(frame: Table) -> list[str]:
    """What helps, and with what all at once may be done: a cue at any moment (thesis 5.6.6)."""
    assist = _table(frame["assist"])
    told = [f"  assist    {_text(assist, 'reason')}"]
    if any(_table(group).get("together") for group in _list(frame, "groups")):
        return [*told, f"  {_BOLD}together  push to go on, pull to go back, toggle to leave{_OFF}"]
    return [*told, "  together  may be selected"] if assist.get("offers_together") else told


def _goal(frame: Table) -> list[str]:
    if frame["goal"] is None:
        return []
    goal = _table(frame["goal"])
    reason = f": {_text(goal, 'reason')}" if goal["reason"] else ""
    return [f"  {_text(goal, 'kind'):<9} {_text(goal, 'status')} {_number(goal, 'progress'):.0%}{reason}"]


def _degrees(radians: float) -> str:
    return f"{math.degrees(radians):+7.1f}°" if math.isfinite(radians) else "      – "


def _table(value: Value) -> Table:
    return value if isinstance(value, dict) else {}


def _list(table: Table, key: str) -> list[Value]:
    value = table.get(key)
    return value if isinstance(value, list) else []


def _text(table: Table, key: str) -> str:
    return _printable(str(table.get(key, "")))


def _printable(text: str) -> str:
    """`text` without what would steer the terminal: a client chooses its own name."""
    return "".join(letter if letter.isprintable() else "?" for letter in text)


def _cut(line: str) -> str:
    """`line` with no more than WIDTH visible columns; colours take none."""
    kept, columns = [], 0
    for part in _COLOUR.split(line):
        shown = part if _COLOUR.fullmatch(part) else part[: WIDTH - columns]
        columns += 0 if _COLOUR.fullmatch(part) else len(shown)
        kept.append(shown)
    return "".join(kept)


def _number(table: Table, key: str) -> float:
    return _as_number(table.get(key))


def _as_number(value: Value) -> float:
    return float(value) if isinstance(value, int | float) else math.nan
