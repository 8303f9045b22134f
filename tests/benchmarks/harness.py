"""What every benchmark shares: rows with targets, fair comparison within one run, a table and a JSON file."""

import json
import statistics
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import click

BUILD = Path(__file__).parents[2] / "build" / "bench"


@dataclass(frozen=True, slots=True)
class Row:
    """One number, and what was promised of it."""

    name: str
    value: float
    unit: str
    target: str = ""  # as a person reads it, e.g. "<= 2"; empty: nothing was promised
    holds: bool | None = None  # None: nothing was promised


def at_most(name: str, value: float, unit: str, bound: float) -> Row:
    """A row that holds while `value` is not above `bound`."""
    return Row(name, value, unit, f"<= {bound:g}", value <= bound)


def at_least(name: str, value: float, unit: str, bound: float) -> Row:
    """A row that holds while `value` is not below `bound`."""
    return Row(name, value, unit, f">= {bound:g}", value >= bound)


def interleave(measures: Mapping[str, Callable[[], float]], rounds: int) -> dict[str, list[float]]:
    """Measure everything once a round, each round starting with the next one.

    So what disturbs the machine, and what the first to run pays, falls on all alike.
    """
    values: dict[str, list[float]] = {name: [] for name in measures}
    names = list(measures)
    for number in range(rounds):
        first = number % len(names)
        for name in names[first:] + names[:first]:
            values[name].append(measures[name]())
    return values


def medians(measures: Mapping[str, Callable[[], float]], rounds: int = 7) -> dict[str, float]:
    """Median of each measure over interleaved rounds."""
    return {name: statistics.median(values) for name, values in interleave(measures, rounds).items()}


def main(name: str, rows: Iterable[Row], folder: Path = BUILD) -> None:
    """Print `rows` as a table and write them to `folder`/`name`.json. A missed target is told, not raised."""
    found = list(rows)
    click.echo(table(found))
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / f"{name}.json"
    file.write_text(json.dumps([asdict(row) for row in found], indent=2) + "\n")
    click.echo(f"written to {file}")


def table(rows: Sequence[Row]) -> str:
    """One line a row, columns aligned, the missed targets marked."""
    cells = [("what", "value", "unit", "target", "")]
    cells += [(row.name, f"{row.value:.4g}", row.unit, row.target, _verdict(row)) for row in rows]
    widths = [max(len(row[column]) for row in cells) for column in range(len(cells[0]))]
    return "\n".join(_line(row, widths) for row in cells)


def _line(cells: Sequence[str], widths: Sequence[int]) -> str:
    name, value, *rest = cells
    left = [cell.ljust(width) for cell, width in zip(rest, widths[2:], strict=True)]
    return "  ".join([name.ljust(widths[0]), value.rjust(widths[1]), *left]).rstrip()


def _verdict(row: Row) -> str:
    return {True: "holds", False: "DOES NOT HOLD", None: ""}[row.holds]
