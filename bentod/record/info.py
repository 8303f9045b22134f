"""What there is in a session and what is missing, from what is known of its parts."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from bentod.frames import Trial, Value
from bentod.record.session import Info, Mark, Tally, TrialSpan
from bentod.record.tally import joined


@dataclass(frozen=True, slots=True)
class PartInfo:
    """What is known of one file."""

    path: Path
    part: int
    bytes: int
    closed: bool
    live: bool
    lost: int  # bytes at its end that are no whole record
    tally: Tally
    marks: tuple[Mark, ...]
    problems: tuple[str, ...]


def combined(parts: Sequence[PartInfo], expected: Iterable[int], problems: Sequence[str]) -> Info:
    """The whole session; `expected`: numbers of the parts that should be there."""
    tally = joined(part.tally for part in parts)
    absent = sorted(set(expected) - {part.part for part in parts})
    found = [*problems, *(f"Part {number} is missing." for number in absent)]
    found += [problem for part in parts for problem in _problems(part)]
    marks = [mark for part in parts for mark in part.marks]
    return Info(
        files=tuple(part.path for part in parts),
        bytes=sum(part.bytes for part in parts),
        counts=tally.written,
        dropped=tally.dropped,
        start=tally.start,
        end=tally.end,
        complete=not found and all(part.closed for part in parts),
        live=any(part.live for part in parts),
        problems=tuple(found),
        tick_gaps=tally.tick_gaps,
        emg_gaps=tally.emg_gaps,
        ticks_missing=tally.ticks_missing,
        ticks_skipped=tally.last_missed - tally.first_missed,
        samples=tally.samples,
        samples_missing=tally.samples_missing,
        trials=tuple(_trials(marks, tally.last_frame)),
        metas=tuple(_metas(marks)),
    )


def _problems(part: PartInfo) -> Iterator[str]:
    yield from part.problems
    if not part.closed and not part.live:
        torn = f", and its last {part.lost} bytes are torn" if part.lost else ""
        yield f"{part.path.name} is cut off: it was never closed{torn}."


def _trials(marks: Iterable[Mark], last: float) -> Iterator[TrialSpan]:
    running: Trial | None = None
    since = 0.0
    for mark in marks:
        if mark.trial == running:
            continue
        if running is not None:
            yield TrialSpan(running, since, mark.time, ended=True)
        running, since = mark.trial, mark.time
    if running is not None:
        yield TrialSpan(running, since, last, ended=False)


def _metas(marks: Iterable[Mark]) -> Iterator[tuple[float, Value]]:
    current: Value = None
    for mark in marks:
        if mark.meta != current:
            current = mark.meta
            yield mark.time, current
