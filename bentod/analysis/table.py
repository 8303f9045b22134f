"""A table of a recording in memory, as numpy columns."""

import zipfile
from collections.abc import Callable, Collection, Sequence
from pathlib import Path
from typing import IO

import numpy as np
from numpy.typing import NDArray

from bentod.analysis.columns import Cells, Column
from bentod.analysis.stream import TABLES, pour
from bentod.record.reader import Recording

Floats = NDArray[np.float64]
Texts = NDArray[np.str_]
Numeric = NDArray[np.generic]

NONE = -1
"""What stands for a whole number that is not there."""

PIECE = 1 << 14
"""Rows written at once."""

DTYPES = {"float": np.float64, "float32": np.float32, "int": np.int64, "bool": np.bool_}


class Table:
    """Columns by name. Texts are kept once each, so that a long recording fits into memory."""

    def __init__(self, columns: Sequence[Column]) -> None:
        self.columns = tuple(columns)
        self.length = 0
        self._parts: dict[str, list[Numeric]] = {column.name: [] for column in columns}
        self._codes: dict[str, dict[str, int]] = {c.name: {} for c in columns if c.kind == "text"}

    def append(self, cells: Sequence[Cells]) -> None:
        """More rows: one sequence a column."""
        for column, values in zip(self.columns, cells, strict=True):
            self._parts[column.name].append(self._array(column, values))
        self.length += len(cells[0])

    def _array(self, column: Column, values: Cells) -> Numeric:
        if column.kind == "text":
            codes = self._codes[column.name]
            found = [codes.setdefault("" if v is None else str(v), len(codes)) for v in values]
            return np.array(found, dtype=np.int32)
        if column.kind in ("int", "bool") and not isinstance(values, np.ndarray):
            values = [NONE if value is None else value for value in values]
        return np.asarray(values, dtype=DTYPES[column.kind])

    def array(self, name: str) -> Numeric:
        """A column; texts as fixed-width strings. Missing: NaN, −1, empty."""
        if name in self._codes:
            return self.texts(name)
        return self._joined(name, DTYPES[self._kind(name)])

    def floats(self, name: str) -> Floats:
        """A column of numbers or flags, as float64; NaN where there is none."""
        return self.array(name).astype(np.float64, copy=False)

    def texts(self, name: str) -> Texts:
        """A column of texts, shape (rows,)."""
        codes, labels = self.coded(name)
        return np.array(labels or [""])[codes]

    def coded(self, name: str) -> tuple[NDArray[np.int32], list[str]]:
        """A column of texts as numbers, and the text of each number."""
        joined = self._joined(name, np.int32)
        return joined.astype(np.int32, copy=False), list(self._codes[name])

    def has(self, name: str) -> bool:
        """Whether there is such a column."""
        return name in self._parts

    def save(self, path: Path) -> None:
        """Write an .npz file, one array a column, compressed; `numpy.load` reads it."""
        with zipfile.ZipFile(path, "w") as archive:
            for column in self.columns:
                entry = zipfile.ZipInfo(f"{column.name}.npy")  # without the time of writing
                entry.compress_type = zipfile.ZIP_DEFLATED
                with archive.open(entry, "w", force_zip64=True) as file:
                    self._save(file, column)

    def _save(self, file: IO[bytes], column: Column) -> None:
        """A piece at a time: texts take many times the room in their file's form."""
        labels = np.array(self.coded(column.name)[1] or [""]) if column.kind == "text" else None
        values = self._joined(column.name, np.int32 if labels is not None else DTYPES[column.kind])
        dtype = values.dtype if labels is None else labels.dtype
        header = {"descr": dtype.str, "fortran_order": False, "shape": (len(values),)}
        np.lib.format.write_array_header_1_0(file, header)
        for start in range(0, len(values), PIECE):
            piece = values[start : start + PIECE]
            file.write((piece if labels is None else labels[piece]).tobytes())

    def _kind(self, name: str) -> str:
        return next(column.kind for column in self.columns if column.name == name)

    def _joined(self, name: str, dtype: type[np.generic]) -> Numeric:
        parts = self._parts[name]
        if len(parts) != 1:
            self._parts[name] = [np.concatenate(parts) if parts else np.empty(0, dtype)]
        return self._parts[name][0]


class Gather:
    """A sink that keeps the columns that are wanted."""

    def __init__(self, wanted: Callable[[str], bool] = lambda name: True) -> None:
        self.tables: dict[str, Table] = {}
        self._wanted = wanted
        self._kept: dict[str, list[int]] = {}

    def begin(self, table: str, columns: Sequence[Column]) -> None:
        """A table begins."""
        self._kept[table] = [at for at, column in enumerate(columns) if self._wanted(column.name)]
        self.tables[table] = Table([columns[at] for at in self._kept[table]])

    def write(self, table: str, cells: Sequence[Cells]) -> None:
        """Some more rows."""
        self.tables[table].append([cells[at] for at in self._kept[table]])


def load(
    recording: Recording,
    tables: Collection[str] = TABLES,
    start: float | None = None,
    end: float | None = None,
    wanted: Callable[[str], bool] = lambda name: True,
) -> dict[str, Table]:
    """Tables of a recording from `start` to `end` (monotonic s), of their columns those that are wanted.

    Raises:
        BentodError: as `pour`.
    """
    gather = Gather(wanted)
    pour(recording, gather, tables, start, end)
    return gather.tables
