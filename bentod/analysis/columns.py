"""A recording as flat tables: which columns there are, and a tick, an event or a command as one row each."""

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass
from operator import attrgetter
from typing import Literal, TypeAlias, get_type_hints

import numpy as np
from numpy.typing import NDArray

from bentod.analysis import words
from bentod.analysis.words import Word
from bentod.control.arbiter import PRIORITY
from bentod.frames import (
    AssistFrame,
    ClientCommand,
    Command,
    Costs,
    EmgFrame,
    Event,
    Frame,
    GoalFrame,
    GroupFrame,
    JointFrame,
    Position,
    Stop,
    StopReport,
    Trial,
    Value,
    Velocity,
)

Kind: TypeAlias = Literal["float", "float32", "int", "bool", "text"]
Cell: TypeAlias = "float | int | bool | str | None"
Cells: TypeAlias = "Sequence[Cell] | NDArray[np.generic]"

RESERVED = frozenset({"costs", "emg", "group", "assist", "goal", "trial", "meta", "other"})
"""Beginnings of columns that belong to no joint."""


@dataclass(frozen=True, slots=True)
class Column:
    """One column of a table."""

    name: str
    kind: Kind
    unit: str
    meaning: str


EVENTS = (
    Column("time_s", "float", "s", "monotonic time"),
    Column("kind", "text", "", "mode, fault, group, goal, emg, servo, client, trial, …"),
    Column("text", "text", "", "what happened, as a sentence"),
    Column("data", "text", "", "JSON of what belongs to it"),
)

COMMANDS = (
    Column("time_s", "float", "s", "monotonic time at which it was carried out or refused"),
    Column("tick", "int", "", "number of the tick before which that was"),
    Column("client", "text", "", "who asked"),
    Column("method", "text", "", "what was asked"),
    Column("params", "text", "", "JSON of the parameters as they were sent"),
    Column("error", "text", "", "why it was refused; empty if it was not"),
)


def event_row(event: Event) -> tuple[Cell, ...]:
    """The cells of `EVENTS`."""
    return event.time, event.kind, event.text, as_json(dict(event.data))


def command_row(command: ClientCommand) -> tuple[Cell, ...]:
    """The cells of `COMMANDS`."""
    asked = as_json(command.params)
    return command.time, command.tick, command.client, command.method, asked, command.error


def as_json(value: object) -> str:
    """`value` as JSON text: dataclasses as maps of their fields, bytes as hexadecimal text.

    What is not finite becomes NaN, Infinity or -Infinity, as Python's own reader takes it.
    """
    return json.dumps(value, ensure_ascii=False, default=_plain)


def _plain(value: object) -> object:
    if isinstance(value, bytes):
        return value.hex()
    if is_dataclass(value):
        return {field.name: getattr(value, field.name) for field in fields(value)}
    return dict(value) if isinstance(value, Mapping) else str(value)


