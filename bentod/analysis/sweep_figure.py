"""The errors of a sweep over its first parameter, one line for each choice of the others."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes

from bentod.analysis.drawing import COLOURS, GREY, Drawn, blank, save, style
from bentod.frames import Value
from bentod.replay.sweep import Outcome, shown

_HEIGHT = 3.4  # inches
_WIDE = 8.0
"""Times the least value that the greatest is, from which on an axis is logarithmic."""


def draw(outcomes: Sequence[Outcome], path: Path) -> None:
    """Write the figure of a sweep to `path`, the same each time. Raises as `save` does."""
    with style():
        figure = blank(_HEIGHT)
        axes = figure.subplots()
        _lines(axes, outcomes)
        axes.axhline(1.0, color=GREY, linestyle=":", label="live")
        axes.set_ylabel("error, of that live")
        if axes.get_legend_handles_labels()[0]:
            axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    save(Drawn("sweep", "", "", figure, {}), path)


def _lines(axes: Axes, outcomes: Sequence[Outcome]) -> None:
    first, *_ = outcomes[0].point.changes
    ticks = list(dict.fromkeys(shown(outcome.point.changes[first]) for outcome in outcomes))
    numbers = _numbers([outcome.point.changes[first] for outcome in outcomes])
    lines: dict[str, list[tuple[float, float]]] = {}
    for place, outcome in enumerate(outcomes):
        x = ticks.index(shown(outcome.point.changes[first])) if numbers is None else numbers[place]
        lines.setdefault(_others(outcome.point.changes, first), []).append((x, outcome.relative))
    for place, (label, line) in enumerate(lines.items()):
        x_values, y_values = zip(*sorted(line), strict=True)
        axes.plot(x_values, y_values, "o-", markersize=3, color=COLOURS[place % len(COLOURS)], label=label)
    axes.set_xlabel(first)
    if numbers is None:
        axes.set_xticks(range(len(ticks)), ticks)
    elif min(numbers) > 0 and max(numbers) >= _WIDE * min(numbers):
        axes.set_xscale("log")


def _numbers(values: Sequence[Value]) -> list[float] | None:
    """`values` as numbers; None if not all are."""
    found = [float(v) for v in values if isinstance(v, int | float) and not isinstance(v, bool)]
    return found if len(found) == len(values) and np.isfinite(found).all() else None


def _others(changes: Mapping[str, Value], first: str) -> str:
    return ", ".join(f"{key.rpartition('.')[2]} {shown(v)}" for key, v in changes.items() if key != first)
