"""Counterparts of Figs. 3.4 to 3.6: accuracy without a load and with one."""

from collections.abc import Mapping, Sequence

import numpy as np

from bentod.contracts import Vector
from sim.movements import LOADS
from sim.studies.patterns import CLASSIFIERS
from sim.studies.patterns_people import RANDOM, SPREAD, Key, mean
from sim.studies.patterns_sets import ALL, SETS, SINGLE, TD_AR
from sim.studies.study import Chart, Line, Plot

COLOURS = ("#0072b2", "#c0392b", "#009e73", "#cc3399")
USABLE = 90.0
"""% below which nobody can use it (thesis 3.2.1: Scheme and Englehart 2011)."""

People = Sequence[Mapping[Key, float]]


def charts(people: People) -> tuple[Chart, ...]:
    """Means over people."""
    return (
        Chart(
            "3-4",
            "Without a load: Fig. 3.4",
            "80 % of the windows at random to train, 20 % to test. Bars: standard error over the splits.",
            (_splits(people),),
            height=3.0,
        ),
        *(_together(people, name, letter) for name, letter in ((TD_AR, "a"), (ALL, "b"))),
        Chart(
            "3-6",
            "Single features under load: Fig. 3.6",
            "Trained without a load. Grey: 90 %, below which nobody can use it, and chance.",
            tuple(_single(people, which) for which in CLASSIFIERS),
            height=2.4,
        ),
    )


def _splits(people: People) -> Plot:
    lines = _bounds(len(SETS))
    for number, which in enumerate(CLASSIFIERS):
        x = np.arange(len(SETS), dtype=np.float64) + 0.12 * (number - 1.5)
        y = [100 * mean(people, name, which, RANDOM) for name in SETS]
        spread = [100 * mean(people, name, which, SPREAD) for name in SETS]
        lines.append(_points(x, y, number, which))
        lines.append(_bars(x, np.array(y), np.array(spread), number))
    return Plot("", tuple(lines), "features", "right (%)", ticks=tuple(SETS))


def _together(people: People, name: str, letter: str) -> Chart:
    lines = _bounds(len(LOADS))
    for number, which in enumerate(CLASSIFIERS):
        tests = (RANDOM, *LOADS[1:])
        y = [100 * mean(people, name, which, test) for test in tests]
        lines.append(
            _points(np.arange(len(LOADS), dtype=np.float64) + 0.08 * (number - 1.5), y, number, which)
        )
    plot = Plot("", tuple(lines), "held", "right (%)", ticks=LOADS)
    return Chart(
        f"3-5{letter}",
        f"{name[0].upper()}{name[1:]} under load: Fig. 3.5{letter}",
        "Trained without a load; unloaded: 80/20. Grey: 90 %, below which nobody can use it, and chance.",
        (plot,),
        height=2.8,
    )


def _single(people: People, which: str) -> Plot:
    lines = _bounds(len(SINGLE))
    for number, load in enumerate(LOADS):
        test = load if number else RANDOM
        y = [100 * mean(people, name, which, test) for name in SINGLE]
        lines.append(
            _points(np.arange(len(SINGLE), dtype=np.float64) + 0.1 * (number - 1.5), y, number, load)
        )
    return Plot(which, tuple(lines), "", "right (%)", ticks=tuple(SINGLE))


def _points(x: Vector, y: Sequence[float], number: int, label: str) -> Line:
    return Line(x, np.asarray(y), COLOURS[number], label, points=True)


def _bars(x: Vector, y: Vector, spread: Vector, number: int) -> Line:
    """From y less its spread to y and its spread at each x."""
    gap = np.full(len(x), np.nan)
    heights = np.column_stack([y - spread, y + spread, gap]).ravel()
    return Line(np.repeat(x, 3), heights, COLOURS[number])


def _bounds(count: int) -> list[Line]:
    ends = np.array([-0.5, count - 0.5])
    return [Line(ends, np.full(2, level), "#8a8f98", width=0.6) for level in (100 / 7, USABLE)]