class TickColumns:
    """The columns of a tick, fitted to some of the recording's frames."""

    def __init__(self, joints: Sequence[str], examples: Sequence[Frame]) -> None:
        """`joints`: their names. What appears in none of `examples` goes to the column `other`."""
        seen = [joint for frame in examples for joint in frame.joints]
        self._sources = _union([PRIORITY, *(joint.asked for joint in seen)])
        self._timescales = _union(joint.predictions for joint in seen)
        self._sites = _union(frame.emg.effort for frame in examples)
        self._groups = _union([group.name for group in frame.groups] for frame in examples)
        asked = _union(frame.learn.surprise for frame in examples)  # the errors come only after a while
        self._gvfs = dict.fromkeys(("confidence", "surprise", "error"), asked)
        for told in ("predictions", "familiarity"):
            self._gvfs[told] = _union(getattr(frame.learn, told) for frame in examples)
        gvfs = _union(self._gvfs.values())
        self._known = frozenset((*self._sources, *self._timescales, *self._sites, *gvfs))
        self._joints = tuple(joints)
        self._texts: dict[tuple[str, ...], str] = {}
        self.columns = tuple(self._columns())

    def _columns(self) -> list[Column]:
        found = [*_leaves(Frame, words.FRAME), *_leaves(Costs, words.COSTS, "costs.")]
        found += [*_leaves(Trial, words.TRIAL, "trial."), *_leaves(EmgFrame, words.EMG, "emg.")]
        found += _named("emg.effort.", self._sites, words.EFFORT)
        found.append(_column("emg.recognition", "text", words.RECOGNITION))
        found.append(_column("joystick", "text", words.JOYSTICK))
        for group in self._groups:
            found += _leaves(GroupFrame, words.GROUP, f"group.{group}.")
            found.append(_column(f"group.{group}.joints", "text", words.JOINTS_OF_GROUP))
        found += [*_leaves(AssistFrame, words.ASSIST, "assist."), *_leaves(GoalFrame, words.GOAL, "goal.")]
        found.append(_column("assist.moving", "text", words.MOVING))
        found.append(_column("more_assists", "text", words.MORE_ASSISTS))
        found.append(_column("learn.older", "text", words.OLDER))
        for told, keys in self._gvfs.items():
            found += _named(f"learn.{told}.", keys, words.LEARN[told])
        for joint in self._joints:
            found += self._columns_of(f"joint.{joint}." if joint in RESERVED else f"{joint}.")
        return [*found, _column("meta", "text", words.META), _column("other", "text", words.OTHER)]

    def _columns_of(self, prefix: str) -> list[Column]:
        found = _leaves(JointFrame, words.JOINT, prefix)
        found += [_column(f"{prefix}errors", "text", words.ERRORS)]
        found += _leaves(StopReport, words.STOP, f"{prefix}stop.")
        for source in self._sources:
            found += _command_columns(f"{prefix}asked.{source}.")
        found += _command_columns(f"{prefix}sent.")
        return found + _named(f"{prefix}prediction.", self._timescales, words.PREDICTION)

    def cells(self, frames: Sequence[Frame]) -> list[Cells]:
        """What `frames` hold, as one sequence for each of `columns`."""
        other: list[dict[str, Value]] = [{} for _ in frames]
        cells = _cells(Frame, frames) + _cells(Costs, [frame.costs for frame in frames])
        cells += _cells(Trial, [frame.trial for frame in frames])
        cells += _cells(EmgFrame, [frame.emg for frame in frames])
        cells += self._by_key("emg.effort", [frame.emg.effort for frame in frames], self._sites, other)
        recognised = [frame.emg.recognition for frame in frames]
        cells.append([as_json(found) if found else "" for found in recognised])
        cells.append([as_json(frame.joystick) if frame.joystick else "" for frame in frames])
        cells += self._group_cells(frames, other)
        cells += _cells(AssistFrame, [frame.assist for frame in frames])
        cells += _cells(GoalFrame, [frame.goal for frame in frames])
        cells.append([as_json(frame.assist.moving) if frame.assist.moving else "" for frame in frames])
        cells.append([as_json(frame.more_assists) if frame.more_assists else "" for frame in frames])
        cells.append([as_json(frame.learn.older) if frame.learn.older else "" for frame in frames])
        for told, keys in self._gvfs.items():
            found = [getattr(frame.learn, told) for frame in frames]
            cells += self._by_key(f"learn.{told}", found, keys, other)
        for joint in zip(*(frame.joints for frame in frames), strict=True):
            cells += self._joint_cells(joint, other)
        cells.append([_NULL if frame.meta is None else as_json(frame.meta) for frame in frames])
        cells.append([as_json(rest) if rest else "" for rest in other])
        return cells

    def _group_cells(self, frames: Sequence[Frame], other: list[dict[str, Value]]) -> list[Cells]:
        by_name = [{group.name: group for group in frame.groups} for frame in frames]
        cells: list[Cells] = []
        for name in self._groups:
            groups = [found.pop(name, None) for found in by_name]
            cells += _cells(GroupFrame, groups)
            cells.append([self._text_of(group.joints) if group else None for group in groups])
        for found, rest in zip(by_name, other, strict=True):
            for name, group in found.items():
                rest[f"group.{name}"] = [group.active, group.effort, group.operator, list(group.joints)]
        return cells

    def _joint_cells(self, joint: Sequence[JointFrame], other: list[dict[str, Value]]) -> list[Cells]:
        name = joint[0].name
        cells = _cells(JointFrame, joint)
        cells.append([self._text_of(seen.errors) for seen in joint])
        cells += _cells(StopReport, [seen.stop for seen in joint])
        for source in self._sources:
            cells += _command_cells([seen.asked.get(source) for seen in joint])
        cells += _command_cells([seen.sent for seen in joint])
        predictions = [seen.predictions for seen in joint]
        cells += self._by_key(f"{name}.prediction", predictions, self._timescales, other)
        for seen, rest in zip(joint, other, strict=True):
            if not self._known >= seen.asked.keys():
                unplaced = seen.asked.keys() - self._known
                rest[f"{name}.asked"] = {key: list(_command(seen.asked[key])) for key in unplaced}
        return cells

    def _by_key(
        self,
        path: str,
        found: Sequence[Mapping[str, float]],
        keys: Sequence[str],
        other: list[dict[str, Value]],
    ) -> list[Cells]:
        for values, rest in zip(found, other, strict=True):
            if not self._known >= values.keys():
                rest[path] = {key: value for key, value in values.items() if key not in self._known}
        return [[values.get(key) for values in found] for key in keys]

    def _text_of(self, names: tuple[str, ...]) -> str:
        if names not in self._texts:
            self._texts[names] = as_json(names)
        return self._texts[names]


