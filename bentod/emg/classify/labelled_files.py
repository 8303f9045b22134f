"""Labelled recordings in .npz and .csv files; docs/muscles.md says what stands in them."""

import csv
import struct
import zipfile
import zlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from bentod.emg.classify.labelled import Names, Piece, Recorded, counted
from bentod.errors import InputFileError

VOLTS_PER_COUNT = 1e-6
"""Of whole numbers, if nobody says what they stand for: as the source `replay` takes them."""

RATES_HZ = (50.0, 10_000.0)

_TEXT = {"label", "repetition", "condition"}
"""Columns of a .csv file that are no channels."""

_UNREADABLE = (
    OSError,
    EOFError,
    ValueError,
    RuntimeError,
    zipfile.BadZipFile,
    zlib.error,
    struct.error,
    csv.Error,
)

_Arrays: TypeAlias = Mapping[str, NDArray[np.generic]]


def read(path: Path, rate_hz: float | None = None, volts_per_unit: float | None = None) -> Recorded:
    """The labelled recording in `path`.

    `rate_hz` is for files that do not state it. `volts_per_unit` is the volts that 1 in the file stands for;
    by default 1e-6 for whole numbers and 1.0 for others.

    Raises:
        InputFileError: it cannot be read, has no labels, or its arrays do not go together.
    """
    readers = {".npz": _npz, ".csv": _csv}
    reader = readers.get(path.suffix.lower())
    if reader is None:
        raise InputFileError(f"{path}: a labelled recording ends in .npz or .csv.")
    try:
        return _recorded(reader(path), rate_hz, volts_per_unit)
    except InputFileError as error:
        raise InputFileError(f"{path}: {error}") from error
    except FileNotFoundError:
        raise InputFileError(f"{path}: there is no such file.") from None
    except _UNREADABLE as error:
        raise InputFileError(f"{path}: cannot be read: {error}.") from error


def write(path: Path, recorded: Recorded) -> None:
    """Keep a labelled recording as .npz, in volts, so that `read` has it back.

    Raises:
        OSError: the disk does not take it.
    """
    pieces = recorded.pieces
    arrays: dict[str, NDArray[np.generic]] = {
        "emg": np.concatenate([piece.samples for piece in pieces]),
        "fs": np.array(recorded.rate_hz),
        "length": np.array([len(piece.samples) for piece in pieces]),
        "labels": np.concatenate([piece.labels for piece in pieces]),
        "rep": np.concatenate([piece.repetitions for piece in pieces]),
        "condition": np.concatenate([piece.conditions for piece in pieces]),
    }
    np.savez(path, allow_pickle=False, **arrays)


def _npz(path: Path) -> _Arrays:
    with zipfile.ZipFile(path):  # anything else would be taken for a pickle or a single array
        pass
    with np.load(path, allow_pickle=False) as file:
        return {name: file[name] for name in file.files}


def _csv(path: Path) -> _Arrays:
    with path.open(encoding="utf-8-sig", newline="") as file:
        rows = [row for row in csv.reader(file) if row]
    heading = [cell.strip().lower() for cell in rows[0]] if rows else []
    if "label" not in heading:
        raise InputFileError("its first line must name the columns, one of them 'label'.")
    if any(len(row) != len(heading) for row in rows):
        raise InputFileError(f"its lines must all have {len(heading)} cells, as the first one has.")
    columns = dict(zip(heading, zip(*rows[1:], strict=True), strict=False)) if rows[1:] else {}
    channels = [name for name in heading if name not in _TEXT | {"time"}]
    volts = _whole(np.array([[float(cell) for cell in columns.get(name, ())] for name in channels]).T)
    found: dict[str, NDArray[np.generic]] = {
        "emg": volts,
        "labels": np.array(columns.get("label", ()), np.str_),
    }
    if "repetition" in columns:
        found["rep"] = np.array([int(cell) for cell in columns["repetition"]])
    if "condition" in columns:
        found["condition"] = np.array(columns["condition"], np.str_)
    if "time" in columns and len(rows) > 2:
        times = np.array([float(cell) for cell in columns["time"]])
        found["fs"] = np.array((len(times) - 1) / (times[-1] - times[0]))
    return found


