"""What was collected for training, session after session, in one file without pickles.

The arrays are those of a labelled recording (docs/muscles.md), one entry of `length` a session, and
`prompted`: what was asked for at each sample, where `labels` tells what was found to be done.
"""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from bentod.emg.classify.labelled import Names, Piece, Recorded
from bentod.emg.classify.labelled_files import read
from bentod.emg.live.plan import MOST_VALUES
from bentod.errors import InputFileError
from bentod.whole_file import replacing

Arrays = Mapping[str, NDArray[np.generic]]


def saved(path: Path, arrays: Arrays) -> None:
    """Put arrays in the place of `path`; what stood there stays until all is written.

    Raises:
        OSError: the disk does not take it.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    with replacing(path) as file:
        np.savez(file, allow_pickle=False, **dict(arrays))


def add(path: Path, piece: Piece, prompted: Names, rate_hz: float, keep: bool) -> tuple[int, int]:
    """Add a session to the file, or begin the file anew unless `keep`.

    Returns how many sessions are in the file, and how many old ones had to go for want of room. Repetitions
    of the new session are numbered after those that are there.

    Raises:
        InputFileError: what is there cannot be read, or is of another rate or number of channels.
        OSError: the disk does not take it.
    """
    pieces, asked = _kept(path, piece, rate_hz) if keep and path.exists() else ([], [])
    after = max((int(old.repetitions.max()) + 1 for old in pieces), default=0)
    pieces.append(replace(piece, repetitions=piece.repetitions + after))
    asked.append(prompted)
    gone = 0
    while len(pieces) > 1 and sum(one.samples.size for one in pieces) > MOST_VALUES:
        del pieces[0], asked[0]
        gone += 1
    saved(path, _arrays(Recorded(rate_hz, tuple(pieces)), asked))
    return len(pieces), gone


def _kept(path: Path, piece: Piece, rate_hz: float) -> tuple[list[Piece], list[Names]]:
    old = read(path)
    channels = piece.samples.shape[1]
    if abs(old.rate_hz - rate_hz) > 0.01 * rate_hz or old.channels != channels:
        raise InputFileError(
            f"{path}: holds {old.channels} channels at {old.rate_hz:g} Hz; here there are {channels} at "
            f"{rate_hz:g} Hz. Begin anew."
        )
    with np.load(path, allow_pickle=False) as file:
        prompted = file["prompted"] if "prompted" in file.files else file["labels"]
    edges = np.cumsum([len(one.samples) for one in old.pieces])[:-1]
    return list(old.pieces), [part.astype(np.str_) for part in np.split(prompted, edges)]


def _arrays(recorded: Recorded, prompted: list[Names]) -> Arrays:
    pieces = recorded.pieces
    return {
        "emg": np.concatenate([piece.samples.astype(np.float32) for piece in pieces]),
        "fs": np.array(recorded.rate_hz),
        "length": np.array([len(piece.samples) for piece in pieces]),
        "labels": np.concatenate([piece.labels for piece in pieces]),
        "prompted": np.concatenate(prompted),
        "rep": np.concatenate([piece.repetitions for piece in pieces]),
        "condition": np.concatenate([piece.conditions for piece in pieces]),
    }
