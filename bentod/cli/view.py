"""The live view as lines of text: what the arm does, why, and what it expects. Pure; `watch` draws it."""

import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from bentod.cli.telling import printable
from bentod.cli.view_joints import Range, joint_rows
from bentod.cli.view_session import (
    assist_lines,
    goal_lines,
    group_lines,
    health_lines,
    muscle_lines,
    recording_lines,
    trial_lines,
)
from bentod.cli.view_style import BOLD, DIM, OFF, RED, cut
from bentod.cli.view_values import Table, number, text

WIDTH = 100
"""Columns that the whole view needs; with fewer, velocities are left out."""


@dataclass(frozen=True, slots=True)
class Aside:
    """What stands beside the frame."""

    recording: Table = field(default_factory=dict)  # as `get_recording` tells it; empty: nobody knows
    group: str = ""  # that keys are for
    page: str = ""  # where the page is; empty: this user serves none
    foot: Sequence[str] = ()  # the last lines, whatever room there is


NOTHING = Aside()


def screen(
    frame: Table,
    ranges: Mapping[str, Range],
    events: Sequence[str],
    aside: Aside,
    width: int,
    height: int,
) -> list[str]:
    """One frame in a window: events as there is room, the newest last, and the foot always."""
    foot = [cut(line, width) for line in aside.foot[:height]]
    above = [cut(line, width) for line in _body(frame, ranges, aside, width)][: height - len(foot)]
    room = height - len(foot) - len(above) - 1
    told = [cut(line, width) for line in _told(events)][-room:] if room > 0 else []
    filled = [*above, *([""] if told else []), *told]
    return [*filled, *[""] * (height - len(foot) - len(filled)), *foot]


def lines(frame: Table, ranges: Mapping[str, Range], events: Sequence[str]) -> list[str]:
    """One frame where there is room for all of it; `events`: the latest sentences, oldest first."""
    return [cut(line, WIDTH) for line in [*_body(frame, ranges, NOTHING, WIDTH), "", *_told(events)]]


def _body(frame: Table, ranges: Mapping[str, Range], aside: Aside, width: int) -> list[str]:
    return [
        _head(frame),
        *_fault(frame, width, bool(aside.group)),
        *joint_rows(frame, ranges, aside.group, width),
        "",
        *group_lines(frame, aside.group),
        *muscle_lines(frame),
        *assist_lines(frame),
        *goal_lines(frame),
        *health_lines(frame),
        *recording_lines(aside.recording),
        *trial_lines(frame),
        *([f"  page      {aside.page}"] if aside.page else []),
    ]


def _head(frame: Table) -> str:
    mode, fault = text(frame, "mode").upper(), text(frame, "fault")
    late = number(frame, "lateness") * 1e3
    return (
        f"  {RED if fault else BOLD}{mode:<8}{OFF}"
        f"   tick {number(frame, 'tick'):.0f}   {number(frame, 'rate_hz'):g} Hz"
        f"   late {late:5.2f} ms   missed {number(frame, 'missed'):.0f}"
    )


def _fault(frame: Table, width: int, keys: bool) -> list[str]:
    """Why the arm does not move, in two lines at most, and the way back; else an empty line."""
    fault = text(frame, "fault")
    if not fault:
        return [""]
    told = textwrap.wrap(fault, max(width - 2, 20), max_lines=2, placeholder=" …")
    back = "p" if keys else "bentod ctl pause off"
    return [*(f"  {RED}{line}{OFF}" for line in told), f"  → bentod ctl clear-fault, then {back}"]


def _told(events: Sequence[str]) -> list[str]:
    return [f"{DIM}  {printable(event)}{OFF}" for event in events]