def _whole(values: NDArray[np.float64]) -> NDArray[np.generic]:
    """`values` as integers when all are whole, since text does not say what it was written from."""
    if np.isfinite(values).all() and (values == np.rint(values)).all() and (np.abs(values) < 2**53).all():
        return values.astype(np.int64)
    return values


def _recorded(arrays: _Arrays, rate_hz: float | None, volts_per_unit: float | None) -> Recorded:
    if "emg" not in arrays or arrays["emg"].ndim != 2 or arrays["emg"].dtype.kind not in "iuf":
        raise InputFileError("it needs 'emg', numbers of shape (samples, channels).")
    raw = arrays["emg"]
    if not raw.size:
        raise InputFileError(f"its samples are of shape {raw.shape}: there is nothing in it.")
    default = 1.0 if raw.dtype.kind == "f" else VOLTS_PER_COUNT
    volts = raw.astype(np.float64) * (default if volts_per_unit is None else volts_per_unit)
    lengths = _lengths(arrays, len(raw))
    labels = _each(arrays, ("labels", "label", "cls"), lengths)
    if labels is None:
        raise InputFileError("it needs 'labels' or 'cls', one for each sample or each entry of 'length'.")
    named = _names(labels, arrays.get("names"))
    numbers = _each(arrays, ("repetitions", "rep"), lengths)
    repetitions = counted(named) if numbers is None else numbers.astype(np.int64)
    conditions = _each(arrays, ("conditions", "condition"), lengths)
    told = np.full(len(raw), "") if conditions is None else conditions.astype(np.str_)
    edges = np.cumsum(lengths)[:-1]
    parts = (np.split(values, edges) for values in (volts, named, repetitions, told))
    pieces = (Piece(*part) for part in zip(*parts, strict=True))
    return Recorded(_rate(arrays, rate_hz), tuple(piece for piece in pieces if len(piece.samples)))


def _lengths(arrays: _Arrays, samples: int) -> NDArray[np.int64]:
    """Samples of each of the recordings that stand one after the other."""
    lengths = arrays["length"].astype(np.int64) if "length" in arrays else np.array([samples])
    if lengths.ndim != 1 or (lengths < 0).any() or lengths.sum() != samples:
        raise InputFileError(f"'length' adds up to {lengths.sum()} samples; there are {samples}.")
    return lengths


def _each(arrays: _Arrays, names: Sequence[str], lengths: NDArray[np.int64]) -> NDArray[np.generic] | None:
    """The first array of these names, one entry a sample; None if there is none."""
    name = next((name for name in names if name in arrays), None)
    if name is None:
        return None
    values, samples = arrays[name], int(lengths.sum())
    if values.shape == (len(lengths),) != (samples,):
        return np.repeat(values, lengths)
    if values.shape != (samples,):
        raise InputFileError(f"'{name}' is of shape {values.shape}; it needs one entry for each sample.")
    return values


def _names(labels: NDArray[np.generic], names: NDArray[np.generic] | None) -> Names:
    """Labels as words; numbers count from 0 in `names`, and below 0 nothing is known."""
    if labels.dtype.kind == "U":
        return labels.astype(np.str_)
    if labels.dtype.kind not in "iu":
        raise InputFileError(f"its labels are {labels.dtype}; they must be words or whole numbers.")
    places = labels.astype(np.int64)
    if names is None:
        words = np.array([f"class_{place}" for place in range(int(places.max(initial=0)) + 1)])
    else:
        words = names.astype(np.str_)
    if places.max(initial=0) >= len(words):
        raise InputFileError(f"label {places.max()} has no name: 'names' has {len(words)}.")
    return np.where(places < 0, "", words[np.maximum(places, 0)])


def _rate(arrays: _Arrays, wanted: float | None) -> float:
    stated = next((arrays[name] for name in ("fs", "rate_hz") if name in arrays), None)
    if stated is None and wanted is None:
        raise InputFileError("it does not state its rate as 'fs' (Hz); say it.")
    rate = float(wanted) if stated is None and wanted is not None else float(np.asarray(stated).reshape(()))
    low, high = RATES_HZ
    if not low <= rate <= high:
        raise InputFileError(f"its rate is {rate:g} Hz; it must be from {low:g} to {high:g} Hz.")
    if wanted is not None and abs(rate - wanted) > 0.01 * rate:
        raise InputFileError(f"it states {rate:g} Hz, not {wanted:g} Hz.")
    return rate
