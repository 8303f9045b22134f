"""Thesis 5.4: way points in the plane of two joints, alone and then with an arm that helps a little."""

from collections.abc import Sequence

import numpy as np

from bentod.learn.returns import ideal_predictions
from sim.people.operator import Operator
from sim.people.traits import AUTHOR
from sim.studies.maze_charts import BLACK, BLUE, GREEN, MAGENTA
from sim.studies.maze_claims import mean, seconds, toggles
from sim.studies.session import Setup, begin
from sim.studies.session_config import SPEED, WAYPOINTS_HELP
from sim.studies.stage import CircuitResult, Circuits
from sim.studies.study import Chart, Claim, Findings, Line, People, Plot, Setting, Study
from sim.studies.track import COLUMNS, Track, Tracker
from sim.studies.waypoints import Waypoints

TRAINING, ASSISTED = 29, 50
FAR = 120.0
"""Steps: the longer timescale of Fig. 5.4."""


def run(seed: int, asked: People) -> Findings:
    """29 circuits alone and 50 helped, or as many of each as are asked for."""
    circuits = Circuits(asked.circuits or TRAINING, asked.circuits or ASSISTED)
    tracker = Tracker(WAYPOINTS_HELP.timescale)
    operator = Operator(AUTHOR, seed, SPEED)
    played = begin(operator, Waypoints(), circuits, Setup(WAYPOINTS_HELP, seed), tracker)
    results, track = played.results, tracker.track
    solo, helped = results[: circuits.solo], results[circuits.solo :]
    return Findings(
        settings=SETTINGS,
        claims=_claims(solo, helped, track, circuits.solo),
        pictures=(),
        comparison=_table(solo, helped),
        series={name: track[name] for name in COLUMNS},
        simulated=SIMULATED,
        charts=_charts(track, circuits.solo),
    )


def together(track: Track) -> float:
    """Share of the ticks in which one joint moves, in which the other does, too."""
    moving = np.abs(np.diff(track.positions(), axis=0)) > 0.02 / 30
    return float(moving.all(axis=1).sum() / max(1, moving.any(axis=1).sum()))


def _part(track: Track, circuits: Sequence[int]) -> Track:
    return Track(track.rows[np.isin(track["circuit"], circuits)], track.timescale)


def _claims(
    solo: Sequence[CircuitResult], helped: Sequence[CircuitResult], track: Track, first: int
) -> tuple[Claim, ...]:
    numbers = [range(first), range(first, first + len(helped))]
    alone, beside = (together(_part(track, list(part))) for part in numbers)
    spread = float(np.nanmax(np.abs(track.predictions())))
    minutes = mean(solo, seconds) * TRAINING / 60
    moved = "share of motion in which both joints move: helped less alone"
    return (
        Claim("5.4", "training: minutes of 29 circuits", minutes, "at least", 9),
        Claim("5.4", "training: minutes of 29 circuits", minutes, "at most", 13),
        Claim("Fig. 5.5", moved, beside - alone, "at least", 0.02),
        Claim("Fig. 5.6", "predictions stay stable: farthest of all (rad)", spread, "at most", 1.0),
        Claim("Fig. 5.7", "circuits that were given up", sum(not r.whole for r in helped), "at most", 0),
    )


