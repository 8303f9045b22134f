"""Muscles: what features, decisions and control cost, and how right they are."""

from collections.abc import Iterator

from tests.benchmarks import (
    emg_accuracy,
    emg_adaptation,
    emg_control,
    emg_features,
    emg_online,
    emg_patterns,
)
from tests.benchmarks.harness import Row, main

PARTS = (
    emg_features.rows,
    emg_online.rows,
    emg_accuracy.rows,
    emg_control.rows,
    emg_patterns.rows,
    emg_adaptation.rows,
)


def rows() -> Iterator[Row]:
    """Everything."""
    for part in PARTS:
        yield from part()


if __name__ == "__main__":
    main("emg", rows())
