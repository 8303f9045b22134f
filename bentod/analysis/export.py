"""A recording in another format: a folder with its tables and the dictionary of their columns."""

import csv
import json
import shutil
import tempfile
from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TextIO, TypeAlias, cast

from bentod.analysis.columns import Cells, Column
from bentod.analysis.extras import load_extra
from bentod.analysis.stream import TABLES, Sink, pour
from bentod.analysis.table import Gather
from bentod.errors import BadRequest, Refused, nearest
from bentod.record.reader import Recording
from bentod.record.session import Header

Write: TypeAlias = Callable[[Recording, Path, Collection[str]], Mapping[str, int]]
"""Writes some tables of a recording to a folder, which it makes; returns rows, or messages, by table."""

DICTIONARY = "dictionary.json"


def export(recording: Recording, kind: str, out: Path, tables: Sequence[str] = TABLES) -> Mapping[str, int]:
    """Write `tables` of `recording` as `kind` (one of FORMATS) to the folder `out`; returns rows by table.

    The folder appears when it is complete, or not at all.

    Raises:
        BadRequest: there is no such format or table.
        Refused: `out` exists already.
        MissingExtra: what the format needs is not installed.
        BentodError: the recording cannot be read.
        OSError: the folder cannot be written.
    """
    for table in tables:
        if table not in TABLES:
            raise BadRequest(f"there is no topic '{table}'{nearest(table, TABLES)}", "topics")
    if kind not in FORMATS:
        raise BadRequest(f"there is no format '{kind}'{nearest(kind, FORMATS)}", "format")
    if out.exists():
        raise Refused(f"{out} exists already; remove it, or choose another place with -o")
    write = FORMATS[kind]
    resolved = cast("Write", load_extra(write)) if isinstance(write, str) else write
    with tempfile.TemporaryDirectory(dir=out.parent, prefix=f".{out.name}.") as unfinished:
        folder = Path(unfinished) / out.name
        rows = resolved(recording, folder, tables)
        shutil.move(folder, out)
    return rows


class Documented:
    """A sink in front of another, which writes down what the tables mean."""

    def __init__(self, sink: Sink, header: Header) -> None:
        self._sink = sink
        self._about = about(header)
        self._columns: dict[str, Sequence[Column]] = {}

    def begin(self, table: str, columns: Sequence[Column]) -> None:
        """A table begins."""
        self._columns[table] = columns
        self._sink.begin(table, columns)

    def write(self, table: str, cells: Sequence[Cells]) -> None:
        """Some more rows."""
        self._sink.write(table, cells)

    def save(self, folder: Path, rows: Mapping[str, int]) -> None:
        """Put the dictionary into `folder`."""
        tables = {
            table: {"rows": rows[table], "columns": [asdict(column) for column in columns]}
            for table, columns in self._columns.items()
        }
        save_dictionary(folder, {**self._about, "tables": tables})


def save_dictionary(folder: Path, content: Mapping[str, object]) -> None:
    """Write the data dictionary of an export."""
    text = json.dumps(content, indent=1, ensure_ascii=False) + "\n"
    (folder / DICTIONARY).write_text(text, encoding="utf-8")


def about(header: Header) -> dict[str, object]:
    """What every table of a session has in common, for the data dictionary."""
    return {
        "session": header.session,
        "arm": header.arm,
        "schema": header.schema,
        "rate_hz": header.rate_hz,
        "started_s": header.started,
        "started_wall_s": header.started_wall,
        "times": "Times are monotonic seconds; the session started at started_s, which was the wall time "
        "started_wall_s (seconds since 1970-01-01 UTC).",
        "versions": dict(header.versions),
        "config_name": header.config_name,
    }


def pour_into(sink: Sink, recording: Recording, folder: Path, tables: Collection[str]) -> Mapping[str, int]:
    """Pour a recording into a format's sink, and write the dictionary beside it."""
    documented = Documented(sink, recording.header)
    rows = pour(recording, documented, tables)
    documented.save(folder, rows)
    return rows


@dataclass(slots=True)
class _CsvFolder:
    """One CSV file a table; empty: nothing there, `nan`: a number that is not one."""

    folder: Path
    stack: ExitStack
    files: dict[str, TextIO] = field(default_factory=dict)
    formats: dict[str, str] = field(default_factory=dict)

    def begin(self, table: str, columns: Sequence[Column]) -> None:
        file = (self.folder / f"{table}.csv").open("w", newline="", encoding="utf-8")
        self.files[table] = self.stack.enter_context(file)
        csv.writer(self.files[table], lineterminator="\n").writerow([column.name for column in columns])
        if table == "emg":  # 9 digits tell every float32 from every other
            cells = [{"float32": "%.9g", "float": "%r"}.get(column.kind, "%s") for column in columns]
            self.formats[table] = ",".join(cells) + "\n"

    def write(self, table: str, cells: Sequence[Cells]) -> None:
        rows = zip(*(_listed(column) for column in cells), strict=True)
        if table in self.formats:
            self.files[table].writelines(map(self.formats[table].__mod__, rows))
        else:
            csv.writer(self.files[table], lineterminator="\n").writerows(rows)


def _listed(cells: Cells) -> Sequence[object]:
    return cells if isinstance(cells, Sequence) else cast("list[object]", cells.tolist())


def write_csv(recording: Recording, folder: Path, tables: Collection[str]) -> Mapping[str, int]:
    """One CSV file a table."""
    folder.mkdir()
    with ExitStack() as stack:
        return pour_into(_CsvFolder(folder, stack), recording, folder, tables)


def write_npz(recording: Recording, folder: Path, tables: Collection[str]) -> Mapping[str, int]:
    """One .npz file a table, one array a column. Nothing there: NaN, −1 or an empty text."""
    folder.mkdir()
    gather = Gather()
    rows = pour_into(gather, recording, folder, tables)
    for name, table in gather.tables.items():
        table.save(folder / f"{name}.npz")
    return rows


FORMATS: Mapping[str, Write | str] = {
    "parquet": "bentod.analysis.parquet:write_parquet",
    "csv": write_csv,
    "npz": write_npz,
    "rosbag2": "bentod.analysis.rosbag:write_rosbag",
}
"""What writes each format; a name, where it needs what only the extra `analysis` brings."""
