"""Counts what is written or read, and notices what is missing: ticks by number, samples by index."""

import math
from collections.abc import Iterable
from dataclasses import replace
from typing import NamedTuple

from bentod.frames import EmgBlock, Frame
from bentod.record.session import KINDS, Counts, Entry, Gap, Tally

GAPS = 100
"""How many gaps of each kind are told one by one; more are only counted."""


class Point(NamedTuple):
    """What is counted of one entry."""

    time: float  # monotonic s
    number: int = 0  # a frame's tick, the index of a block's first sample
    extra: int = 0  # a frame's `missed`, a block's samples


def point(entry: Entry) -> Point:
    """What is counted of `entry`."""
    if isinstance(entry, Frame):
        return Point(entry.time, entry.tick, entry.missed)
    if isinstance(entry, EmgBlock):
        return Point(entry.time, entry.first_index, len(entry.samples))
    return Point(entry.time)


class Counter:
    """Counts entry by entry."""

    def __init__(self) -> None:
        self._numbers: dict[type[object], int] = dict.fromkeys(KINDS, 0)
        self._dropped = Counts()
        self._start, self._end = math.inf, -math.inf
        self._frames: tuple[Point, Point] | None = None  # the first and the last
        self._blocks: tuple[Point, Point] | None = None
        self._samples = 0
        self._tick_gaps: list[Gap] = []
        self._emg_gaps: list[Gap] = []
        self._ticks_missing = self._samples_missing = 0

    @property
    def written(self) -> Counts:
        """Entries so far."""
        return Counts(*self._numbers.values())

    @property
    def end(self) -> float:
        """Monotonic s of the latest entry; nan if there is none."""
        return self._end if math.isfinite(self._end) else math.nan

    def drop(self, counts: Counts) -> None:
        """Entries that were not written."""
        self._dropped += counts

    def add(self, kind: type[object], what: Point) -> None:
        """One more entry."""
        self._numbers[kind] += 1
        if what.time < self._start:
            self._start = what.time
        if what.time > self._end:
            self._end = what.time
        if kind is Frame:
            self._frame(what)
        elif kind is EmgBlock:
            self._block(what)

    def tally(self) -> Tally:
        """The counts as of now."""
        made = Tally(
            written=self.written,
            dropped=self._dropped,
            start=self._start if math.isfinite(self._start) else math.nan,
            end=self.end,
            samples=_fit(self._samples),
            tick_gaps=tuple(self._tick_gaps),
            emg_gaps=tuple(self._emg_gaps),
            ticks_missing=_fit(self._ticks_missing),
            samples_missing=_fit(self._samples_missing),
        )
        return self._emg(self._ticks(made))

    def _ticks(self, made: Tally) -> Tally:
        if self._frames is None:
            return made
        first, last = self._frames
        return replace(
            made,
            first_tick=first.number,
            last_tick=last.number,
            first_frame=first.time,
            last_frame=last.time,
            first_missed=first.extra,
            last_missed=last.extra,
        )

    def _emg(self, made: Tally) -> Tally:
        if self._blocks is None:
            return made
        first, last = self._blocks
        return replace(
            made,
            first_index=first.number,
            next_index=_next(last),
            first_sample=first.time,
            last_sample=last.time,
        )

    def _frame(self, frame: Point) -> None:
        first, last = self._frames or (frame, None)
        self._frames = (first, frame)
        if last is not None and frame.number != last.number + 1:
            missing = frame.number - last.number - 1
            self._ticks_missing += max(missing, 0)
            _keep(self._tick_gaps, Gap(last.time, frame.time, _fit(missing)))

    def _block(self, block: Point) -> None:
        self._samples += block.extra
        first, last = self._blocks or (block, None)
        self._blocks = (first, block)
        if last is not None and block.number != _next(last):
            missing = block.number - _next(last)
            self._samples_missing += max(missing, 0)
            _keep(self._emg_gaps, Gap(last.time, block.time, _fit(missing)))


def _keep(gaps: list[Gap], gap: Gap) -> None:
    if len(gaps) < GAPS:
        gaps.append(gap)


def _next(block: Point) -> int:
    """Index after the last sample of a block."""
    return _fit(block.number + block.extra)


def _fit(number: int) -> int:
    """A number as a file has room for it."""
    return min(max(number, -(1 << 63)), (1 << 63) - 1)


def joined(tallies: Iterable[Tally]) -> Tally:
    """The tally of stretches that follow one another, with what is missing between them."""
    total = Tally()
    for tally in tallies:
        total = _joined(total, tally)
    return total


def _joined(one: Tally, two: Tally) -> Tally:
    ticks, samples = _tick_gap(one, two), _emg_gap(one, two)
    return Tally(
        written=one.written + two.written,
        dropped=one.dropped + two.dropped,
        start=_least(one.start, two.start),
        end=-_least(-one.end, -two.end),
        **_ends(one, two),  # type: ignore[arg-type]
        samples=one.samples + two.samples,
        tick_gaps=(*one.tick_gaps, *ticks, *two.tick_gaps),
        emg_gaps=(*one.emg_gaps, *samples, *two.emg_gaps),
        ticks_missing=one.ticks_missing + two.ticks_missing + _missing(ticks),
        samples_missing=one.samples_missing + two.samples_missing + _missing(samples),
    )


def _ends(one: Tally, two: Tally) -> dict[str, float]:
    """The first of what begins and the last of what ends, where there is any."""
    frames, blocks = two.written.frames > 0, two.written.emg > 0
    last, late = (two if frames else one), (two if blocks else one)
    first, early = (one if one.written.frames else two), (one if one.written.emg else two)
    return {
        "first_tick": first.first_tick,
        "first_frame": first.first_frame,
        "first_missed": first.first_missed,
        "last_tick": last.last_tick,
        "last_frame": last.last_frame,
        "last_missed": last.last_missed,
        "first_index": early.first_index,
        "first_sample": early.first_sample,
        "next_index": late.next_index,
        "last_sample": late.last_sample,
    }


def _tick_gap(one: Tally, two: Tally) -> tuple[Gap, ...]:
    missing = two.first_tick - one.last_tick - 1
    if not (one.written.frames and two.written.frames and missing):
        return ()
    return (Gap(one.last_frame, two.first_frame, missing),)


def _emg_gap(one: Tally, two: Tally) -> tuple[Gap, ...]:
    missing = two.first_index - one.next_index
    if not (one.written.emg and two.written.emg and missing):
        return ()
    return (Gap(one.last_sample, two.first_sample, missing),)


def _missing(gaps: Iterable[Gap]) -> int:
    return sum(max(gap.missing, 0) for gap in gaps)


def _least(one: float, two: float) -> float:
    """The lesser of two numbers of which either may be nan: nothing."""
    return two if math.isnan(one) else one if math.isnan(two) else min(one, two)
