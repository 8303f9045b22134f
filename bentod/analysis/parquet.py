"""Tables as Parquet, with units and meanings in the files themselves. Needs pyarrow."""

import gc
import json
import os
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import ExitStack
from dataclasses import dataclass
from itertools import islice
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from bentod.analysis.columns import Cells, Column, TickColumns
from bentod.analysis.export import Documented, about
from bentod.analysis.stream import BATCH, pour
from bentod.frames import Frame
from bentod.record.reader import Recording
from bentod.record.session import Header

SLICE_S = 150.0
"""A longer recording is read in slices of so many seconds, by as many processes as there are processors."""

PROCESSES = 4
"""At most."""

_TYPES = {
    "float": pa.float64(),
    "float32": pa.float32(),
    "int": pa.int64(),
    "bool": pa.bool_(),
    "text": pa.string(),
}


class _Folder:
    """One file a table; nothing there is null, a number that is not one is NaN."""

    def __init__(self, folder: Path, header: Header, stack: ExitStack) -> None:
        self._folder = folder
        self._metadata = {"bentod": json.dumps(about(header), ensure_ascii=False)}
        self._stack = stack
        self._writers: dict[str, pq.ParquetWriter] = {}

    def begin(self, table: str, columns: Sequence[Column]) -> None:
        schema = _schema(columns).with_metadata(self._metadata)
        texts = [column.name for column in columns if column.kind == "text"]
        writer = pq.ParquetWriter(
            self._folder / f"{table}.parquet",
            schema,
            compression="zstd",
            compression_level=1,
            use_dictionary=texts,
            write_statistics=["time_s"],
        )
        self._writers[table] = self._stack.enter_context(writer)

    def write(self, table: str, cells: Sequence[Cells]) -> None:
        writer = self._writers[table]
        writer.write_batch(_batch(cells, writer.schema))

    def write_ticks(self, arrow: bytes) -> int:
        """Add what `read_slice` made; returns how many ticks that were."""
        table = pa.ipc.open_stream(arrow).read_all()
        if table.num_rows:
            self._writers["ticks"].write_table(table)
        return int(table.num_rows)


def write_parquet(recording: Recording, folder: Path, tables: Collection[str]) -> Mapping[str, int]:
    """One Parquet file a table. Ticks are read by processes of their own, while this one sees to the rest."""
    folder.mkdir()
    with ExitStack() as stack:
        sink = _Folder(folder, recording.header, stack)
        documented = Documented(sink, recording.header)
        slices = stack.enter_context(_Slices(recording)) if "ticks" in tables else None
        rows = pour(recording, documented, [table for table in tables if table != "ticks"])
        if slices:
            documented.begin("ticks", slices.columns)
            rows["ticks"] = sum(map(sink.write_ticks, slices))
        documented.save(folder, rows)
    return rows


@dataclass(frozen=True, slots=True)
class Slice:
    """A stretch of a recording, from `start` up to, without, `end` (monotonic s; None: no bound)."""

    file: Path
    columns: TickColumns
    start: float | None
    end: float | None


def read_slice(wanted: Slice) -> bytes:
    """The ticks of a stretch in Arrow's stream format."""
    schema = _schema(wanted.columns.columns)
    buffer = pa.BufferOutputStream()
    with Recording(wanted.file) as recording, pa.ipc.new_stream(buffer, schema) as stream:
        for frames in _batches(recording.frames(wanted.start, wanted.end)):
            stream.write_batch(_batch(wanted.columns.cells(frames), schema))
    return bytes(buffer.getvalue())


class _Slices:
    """The ticks of a recording, read in slices; in processes of their own, if there are several slices."""

    def __init__(self, recording: Recording) -> None:
        examples = list(islice(recording.frames(), BATCH))
        fitted = TickColumns([spec.name for spec in recording.header.joints], examples)
        self.columns = fitted.columns
        info = recording.info
        count = max(1, int(info.duration / SLICE_S)) if info.counts.total else 1
        inner = [float(at) for at in np.linspace(info.start, info.end, count + 1)[1:-1]]
        bounds = zip([None, *inner], [*inner, None], strict=True)
        self._slices = [Slice(recording.files[0], fitted, start, end) for start, end in bounds]
        self._pool: ProcessPoolExecutor | None = None
        self._found: Iterable[bytes] = ()

    def __enter__(self) -> "_Slices":
        if len(self._slices) == 1:
            self._found = map(read_slice, self._slices)
        else:  # what a worker makes is soon gone, so that it needs no search for cycles
            workers = min(os.cpu_count() or 1, PROCESSES)
            self._pool = ProcessPoolExecutor(workers, get_context("spawn"), initializer=gc.disable)
            self._found = self._pool.map(read_slice, self._slices)
        return self

    def __exit__(self, *_: object) -> None:
        if self._pool:
            self._pool.shutdown(cancel_futures=True)

    def __iter__(self) -> Iterator[bytes]:
        return iter(self._found)


def _batches(frames: Iterator[Frame]) -> Iterator[list[Frame]]:
    while batch := list(islice(frames, BATCH)):
        yield batch


def _batch(cells: Sequence[Cells], schema: pa.Schema) -> pa.RecordBatch:
    arrays = [pa.array(values, type=column.type) for values, column in zip(cells, schema, strict=True)]
    return pa.record_batch(arrays, schema=schema)


def _schema(columns: Sequence[Column]) -> pa.Schema:
    return pa.schema([_field(column) for column in columns])


def _field(column: Column) -> pa.Field:
    return pa.field(
        column.name, _TYPES[column.kind], metadata={"unit": column.unit, "meaning": column.meaning}
    )
