"""Recordings of muscle signals: .npz and .csv files, read whole and checked before they are played."""

import struct
import zipfile
import zlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from bentod.errors import InputFileError
from bentod.frames import Samples

VOLTS_PER_COUNT = 1e-6
"""Scale of integers without one of their own. Armband counts have no known scale; one microvolt makes
the Myo's strongest contractions, some 60 counts, as large as those of surface electrodes."""

MOST_CHANNELS = 256
"""More columns than this are taken for samples that lie along the wrong axis."""

RATES_HZ = (1.0, 100_000.0)
"""Bounds of a recording's sampling rate."""

TIME_NAMES = frozenset({"t", "time", "time_s", "time (s)", "timestamp", "seconds"})
"""Headings of a column that holds seconds; capitals do not matter."""

_UNREADABLE = (OSError, EOFError, ValueError, RuntimeError, zipfile.BadZipFile, zlib.error, struct.error)
"""What NumPy and zipfile raise for damaged, encrypted or pickled content."""

_Table = tuple[NDArray[np.generic], float | None]


@dataclass(frozen=True, slots=True)
class Recording:
    """A recording in memory."""

    samples: Samples  # V, shape (samples, channels), finite
    rate_hz: float | None  # as the file states it; None when it does not


def load(path: Path, array: str | None, volts_per_unit: float | None) -> Recording:
    """Read the recording in `path`.

    `array` is the name of the array in an .npz file; by default "emg", else its only 2-D array.
    `volts_per_unit` is the volts that 1 in the file stands for; by default 1e-6 for whole numbers
    (counts of an armband) and 1.0 for others.

    Raises:
        InputFileError: the file cannot be read, or holds no finite samples of 1 to 256 channels.
    """
    values, rate_hz = _read(path, array)
    if values.ndim != 2 or values.dtype.kind not in "iuf":
        raise InputFileError(f"{path}: the samples are {_describe(values)}, not a 2-D array of numbers.")
    rows, channels = values.shape
    if rows < 1 or not 1 <= channels <= MOST_CHANNELS:
        raise InputFileError(
            f"{path}: shape {values.shape}; it needs rows, one a sample, of 1 to {MOST_CHANNELS} channels."
        )
    return Recording(_volts(path, values, volts_per_unit), _checked_rate(path, rate_hz))


def _read(path: Path, array: str | None) -> _Table:
    readers = {".npz": lambda: _read_npz(path, array), ".csv": lambda: _read_csv(path)}
    reader = readers.get(path.suffix.lower())
    if reader is None:
        raise InputFileError(f"{path}: a recording ends in .npz or .csv.")
    try:
        return reader()
    except FileNotFoundError:
        raise InputFileError(f"{path}: there is no such file.") from None
    except _UNREADABLE as error:
        raise InputFileError(f"{path}: cannot be read: {error}.") from error


def _read_npz(path: Path, array: str | None) -> _Table:
    with zipfile.ZipFile(path):  # anything else would be taken for a pickle or a single array
        pass
    with np.load(path, allow_pickle=False) as file:
        members = {name: file[name] for name in file.files}
    arrays = {name: values for name, values in members.items() if isinstance(values, np.ndarray)}
    name = _choose(path, arrays, array)
    rate = arrays.get("fs")
    if rate is None:
        return arrays[name], None
    if rate.size != 1 or rate.dtype.kind not in "iuf":
        raise InputFileError(f"{path}: the array 'fs' is {_describe(rate)}, not one number in Hz.")
    return arrays[name], float(rate.item())


def _choose(path: Path, arrays: dict[str, NDArray[np.generic]], wanted: str | None) -> str:
    """The name of the array of samples."""
    flat = [name for name, values in arrays.items() if values.ndim == 2]
    candidates = [wanted or "emg", *(flat if wanted is None and len(flat) == 1 else [])]
    for name in candidates:
        if name in arrays:
            return name
    listed = ", ".join(f"{name!r} ({_describe(values)})" for name, values in arrays.items()) or "none"
    problem = f"no array {wanted!r}" if wanted else "neither an array 'emg' nor just one 2-D array"
    raise InputFileError(f"{path}: {problem}; the arrays are: {listed}.")


def _describe(values: NDArray[np.generic]) -> str:
    return f"{values.dtype} of shape {values.shape}"


def _read_csv(path: Path) -> _Table:
    lines = [line for line in path.read_text(encoding="utf-8-sig").splitlines() if line.strip()]
    heading = [cell.strip().strip('"').lower() for cell in lines[0].split(",")] if lines else []
    if all(_is_number(cell) for cell in heading):
        heading = []
    rows = lines[1:] if heading else lines
    if not rows:
        raise InputFileError(f"{path}: there are no samples in it.")
    values = np.loadtxt(rows, delimiter=",", comments=None, ndmin=2, dtype=np.float64)
    clocks = [column for column, cell in enumerate(heading) if cell in TIME_NAMES]
    if not clocks:
        return _whole(values), None
    times = values[:, clocks[0]]
    return _whole(np.delete(values, clocks[0], axis=1)), _mean_rate(path, times)


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _whole(values: NDArray[np.float64]) -> NDArray[np.generic]:
    """`values` as integers when all are whole, since text does not say what it was written from."""
    if np.all(np.isfinite(values)) and np.all(values == np.rint(values)) and np.all(np.abs(values) < 2**53):
        return values.astype(np.int64)
    return values


def _mean_rate(path: Path, times: NDArray[np.float64]) -> float:
    """Hz over the whole recording; stamps of single samples are seldom better than the block they came in."""
    steps = np.diff(times)
    falls = np.flatnonzero(~(steps >= 0))
    if falls.size:
        raise InputFileError(f"{path}: the time column does not rise after row {falls[0]}.")
    if times.size < 2 or not times[-1] - times[0] > 0:
        raise InputFileError(f"{path}: the time column spans no time, so it gives no rate.")
    return float((times.size - 1) / (times[-1] - times[0]))


def _checked_rate(path: Path, rate_hz: float | None) -> float | None:
    low, high = RATES_HZ
    if rate_hz is not None and not low <= rate_hz <= high:
        raise InputFileError(f"{path}: its rate is {rate_hz:g} Hz; it must be from {low:g} to {high:g} Hz.")
    return rate_hz


def _volts(path: Path, values: NDArray[np.generic], volts_per_unit: float | None) -> Samples:
    default = 1.0 if values.dtype.kind == "f" else VOLTS_PER_COUNT
    scale = default if volts_per_unit is None else volts_per_unit
    with np.errstate(over="ignore"):
        volts = (values.astype(np.float64) * scale).astype(np.float32)
    bad = np.argwhere(~np.isfinite(volts))
    if bad.size:
        row, channel = bad[0]
        raise InputFileError(f"{path}: row {row}, channel {channel} is not a finite number of volts.")
    return volts
