"""Table B.1 of the thesis: its rows, and those of simulated operators in the same columns."""

import statistics
from collections.abc import Sequence

from sim.studies.stage import CircuitResult

HEAD = (
    *("Subject", "Timescale (ts)"),
    *("solo toggles avg (stdev)", "min (count)", "max", "solo time (s) avg (stdev)", "fastest", "slowest"),
    *("DPCC toggles avg (stdev)", "min (count)", "max", "first cct"),
    *("DPCC time (s) avg (stdev)", "fastest", "slowest", "first cct"),
)

THESIS = (
    (
        *("A", "20", "15.7 (1.45)", "14 (7)", "18", "27.2 (2.32)", "24.6", "35.2"),
        *("4.05 (3.73)", "1 (5)", "17", "17", "22.9 (6.47)", "15.7", "39.9", "37.5"),
    ),
    (
        *("B", "15", "13.6 (2.37)", "10 (1)", "18", "20.0 (1.68)", "18.1", "23.5"),
        *("7.45 (3.71)", "3 (1)", "19", "14", "23.3 (8.46)", "15.0", "49.1", "44.5"),
    ),
    (
        *("C", "10", "13.7 (2.25)", "10 (2)", "18", "20.6 (1.93)", "18.3", "24.6"),
        *("6.05 (4.85)", "0 (2)", "21", "21", "21.6 (6.61)", "15.9", "43.8", "43.8"),
    ),
    (
        *("Author", "10", "11.9 (1.37)", "10 (4)", "14", "19.8 (0.843)", "18.7", "22.4"),
        *("2.2 (0.616)", "1 (1)", "4", "4", "16.7 (0.865)", "15.6", "18.9", "18.9"),
    ),
    (
        *("Author", "15", "11 (1.03)", "10 (9)", "13", "19.0 (0.573)", "18.2", "20.7"),
        *("3.45 (1.96)", "1 (3)", "8", "1", "17.0 (1.99)", "14.0", "22.5", "16.3"),
    ),
)
"""The table as it stands there."""


def row(subject: str, timescale: float, results: Sequence[CircuitResult]) -> tuple[str, ...]:
    """One session in the columns of `HEAD`; circuits that were given up count as they are."""
    solo = [result for result in results if result.condition == "solo"]
    assisted = [result for result in results if result.condition == "assisted"]
    return (
        subject,
        f"{timescale:g}",
        *_toggles(solo),
        *_times(solo),
        *_toggles(assisted),
        str(assisted[0].toggles) if assisted else "",
        *_times(assisted),
        f"{assisted[0].time:.1f}" if assisted else "",
    )


def _toggles(results: Sequence[CircuitResult]) -> tuple[str, str, str]:
    counts = [result.toggles for result in results]
    if not counts:
        return "", "", ""
    return _spread(counts), f"{min(counts)} ({counts.count(min(counts))})", str(max(counts))


def _times(results: Sequence[CircuitResult]) -> tuple[str, str, str]:
    times = [result.time for result in results]
    if not times:
        return "", "", ""
    return _spread(times), f"{min(times):.1f}", f"{max(times):.1f}"


def _spread(values: Sequence[float]) -> str:
    """Mean and deviation of the sample, which is none of a single value."""
    deviation = f" ({statistics.stdev(values):.3g})" if len(values) > 1 else ""
    return f"{statistics.fmean(values):.3g}{deviation}"