def _union(keys: Iterable[Iterable[str]]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(key for some in keys for key in some))


_KINDS: Mapping[object, Kind] = {float: "float", int: "int", bool: "bool"}
_NESTED = frozenset(
    {"costs", "joints", "emg", "groups", "assist", "goal", "meta", "trial", "effort", "joystick"}
    | {"errors", "stop", "asked", "sent", "predictions", "learn", "more_assists", "moving", "recognition"}
)
"""Fields that are not one value and have columns of another form."""


def _names(kind: type) -> tuple[str, ...]:
    """Fields of `kind` that have a column each; a group's effort is one number, the muscles' one a site."""
    left_out = {"name", "joints"} if kind is GroupFrame else _NESTED
    if kind is JointFrame:
        left_out = _NESTED | {"name"}
    return tuple(field.name for field in fields(kind) if field.name not in left_out)


def _leaves(kind: type, told: Mapping[str, Word], prefix: str = "") -> list[Column]:
    hints = get_type_hints(kind)
    return [
        _column(f"{prefix}{name}", _KINDS.get(hints[name], "text"), told.get(name, words.UNKNOWN))
        for name in _names(kind)
    ]


def _column(path: str, kind: Kind, word: Word) -> Column:
    suffix = words.SUFFIXES.get(word.unit, "")
    name = path if path.endswith(suffix) else path + suffix
    return Column(name, kind, word.unit, word.meaning)


def _named(prefix: str, names: Sequence[str], word: Word) -> list[Column]:
    """Columns whose last part is a name from the config, and so carries no unit."""
    return [Column(f"{prefix}{name}", "float", word.unit, word.meaning) for name in names]


def _command_columns(prefix: str) -> list[Column]:
    return [
        _column(f"{prefix}{field}", "text" if field == "kind" else "float", words.COMMAND[field])
        for field in ("kind", "position", "velocity", "speed")
    ]


def _cells(kind: type, found: Sequence[object]) -> list[Cells]:
    """The values of `found`, which are of `kind` or None, as a sequence for each column of `_leaves`."""
    names = _names(kind)
    if all(one is None for one in found):
        return [[None] * len(found)] * len(names)
    getters = [attrgetter(name) for name in names]
    if any(one is None for one in found):
        return [[None if one is None else get(one) for one in found] for get in getters]
    return [list(map(get, found)) for get in getters]


def _command_cells(commands: Sequence[Command | None]) -> list[Cells]:
    if all(command is None for command in commands):
        return [[None] * len(commands)] * len(_NO_COMMAND)
    return list(zip(*map(_command, commands), strict=True))


def _command(command: Command | None) -> tuple[Cell, ...]:
    match command:
        case None:
            return _NO_COMMAND
        case Stop():
            return _STOPPED
        case Velocity():
            return ("velocity", None, command.velocity, None)
        case Position():
            return ("position", command.position, None, command.speed)


_NO_COMMAND: tuple[Cell, ...] = (None, None, None, None)
_STOPPED: tuple[Cell, ...] = ("stop", None, None, None)
_NULL = "null"