def _table(solo: Sequence[CircuitResult], helped: Sequence[CircuitResult]) -> tuple[Sequence[str], ...]:
    tenth = max(1, len(helped) // 10)
    parts = {"solo": solo, "first helped": helped[:tenth], "helped": helped, "last helped": helped[-tenth:]}
    rows = [
        (name, str(len(part)), f"{mean(part, seconds):.1f}", f"{mean(part, toggles):.1f}")
        for name, part in parts.items()
    ]
    return (("circuits", "number", "s", "toggles"), *rows)


def _charts(track: Track, first: int) -> tuple[Chart, ...]:
    last = int(track["circuit"].max())
    last -= (track["circuit"] == last).sum() < 30
    training, final = track.circuit(max(first - 1, 0)), track.circuit(last)
    far = ideal_predictions(training.positions(), FAR)
    near = training.ideal()
    path = Line(training["shoulder_rad"], training["elbow_rad"], BLUE, "training")
    outcome = Line(near[:, 0], near[:, 1], GREEN, "ideal, 20 steps")
    helped = _by_joint(final)
    return (
        Chart(
            "5-4",
            "A training circuit, its ideal outcomes, and a helped circuit: Fig. 5.4",
            "Left: what perfect predictions of 20 and 120 steps would be. Right: the last helped circuit.",
            (
                _plane("a", (path, outcome, Line(far[:, 0], far[:, 1], MAGENTA, "ideal, 120 steps"))),
                _plane("b", (path, outcome, *helped)),
            ),
            columns=2,
            height=3.4,
        ),
        _in_time(final),
        _all("5-6", "Predictions of all helped circuits: Fig. 5.6", track, first, last, 6),
        _all("5-7", "Ways of all helped circuits: Fig. 5.7", track, first, last, 4),
    )


def _by_joint(track: Track) -> tuple[Line, ...]:
    active, (x, y) = track["active"], track.positions().T
    return tuple(
        Line(np.where(active == which, x, np.nan), np.where(active == which, y, np.nan), colour, label)
        for which, colour, label in ((0, MAGENTA, "shoulder driven"), (1, BLACK, "elbow driven"))
    )


def _plane(title: str, lines: tuple[Line, ...]) -> Plot:
    return Plot(title, lines, "shoulder (rad)", "elbow (rad)", equal=True)


def _in_time(track: Track) -> Chart:
    time, ideal, predicted = track["time_s"] - track["time_s"][0], track.ideal(), track.predictions()
    plots = [
        Plot(
            f"{joint} (rad)",
            (
                Line(time, track[f"{joint}_rad"], (MAGENTA, BLACK)[i], "angle", width=1.6),
                Line(time, ideal[:, i], BLUE, "ideal prediction"),
                Line(time, predicted[:, i], GREEN, "prediction"),
            ),
        )
        for i, joint in enumerate(("shoulder", "elbow"))
    ]
    plots.append(Plot("attended: elbow 1, shoulder 0", (Line(time, track["active"], BLACK),), "s"))
    title = "The last helped circuit in time: Fig. 5.5"
    return Chart("5-5", title, "Both joints move where both curves do.", tuple(plots))


def _all(name: str, title: str, track: Track, first: int, last: int, column: int) -> Chart:
    """`column`: of the shoulder; the elbow's is the next."""
    lines = []
    for number in range(first, last + 1):
        shade = round(200 - 120 * (number - first) / max(1, last - first))
        colour = {first: GREEN, last: BLUE}.get(number, f"#{shade:02x}{shade:02x}{shade:02x}")
        rows = track.circuit(number).rows
        width = 1.2 if number in (first, last) else 0.4
        lines.append(Line(rows[:, column], rows[:, column + 1], colour, width=width))
    caption = "Green: the first; blue: the last; between them from light to dark."
    return Chart(name, title, caption, (_plane("", tuple(lines)),), height=3.6)


SETTINGS = (
    Setting("circuit", "1-2-3-2-1, within 1 degree, 3 s each", "the same; where they lie is ours"),
    Setting("training, then DPCC", "29 and 50 circuits", "the same, --circuits for others"),
    Setting("timescale and k", "20 steps, 0.025", "the same"),
    Setting("operator", "the author, with a joystick", "simulated, like the author"),
)
SIMULATED = (
    "The operator and the arm are simulated; controller, learners and assist are the daemon's. A simulated "
    "operator is a check of the software and no evidence about people."
)

STUDY = Study(
    title="Way points (thesis 5.4)",
    about="a simulated operator goes round a circuit of way points, alone and helped",
    run=lambda seed, minutes: run(seed, People()),
    minutes=0.0,
    least_minutes=0.0,
    people=run,
)
