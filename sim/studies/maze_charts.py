"""Counterparts of Figs. 5.9 to 5.12: ways through the maze, what they cost, and one circuit in time."""

from collections.abc import Callable, Sequence
from itertools import pairwise
from math import hypot

import numpy as np

from bentod.contracts import Vector
from sim.studies.maze import CENTRE, HALF_WIDTH
from sim.studies.maze_claims import seconds, toggles
from sim.studies.maze_people import Helped, Person
from sim.studies.stage import CircuitResult
from sim.studies.study import Chart, Line, Plot
from sim.studies.track import Track

MAGENTA, BLACK, GREEN, BLUE, RED, GREY = "#cc3399", "#22262e", "#009e73", "#0072b2", "#c0392b", "#8a8f98"
"""As in the thesis: magenta while the operator has the shoulder, black for the elbow, green predictions."""

SHOWN = "thesis 20"


def charts(people: Sequence[Person]) -> tuple[Chart, ...]:
    """Of the operator who is most like the author, with the thesis' assist at 20 steps if there is one."""
    shown = next((person for person in people if person.name.startswith("author")), people[-1])
    ways = list(shown.helped)
    first = SHOWN if SHOWN in ways else ways[0]
    kept = [first] + [way for way in ("confident",) if way in ways and way != first]
    found = [_costs(people, ways)]
    for way in kept:
        helped = shown.helped[way]
        if helped.track and shown.track:
            found += _of_one(shown.name, way, helped, helped.track, shown.track)
    return tuple(found)


def _of_one(name: str, way: str, helped: Helped, track: Track, solo: Track) -> list[Chart]:
    key, who = way.replace(" ", "-"), f"{name}, {way}"
    best, worst = _extreme(helped, toggles, min), _extreme(helped, toggles, max)
    return [
        Chart(
            f"5-9-{key}",
            f"Solo and helped through the maze: Fig. 5.9 ({who})",
            "Blue: a solo circuit. Magenta and black: the operator drives the shoulder, the elbow.",
            (_plane(track.circuit(best), "", alone=solo.circuit(int(solo["circuit"].max() - 1))),),
            height=3.6,
        ),
        Chart(
            f"5-11-{key}",
            f"Several circuits: Fig. 5.11 ({who})",
            "Green: predictions. Red: contacts with a wall.",
            tuple(_plane(track.circuit(n), f"{what}: {n + 1}") for what, n in _notable(helped)),
            columns=3,
            height=2.5,
        ),
        _in_time(track, best, f"5-12a-{key}", f"Circuit with the fewest toggles: Fig. 5.12a ({who})"),
        _in_time(track, worst, f"5-12b-{key}", f"Circuit with the most toggles: Fig. 5.12b ({who})"),
    ]


def _extreme(
    helped: Helped, measure: Callable[[CircuitResult], float], which: Callable[..., CircuitResult]
) -> int:
    """The place of a circuit, from 0."""
    return which(helped.results, key=measure).number - 1


def _notable(helped: Helped) -> list[tuple[str, int]]:
    return [
        ("first", 0),
        ("last", len(helped.results) - 1),
        ("fewest toggles", _extreme(helped, toggles, min)),
        ("fastest", _extreme(helped, seconds, min)),
        ("most toggles", _extreme(helped, toggles, max)),
        ("slowest", _extreme(helped, seconds, max)),
    ]


def _plane(track: Track, title: str, alone: Track | None = None) -> Plot:
    lines = _walls()
    if alone is not None:
        lines.append(Line(alone["shoulder_rad"], alone["elbow_rad"], BLUE, "solo"))
    else:
        lines.append(Line(track["shoulder_predicted_rad"], track["elbow_predicted_rad"], GREEN, width=0.5))
    lines += _driven(track)
    touched = track["touching"] > 0
    lines.append(Line(track["shoulder_rad"][touched], track["elbow_rad"][touched], RED, points=True))
    return Plot(title, tuple(lines), "shoulder (rad)", "elbow (rad)", equal=True)


def _driven(track: Track) -> list[Line]:
    shoulder, elbow, active = track["shoulder_rad"], track["elbow_rad"], track["active"]
    return [
        Line(np.where(active == which, shoulder, np.nan), np.where(active == which, elbow, np.nan), colour)
        for which, colour in ((0, MAGENTA), (1, BLACK))
    ]


def _walls() -> list[Line]:
    """To both sides of each piece of the centre line."""
    lines = []
    for (ax, ay), (bx, by) in pairwise(CENTRE):
        length = hypot(bx - ax, by - ay)
        nx, ny = HALF_WIDTH * (by - ay) / length, -HALF_WIDTH * (bx - ax) / length
        lines += [
            Line(np.array([ax + s * nx, bx + s * nx]), np.array([ay + s * ny, by + s * ny]), GREY)
            for s in (-1, 1)
        ]
    return lines


def _costs(people: Sequence[Person], ways: Sequence[str]) -> Chart:
    """Fig. 5.10 for everybody: each operator a line from solo through all assists."""
    names = ", ".join(f"{place} {way}" for place, way in enumerate(("solo", *ways)))
    plots = tuple(
        Plot(
            title,
            tuple(
                Line(np.arange(len(ways) + 1.0), _means(person, ways, measure), _colour(person))
                for person in people
            ),
            "assist",
            "",
        )
        for title, measure in (("toggles a circuit", toggles), ("s a circuit", seconds))
    )
    caption = f"Means of each operator; {names}. Naive grey, practised blue, like the author magenta."
    return Chart("5-10", "What a circuit costs: Fig. 5.10", caption, plots, columns=2, height=2.6)


def _means(person: Person, ways: Sequence[str], measure: Callable[[CircuitResult], float]) -> Vector:
    parts = [person.solo, *(person.helped[way].results for way in ways)]
    return np.array([np.mean([measure(result) for result in part]) for part in parts])


def _colour(person: Person) -> str:
    return {"naive": GREY, "practised": BLUE}.get(person.name.split()[0], MAGENTA)


def _in_time(track: Track, number: int, name: str, title: str) -> Chart:
    shown = track["circuit"] == number
    time = track["time_s"][shown] - track["time_s"][shown][0]
    ideal, errors, predicted = track.ideal()[shown], track.errors()[shown], track.predictions()[shown]
    plots = []
    for i, joint in enumerate(("shoulder", "elbow")):
        plots.append(Plot(f"{joint}: TD error (rad)", (Line(time, errors[:, i], BLACK),)))
        curves = (
            Line(time, track[f"{joint}_rad"][shown], (MAGENTA, BLACK)[i], "angle", width=1.6),
            Line(time, ideal[:, i], BLUE, "ideal prediction"),
            Line(time, predicted[:, i], GREEN, "prediction"),
        )
        plots.append(Plot(f"{joint} (rad)", curves))
    rest = [("contact with a wall", "touching", RED), ("attended: elbow 1, shoulder 0", "active", BLACK)]
    rest += [
        ("feature counts (ticks)", "visits", BLUE),
        ("least feature count (ticks)", "least_visits", BLUE),
    ]
    plots += [Plot(label, (Line(time, track[column][shown], colour),)) for label, column, colour in rest]
    plots[-1] = Plot(plots[-1].title, plots[-1].lines, "s")
    caption = (
        "Feature counts: how often the active features were active before, summed, without the bias; the "
        "least of them is near 0 where the state is new."
    )
    return Chart(name, title, caption, tuple(plots), height=1.0)
