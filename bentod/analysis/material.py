"""What figures and reports are made from: one pass over a recording, as numpy columns."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bentod.analysis.circuits import Circuit, circuits
from bentod.analysis.columns import Cells, Column
from bentod.analysis.setup import Setup, setup
from bentod.analysis.stream import UnfitRecording, pour
from bentod.analysis.table import Floats, Gather, Table
from bentod.control.proportional import Envelope
from bentod.frames import Event
from bentod.record.reader import Recording
from bentod.record.session import Header, Info

LEVEL_S = 0.05
"""One EMG level is kept for so many seconds: the greatest of them."""

_NAMES = frozenset({"tick", "time_s", "lateness_s", "missed", "mode", "gap", "assist.engaged"})
_ENDS = (".position_rad", ".holder", ".active")
_COSTS = "costs."


@dataclass(frozen=True, slots=True)
class Levels:
    """EMG as the controller weighs it: mean absolute values over its window."""

    time: Floats  # monotonic s
    volts: Floats  # before gain, shape (levels, channels)


@dataclass(frozen=True, slots=True)
class Material:
    """A stretch of a recording in memory."""

    header: Header
    info: Info
    setup: Setup
    ticks: Table
    events: tuple[Event, ...]
    circuits: tuple[Circuit, ...]
    levels: Levels | None  # None: there is no EMG

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the joints."""
        return tuple(spec.name for spec in self.header.joints)

    @property
    def time(self) -> Floats:
        """Of each tick, s since the session started."""
        return self.since_start(self.ticks.floats("time_s"))

    def since_start(self, time: Floats) -> Floats:
        """Monotonic s as s since the session started."""
        return time - self.header.started

    def position(self, joint: str) -> Floats:
        """Rad, at each tick."""
        return self.ticks.floats(f"{joint}.position_rad")

    def predictions(self, joint: str) -> dict[str, Floats]:
        """Rad, at each tick, by timescale in steps; NaN where there is none."""
        start = f"{joint}.prediction."
        names = [column.name for column in self.ticks.columns if column.name.startswith(start)]
        found = {name.removeprefix(start): self.ticks.floats(name) for name in names}
        return {name: values for name, values in found.items() if np.isfinite(values).any()}

    def breaks(self) -> NDArray[np.bool_]:
        """Whether each tick does not follow on the one before it: ticks are missing, or it is the first."""
        tick = self.ticks.floats("tick")
        breaks: NDArray[np.bool_] = np.diff(tick, prepend=np.nan) != 1
        return breaks | (self.ticks.floats("gap") > 0)


def gather(recording: Recording, start: float | None = None, end: float | None = None) -> Material:
    """The material from `start` to `end` (s since the session started; None: all).

    Raises:
        UnfitRecording: there is no tick.
        BentodError: the recording cannot be read.
    """
    header = recording.header
    known = setup(header.config)
    sink = _Sink(known)
    first, last = (None if at is None else header.started + at for at in (start, end))
    rows = pour(recording, sink, ("ticks", "emg"), first, last)
    if not rows["ticks"]:
        raise UnfitRecording(
            f"{header.session} holds no tick{_stretch(start, end)}; there is nothing to show"
        )
    return Material(
        header,
        recording.info,
        known,
        sink.gather.tables["ticks"],
        tuple(recording.events(first, last)),
        tuple(circuit for circuit in circuits(recording) if _overlaps(circuit, first, last)),
        sink.levels(),
    )


def _stretch(start: float | None, end: float | None) -> str:
    if start is None and end is None:
        return ""
    begin = "the start" if start is None else f"{start:g} s"
    return f" from {begin} to {'the end' if end is None else f'{end:g} s'}"


def _overlaps(circuit: Circuit, start: float | None, end: float | None) -> bool:
    over = circuit.start + circuit.time
    return (start is None or over > start) and (end is None or circuit.start < end)


def _wanted(name: str) -> bool:
    plain = name in _NAMES or name.startswith(_COSTS) or ".prediction." in name
    return plain or (name.endswith(_ENDS) and ".asked." not in name and ".sent." not in name)


class _Sink:
    """Keeps some columns of the ticks, and of the EMG its levels only."""

    def __init__(self, known: Setup) -> None:
        self.gather = Gather(_wanted)
        self._window = known.window
        self._per_level = max(1, round(known.emg_rate_hz * LEVEL_S))
        self._envelope = Envelope(known.window)
        self._next = -1
        self._times: list[Floats] = []
        self._volts: list[Floats] = []

    def begin(self, table: str, columns: Sequence[Column]) -> None:
        if table == "ticks":
            self.gather.begin(table, columns)

    def write(self, table: str, cells: Sequence[Cells]) -> None:
        if table == "ticks":
            self.gather.write(table, cells)
        else:
            self._add(cells)

    def _add(self, cells: Sequence[Cells]) -> None:
        """Levels of some samples; where samples are missing, the window begins anew."""
        index, time = np.asarray(cells[0]), np.asarray(cells[1], dtype=np.float64)
        samples = np.stack([np.asarray(channel, dtype=np.float32) for channel in cells[4:]], axis=1)
        jumps = np.flatnonzero(np.diff(index, prepend=self._next - 1) != 1)
        self._next = int(index[-1]) + 1
        for start, end in zip([0, *jumps], [*jumps, len(index)], strict=True):
            if start in jumps:
                self._envelope.reset()
            volts = self._envelope.step(samples[start:end])
            for at in range(0, end - start, self._per_level):
                piece = volts[at : at + self._per_level]
                self._times.append(time[start + at : start + at + 1])
                self._volts.append(np.where(np.isnan(piece).all(axis=0), np.nan, _greatest(piece))[None])

    def levels(self) -> Levels | None:
        if not self._times:
            return None
        return Levels(np.concatenate(self._times), np.concatenate(self._volts))


def _greatest(piece: Floats) -> Floats:
    greatest: Floats = np.where(np.isnan(piece), -np.inf, piece).max(axis=0)
    return greatest
