"""libemg in an environment of its own, since it needs another NumPy: it answers requests over a pipe.

The same file is both ends. Run by that environment's Python, it is the one that answers: with the name of a
file with windows, shape (windows, channels, samples), and one request a line.
"""

import contextlib
import importlib
import json
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

VERSION = "2.0.3"
FOLDER = Path(__file__).parents[2] / "build" / "libemg_venv"
PYTHON = FOLDER / "bin" / "python"
INSTALL_S = 1800  # it brings a gigabyte
ANSWER_S = 120

Array = NDArray[np.float64]


class NotMeasuredError(Exception):
    """libemg cannot be had; the text says why."""


def installed() -> None:
    """Make the environment if it is not there.

    Raises:
        NotMeasuredError: it cannot be made.
    """
    if _answers():
        return
    try:
        _run([sys.executable, "-m", "venv", "--clear", str(FOLDER)])
        _run([str(PYTHON), "-m", "pip", "install", "--quiet", f"libemg=={VERSION}"])
    except (OSError, subprocess.SubprocessError) as error:
        told = (getattr(error, "stderr", "") or str(error)).strip().splitlines()
        shutil.rmtree(FOLDER, ignore_errors=True)
        raise NotMeasuredError(
            f"libemg {VERSION} cannot be installed: {told[-1] if told else error}"
        ) from error
    if not _answers():
        raise NotMeasuredError(f"libemg {VERSION} is installed and cannot be imported")


def _answers() -> bool:
    ask = f"import libemg, importlib.metadata as m; assert m.version('libemg') == '{VERSION}'"
    with contextlib.suppress(OSError, subprocess.SubprocessError):
        _run([str(PYTHON), "-c", ask])
        return True
    return False


def _run(command: Sequence[str]) -> None:
    subprocess.run(command, check=True, capture_output=True, text=True, timeout=INSTALL_S, env=_environment())


def _environment() -> dict[str, str]:
    """Without what would lead its Python to our packages."""
    return {key: value for key, value in os.environ.items() if not key.startswith(("PYTHON", "VIRTUAL_ENV"))}


class Libemg:
    """The process that answers."""

    def __init__(self, folder: Path, pipes: tuple[IO[str], IO[str]]) -> None:
        self._folder = folder
        self._to, self._from = pipes

    def seconds(self, features: Sequence[str], windows: int, calls: int) -> float:
        """Of one of so many calls, on the first `windows` windows."""
        return float(self._ask(features, windows, calls)["seconds"])

    def values(self, features: Sequence[str], windows: int) -> Array:
        """What it computes, shape (windows, columns)."""
        path = self._folder / "values.npy"
        self._ask(features, windows, 1, str(path))
        found: Array = np.load(path, allow_pickle=False)
        return found

    def _ask(self, features: Sequence[str], windows: int, calls: int, path: str = "") -> dict[str, Any]:
        self._to.write(json.dumps([list(features), windows, calls, path]) + "\n")
        self._to.flush()
        line = self._from.readline()
        if not line:
            raise NotMeasuredError("libemg ended without an answer")
        answer: dict[str, Any] = json.loads(line)
        return answer


@contextlib.contextmanager
def libemg(windows: Array) -> Iterator[Libemg]:
    """The process, with these windows.

    Raises:
        NotMeasuredError: libemg cannot be had.
    """
    installed()
    with TemporaryDirectory() as name:
        folder = Path(name)
        np.save(folder / "windows.npy", windows)
        command = [str(PYTHON), __file__, str(folder / "windows.npy")]
        with subprocess.Popen(
            command, text=True, stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=_environment()
        ) as process:
            assert process.stdin
            assert process.stdout
            try:
                yield Libemg(folder, (process.stdin, process.stdout))
            finally:
                process.stdin.close()
                process.wait(ANSWER_S)


def answer(path: str) -> None:
    """Answer every line until there is none: features, windows, calls, and where to put the values."""
    with contextlib.redirect_stdout(sys.stderr):  # it says what it misses
        extractor = importlib.import_module("libemg.feature_extractor").FeatureExtractor()
    windows = np.load(path, allow_pickle=False)
    for line in sys.stdin:
        features, count, calls, out = json.loads(line)
        some = windows[:count]
        begun = time.perf_counter()
        for _ in range(calls):
            found = extractor.extract_features(features, some, array=True)
        seconds = (time.perf_counter() - begun) / calls
        if out:
            np.save(out, found)
        sys.stdout.write(json.dumps({"seconds": seconds}) + "\n")
        sys.stdout.flush()


if __name__ == "__main__":
    answer(sys.argv[1])
