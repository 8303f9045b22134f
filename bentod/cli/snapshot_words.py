"""Snapshots of what was learned, in words and tables."""

import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np

from bentod.frames import Value
from bentod.learn.differences import Sides, by_name, differences
from bentod.learn.snapshot import Snapshot
from bentod.learn.snapshot_layout import Array

COLUMNS = ("cumulant", "gamma", "lam", "step_size", "algorithm", "representation")
"""Of a question, besides its name, as far as the snapshot tells them."""

_LONGEST = 500  # characters of a line about something that may be long

ARRAY_HEAD = ("array", "kind", "shape", "bytes", "least", "greatest", "not finite")


def sentences(path: Path, snapshot: Snapshot, size: int) -> Iterator[str]:
    """What a snapshot is of. `size`: bytes of the file."""
    header = snapshot.header
    wall, tick = header.get("wall"), header.get("tick")
    when = "?"
    if isinstance(wall, int | float) and 0 <= wall < 1e11:
        when = time.strftime("%Y-%m-%d %H:%M:%S UTC", time.gmtime(wall))
    questions = by_name(snapshot.spec.get("questions")) or {}
    numbers = sum(array.size for array in snapshot.arrays.values())
    yield f"{path}: whole, {size} bytes, {snapshot.digest[:16]}"
    arm, version = (_cell(header.get(key)) for key in ("arm", "bentod"))
    yield f"taken    {when}, tick {_cell(tick)}, of {arm}, by bentod {version}"
    yield f"holds    {len(questions)} questions, {len(snapshot.arrays)} arrays of {numbers} numbers"
    for key, value in snapshot.spec.items():
        yield from (line if len(line) <= _LONGEST else f"{line[:_LONGEST]}…" for line in _told(key, value))


def _told(key: str, value: Value) -> Iterator[str]:
    """A part of the specification that is no table of questions."""
    if key == "questions":
        return
    for name, table in (by_name(value) or {}).items():
        told = table if isinstance(table, dict) else {}
        facts = ", ".join(f"{fact} {_cell(it)}" for fact, it in told.items() if fact != "name")
        yield f"{key.removesuffix('s')} {name}: {facts}"
    if by_name(value) is None:
        yield f"{key}: {_cell(value)}"


def questions(snapshot: Snapshot) -> list[list[str]]:
    """A head, and one row a question."""
    tables = by_name(snapshot.spec.get("questions")) or {}
    asked = {name: table for name, table in tables.items() if isinstance(table, dict)}
    columns = [column for column in COLUMNS if any(column in table for table in asked.values())]
    rows = [[name, *(_cell(table.get(column)) for column in columns)] for name, table in asked.items()]
    return [["question", *columns], *rows]


def arrays(snapshot: Snapshot) -> list[list[str]]:
    """One row an array."""
    return [[name, *_facts(array)] for name, array in snapshot.arrays.items()]


def _facts(array: Array) -> Sequence[str]:
    numbers = array.astype(np.float64).ravel()
    finite = numbers[np.isfinite(numbers)]
    ends = (f"{finite.min():.4g}", f"{finite.max():.4g}") if len(finite) else ("", "")
    return (str(array.dtype), _shape(array), str(array.nbytes), *ends, str(len(numbers) - len(finite)))


def told_apart(one: Snapshot, other: Snapshot, sides: Sides) -> list[str]:
    """In which way what two snapshots answer, or what they have learned, differs."""
    found = differences(one.spec, other.spec, sides)
    found += [f"the array {name} is only {sides.one}" for name in one.arrays if name not in other.arrays]
    found += [f"the array {name} is only {sides.other}" for name in other.arrays if name not in one.arrays]
    both = [name for name in one.arrays if name in other.arrays]
    pairs = ((name, one.arrays[name], other.arrays[name]) for name in both)
    return found + [text for name, mine, theirs in pairs if (text := _apart(name, mine, theirs, sides))]


def _apart(name: str, mine: Array, theirs: Array, sides: Sides) -> str:
    if (mine.shape, mine.dtype) != (theirs.shape, theirs.dtype):
        return (
            f"the array {name} is {_shape(mine)} {mine.dtype} {sides.one}, "
            f"{_shape(theirs)} {theirs.dtype} {sides.other}"
        )
    if mine.tobytes() == theirs.tobytes():
        return ""
    with np.errstate(invalid="ignore", over="ignore"):
        apart = np.abs(mine.astype(np.float64) - theirs.astype(np.float64))
    differing = int(np.count_nonzero((mine != theirs) & ~(np.isnan(apart) & _both_nan(mine, theirs))))
    return f"the array {name}: {differing} of {mine.size} numbers differ, by at most {np.nanmax(apart):.4g}"


def _both_nan(mine: Array, theirs: Array) -> Array:
    return np.isnan(mine.astype(np.float64)) & np.isnan(theirs.astype(np.float64))


def _shape(array: Array) -> str:
    return " × ".join(map(str, array.shape)) or "one number"


def _cell(value: Value) -> str:
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{key} {_cell(it)}" for key, it in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_cell, value)) + "]"
    return "–" if value is None else str(value)
