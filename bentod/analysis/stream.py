"""One pass over a recording, in batches of columns: what every export and every figure is made from."""

from collections.abc import Callable, Collection, Sequence
from typing import Protocol, cast

import numpy as np

from bentod.analysis.columns import (
    COMMANDS,
    EVENTS,
    Cell,
    Cells,
    Column,
    TickColumns,
    command_row,
    event_row,
)
from bentod.analysis.setup import Setup, setup
from bentod.errors import RecordingError
from bentod.frames import ClientCommand, EmgBlock, Event, Frame
from bentod.record.reader import Recording

TABLES = ("ticks", "emg", "events", "commands")

BATCH = 2048
"""Ticks held at once."""

EMG_BATCH = 1 << 16
"""EMG samples held at once."""


class UnfitRecording(RecordingError):
    """The recording does not hold what was asked of it.

    Examples: the metrics of trials when there was no trial, a figure of EMG when there was no EMG.
    """


class Sink(Protocol):
    """Where tables go: a file format, or memory."""

    def begin(self, table: str, columns: Sequence[Column]) -> None:
        """A table begins; called once for each table, before its cells."""
        ...

    def write(self, table: str, cells: Sequence[Cells]) -> None:
        """Some more rows of a table, as one sequence a column."""
        ...


def pour(
    recording: Recording,
    sink: Sink,
    tables: Collection[str] = TABLES,
    start: float | None = None,
    end: float | None = None,
) -> dict[str, int]:
    """Put every entry from `start` to `end` (monotonic s; None: all) into `sink`; returns rows by table.

    A table of which there is no entry begins nevertheless, and has no rows.

    Raises:
        BentodError: the recording cannot be read, or its EMG changes its number of channels.
    """
    batches = _batches(recording, sink, tables)
    kinds = {batch.kind: batch for batch in batches.values()}
    for entry in recording.entries(start, end, kinds=tuple(kinds)):
        kinds[type(entry)].add(entry)
    for batch in batches.values():
        batch.flush()
    return {table: batch.rows for table, batch in batches.items()}


def _batches(recording: Recording, sink: Sink, tables: Collection[str]) -> "dict[str, _Batch]":
    joints = [spec.name for spec in recording.header.joints]
    made: dict[str, _Batch] = {
        "ticks": _Ticks(sink, joints),
        "emg": _Emg(sink, setup(recording.header.config)),
        "events": _Rows(sink, "events", Event, EVENTS, event_row),
        "commands": _Rows(sink, "commands", ClientCommand, COMMANDS, command_row),
    }
    return {table: batch for table, batch in made.items() if table in tables}


class _Batch(Protocol):
    kind: type
    rows: int

    def add(self, entry: object) -> None: ...

    def flush(self) -> None: ...


class _Ticks:
    kind: type = Frame

    def __init__(self, sink: Sink, joints: Sequence[str]) -> None:
        self.rows = 0
        self._sink = sink
        self._joints = joints
        self._frames: list[Frame] = []
        self._columns: TickColumns | None = None

    def add(self, entry: object) -> None:
        self._frames.append(cast("Frame", entry))
        if len(self._frames) == BATCH:
            self.flush()

    def flush(self) -> None:
        frames, self._frames = self._frames, []
        if self._columns is None:  # fitted to the first batch, which names every source and timescale
            self._columns = TickColumns(self._joints, frames)
            self._sink.begin("ticks", self._columns.columns)
        if frames:
            self.rows += len(frames)
            self._sink.write("ticks", self._columns.cells(frames))


class _Rows:
    """Entries that become one row each."""

    def __init__(
        self,
        sink: Sink,
        table: str,
        kind: type,
        columns: Sequence[Column],
        row: Callable[..., tuple[Cell, ...]],
    ) -> None:
        self.kind = kind
        self.rows = 0
        self._sink, self._table, self._row = sink, table, row
        self._columns: Sequence[Column] | None = columns  # None: the table has begun
        self._waiting: list[tuple[Cell, ...]] = []

    def add(self, entry: object) -> None:
        self._waiting.append(self._row(entry))
        if len(self._waiting) == BATCH:
            self.flush()

    def flush(self) -> None:
        waiting, self._waiting = self._waiting, []
        if self._columns is not None:
            self._sink.begin(self._table, self._columns)
            self._columns = None
        if waiting:
            self.rows += len(waiting)
            self._sink.write(self._table, list(zip(*waiting, strict=True)))


class _Emg:
    kind: type = EmgBlock

    def __init__(self, sink: Sink, known: Setup) -> None:
        self.rows = 0
        self._sink = sink
        self._setup = known
        self._blocks: list[EmgBlock] = []
        self._held = 0
        self._channels: int | None = None

    def add(self, entry: object) -> None:
        block = cast("EmgBlock", entry)
        self._blocks.append(block)
        self._held += len(block.samples)
        if self._held >= EMG_BATCH:
            self.flush()

    def flush(self) -> None:
        blocks, self._blocks, self._held = self._blocks, [], 0
        if self._channels is None:
            self._channels = blocks[0].samples.shape[1] if blocks else 0
            self._sink.begin("emg", emg_columns(self._channels, self._setup))
        for block in blocks:
            if block.samples.shape[1] != self._channels:
                raise UnfitRecording(
                    f"EMG sample {block.first_index} has {block.samples.shape[1]} channels, "
                    f"those before it have {self._channels}; one table cannot hold both."
                )
        if blocks:
            cells = emg_cells(blocks, self._setup.emg_rate_hz)
            self.rows += len(cells[0])
            self._sink.write("emg", cells)


def emg_columns(channels: int, known: Setup) -> tuple[Column, ...]:
    """Index, time, what was lost, and one column a channel."""
    sites = {site.channel: f", site {site.name}" for site in known.sites}
    return (
        Column("index", "int", "", "number of the sample since the source was opened, gaps included"),
        Column(
            "time_s",
            "float",
            "s",
            "monotonic time: as recorded where `block` is true, from there on counted by "
            f"{known.emg_rate_hz:g} samples a second",
        ),
        Column("block", "bool", "", "whether a block begins with this sample, and so has a time of its own"),
        Column("dropped", "int", "", "samples known to be lost just before this one"),
        *(
            Column(f"channel_{number}_v", "float32", "V", f"channel {number}{sites.get(number, '')}")
            for number in range(channels)
        ),
    )


def emg_cells(blocks: Sequence[EmgBlock], rate_hz: float) -> list[Cells]:
    """The samples of `blocks` as the cells of `emg_columns`."""
    lengths = np.array([len(block.samples) for block in blocks])
    starts = np.cumsum(lengths) - lengths
    within = np.arange(int(lengths.sum())) - np.repeat(starts, lengths)
    first = np.repeat(np.array([block.first_index for block in blocks]), lengths)
    time = np.repeat(np.array([block.time for block in blocks]), lengths)
    if rate_hz:
        time = time + within / rate_hz
    else:
        time[within > 0] = np.nan
    dropped = np.where(within == 0, np.repeat([block.dropped for block in blocks], lengths), 0)
    samples = np.concatenate([block.samples for block in blocks])
    return [first + within, time, within == 0, dropped, *samples.T]
