"""Labelled recordings that a user has, as windows by condition: files, and folders of known data sets."""

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from bentod.config_conditioning import Filter
from bentod.emg.classify.labelled import Piece, Recorded, windows_of
from bentod.emg.classify.labelled_files import read
from bentod.emg.segmenting import segmenting
from bentod.errors import InputFileError
from drivers.emg.recording import load
from sim.studies.patterns import Labelled

WINDOW_S, STEP_S = 0.15, 0.05

UNNAMED = "all"
"""The condition of a recording that names none."""

HIGH_PASS = (Filter(kind="high_pass", hz=20.0),)

INTENSITY = re.compile(r"(?:^|_)(?P<condition>[^_]+)_C(?P<label>\d+)_R(?P<repetition>\d+)$")
"""How the names of LibEMG's ContractionIntensity end: the effort, the class, the repetition."""

INTENSITY_HZ = 1000.0


def conditions(path: Path) -> dict[str, Labelled]:
    """The recording's windows by condition, such as what was held.

    A file is what `bentod emg train` takes. A folder has .csv files without labels whose names end in
    _EFFORT_Cn_Rn, as those of one subject of LibEMG's ContractionIntensity.

    Raises:
        ConfigError: the extra `emg` is not installed, or no window is left.
        InputFileError: it cannot be read, or lacks what is needed.
    """
    recorded = _folder(path) if path.is_dir() else read(path)
    rate_hz = recorded.rate_hz
    windows = windows_of([recorded], segmenting(WINDOW_S, STEP_S, rate_hz), HIGH_PASS)
    names = list(dict.fromkeys(windows.conditions.tolist()))
    parts = {name or UNNAMED: windows.where(windows.conditions == name) for name in names}
    return {
        name: Labelled(part.windows, part.labels, part.repetitions, np.zeros(part.windows.shape[:2]), rate_hz)
        for name, part in parts.items()
    }


def _folder(path: Path) -> Recorded:
    told = [(file, INTENSITY.search(file.stem)) for file in sorted(path.rglob("*.csv"))]
    pieces = [_piece(file, named.groups()) for file, named in told if named]
    if not pieces:
        raise InputFileError(f"{path}: there is no file named like S1_20P_C1_R1.csv in this folder.")
    return Recorded(INTENSITY_HZ, tuple(pieces))


def _piece(file: Path, named: Sequence[str]) -> Piece:
    condition, label, repetition = named
    samples = load(file, None, None).samples.astype(np.float64)
    count = len(samples)
    numbers = np.full(count, int(repetition))
    return Piece(samples, np.full(count, f"class_{label}"), numbers, np.full(count, condition))
