"""Thesis 4.5.1: what three cliff sensors will see, and from those predictions what a fourth will see.

A robot turns on the spot. Primary layer: Left, Front-Left and Front-Right are predicted from traces of all
sensors. Secondary layer: Right is predicted from traces of those three predictions alone. Figs. 4.4 and 4.5.
"""

from collections.abc import Iterable, Mapping
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from bentod.contracts import Features, Vector
from bentod.learn.group import Group
from bentod.learn.kernel import choose
from bentod.learn.returns import discount, ideal_predictions
from bentod.learn.tiles import TileCoder
from bentod.learn.traces import HistoryTraces
from sim.studies.create import NAMES
from sim.studies.drive import Drive, drive
from sim.studies.floor import thesis_floor
from sim.studies.measures import against_ideal, correlation, lead, nrmse, settled
from sim.studies.study import RATE_HZ, Claim, Findings, Panel, Picture, Setting, Study

DECAYS = (0.8, 0.98)
TILINGS, WIDTH, MEMORY = 100, 1.0, 2048
TIMESCALE = 30  # steps
LAMBDA = 0.95
ALPHA = 1 / (TILINGS + 1)
PRIMARY = NAMES[:3]
SECONDARY = NAMES[3]
TITLES = {
    "left": "Left",
    "front_left": "Front-Left",
    "front_right": "Front-Right",
    "right": "Right",
}
JUDGED = 0.2
"""Share of the run, at its end, over which errors are taken: the last four minutes of twenty."""
SHOWN_S = 30.0
YARDSTICK = "all sensors, straight (not in the thesis)"

Signals = NDArray[np.float64]  # shape (steps, signals)


def layer(inputs: Signals, targets: Signals) -> Signals:
    """What True Online TD(λ) predicts of `targets` at each step, from traces of `inputs` (0..1)."""
    traces = [HistoryTraces(decay) for decay in DECAYS]
    tiles = TileCoder(len(DECAYS) * inputs.shape[1], TILINGS, WIDTH, MEMORY)
    features = (
        np.append(tiles.encode([value for trace in traces for value in trace.step(seen)]), MEMORY)
        for seen in inputs.tolist()
    )
    return predicted(features, MEMORY + 1, targets)


def predicted(features: Iterable[Features], size: int, targets: Signals) -> Signals:
    """What True Online TD(λ) predicts of `targets`, shape (steps, signals). `size`: number of features."""
    gamma, count = discount(TIMESCALE), targets.shape[1]
    group = Group(np.empty((size, count)), np.zeros(count), "true_online", ALPHA, choose())
    steps = zip(features, (1 - gamma) * targets, strict=True)
    return np.array([group.step(active, rewards, gamma, LAMBDA) for active, rewards in steps])


def run(seed: int, minutes: float) -> Findings:
    """Drive, learn both layers, and judge."""
    recorded = drive(thesis_floor(), seed, minutes)
    targets = recorded.binary[:, :4]
    # Its fourth column, Right straight from the sensors, is no part of the thesis, but a yardstick.
    first = layer(recorded.binary, targets)
    second = layer(first[:, :3], targets[:, 3:])[:, 0]
    others = _rivals(first, targets[:, 3:], np.random.default_rng(seed))
    ideal = ideal_predictions(targets, TIMESCALE)
    judged = settled(len(targets), JUDGED, TIMESCALE)
    claims = (
        *_order(recorded, judged),
        *(c for i in range(3) for c in _primary(i, first[judged], targets[judged], ideal[judged])),
        *_secondary(second[judged], targets[judged, 3], ideal[judged, 3]),
        *_beaten(second[judged], others, ideal[judged, 3], judged),
    )
    predictions = np.column_stack([first[:, :3], second])
    compared = {"primary predictions (the secondary layer)": second, **others, YARDSTICK: first[:, 3]}
    return Findings(
        SETTINGS,
        claims,
        _pictures(recorded.time, targets, predictions, ideal, judged),
        against_ideal("Right predicted from", compared, ideal[:, 3], judged),
        _series(recorded, predictions, ideal),
        SIMULATED,
    )


def _rivals(first: Signals, right: Signals, rng: np.random.Generator) -> dict[str, Vector]:
    """Predictions of Right that know nothing of the primary layer, or not when it said what."""
    bias = np.array([0])
    return {
        "primary predictions, shuffled in time": layer(rng.permutation(first[:, :3]), right)[:, 0],
        "bias alone": predicted((bias for _ in right), 1, right)[:, 0],
        "persistence: what Right sees now": right[:, 0],
    }


def _order(recorded: Drive, judged: slice) -> list[Claim]:
    """Right passes over a surface last."""
    seen = [recorded.seen(name)[judged] for name in (*PRIMARY, SECONDARY)]
    delays = [lead(a, b, 3 * RATE_HZ) / RATE_HZ for a, b in pairwise(seen)]
    text = "Right is the last sensor to pass over a surface: least delay between neighbours (s)"
    return [Claim("4.5.1", text, min(delays), "at least", 0.2)]


def _primary(i: int, predictions: Signals, targets: Signals, ideal: Signals) -> list[Claim]:
    name = TITLES[NAMES[i]]
    p, x, g = predictions[:, i], targets[:, i], ideal[:, i]
    return [
        Claim("Fig. 4.4", f"{name}: very good prediction, error (NRMSE)", nrmse(p, g), "at most", 0.4),
        Claim("Fig. 4.4", f"{name}: correlation with the ideal", correlation(p, g), "at least", 0.9),
        Claim("Fig. 4.4", f"{name}: runs ahead of the target (steps)", _lead(p, x), "at least", 5),
    ]


def _secondary(p: Vector, x: Vector, g: Vector) -> list[Claim]:
    return [
        Claim("Fig. 4.5", "Right, from predictions alone: error (NRMSE)", nrmse(p, g), "at most", 0.65),
        Claim("Fig. 4.5", "Right: correlation with the ideal", correlation(p, g), "at least", 0.8),
        Claim("Fig. 4.5", "Right: runs ahead of the target (steps)", _lead(p, x), "at least", 5),
    ]


def _lead(p: Vector, x: Vector) -> float:
    return float(lead(p, x, 2 * TIMESCALE))


def _beaten(second: Vector, rivals: Mapping[str, Vector], ideal: Vector, judged: slice) -> list[Claim]:
    shares = {name: nrmse(second, ideal) / nrmse(rival[judged], ideal) for name, rival in rivals.items()}
    text = "Right: error as a share of that of"
    return [Claim("Fig. 4.5", f"{text} {name}", share, "at most", 0.6) for name, share in shares.items()]


def _pictures(
    time: Vector, targets: Signals, predictions: Signals, ideal: Signals, judged: slice
) -> tuple[Picture, ...]:
    shown = slice(max(judged.start, judged.stop - round(SHOWN_S * RATE_HZ)), judged.stop)
    panels = [
        Panel(
            TITLES[name],
            {"target": targets[shown, i], "ideal": ideal[shown, i], "prediction": predictions[shown, i]},
        )
        for i, name in enumerate((*PRIMARY, SECONDARY))
    ]
    look = (
        f"Target signal, its prediction {TIMESCALE} time steps (1 s) ahead, and the ideal prediction "
        f"(dashed): the last {SHOWN_S:g} s of which returns are known."
    )
    axis = "time (s)"
    return (
        Picture("4-4", "Primary layer: Fig. 4.4", look, time[shown], axis, tuple(panels[:3])),
        Picture("4-5", "Secondary layer: Fig. 4.5", look, time[shown], axis, tuple(panels[3:])),
    )


def _series(recorded: Drive, predictions: Signals, ideal: Signals) -> dict[str, Vector]:
    columns = {"time_s": recorded.time, "asked_rad_s": recorded.speed}
    columns |= {f"{name}.signal": recorded.signals[:, i] for i, name in enumerate(NAMES)}
    columns |= {f"{name}.binary": recorded.seen(name) for name in NAMES}
    columns |= {f"{name}.prediction": predictions[:, i] for i, name in enumerate(NAMES[:4])}
    columns |= {f"{name}.ideal": ideal[:, i] for i, name in enumerate(NAMES[:4])}
    return columns


SETTINGS = (
    Setting("robot", "iRobot Create on the floor", "simulated, sensors where the Create has them"),
    Setting(
        "behaviour",
        "counter-clockwise, 20 min, new speed every 2 min",
        "the same unless told otherwise, 0.46 to 1.15 rad/s",
    ),
    Setting("surfaces", "black tape, blue tape, beige tiles, black tiles", "the same; we placed them"),
    Setting("rate", "30 Hz", "the same"),
    Setting("signals", "binary, one threshold for each sensor", "the same; bright is 1"),
    Setting("history", "traces (4.7), decay 0.8 and 0.98: 10", "the same"),
    Setting("primary features", "10-dimensional, 100 tilings of width 1.0, hashed to 2048, bias", "the same"),
    Setting("secondary inputs", "3 predictions, traces 0.8 and 0.98: 6", "the same"),
    Setting("secondary features", "6-dimensional, otherwise as the primary", "the same"),
    Setting("tile coding", "Sutton's library", "bentod/learn/tiles.py: another hash, sets of features"),
    Setting("learner", "True Online TD(λ), λ = 0.95, α = 1/(100 + 1)", "the same"),
    Setting("prediction", "30 time steps, γ = 1 − 1/30, instantaneous (4.2)", "the same"),
    Setting("learning", "off line, after recording", "the same: step by step through the recording"),
)

SIMULATED = (
    "Everything physical is simulated: the robot, its floor, its sensors. Where the cliff sensors sit and "
    "how far the wheels stand apart is from a published description of the Create; reflectances, "
    "sensitivities, noise, the sensor's spot, slip, the layout of the floor and the range of speeds "
    "are guesses, so the curves are counterparts of the thesis' figures and not copies of them. The wall "
    "sensor looks straight ahead, as the thesis says. Learners, tile coding and traces are the daemon's."
)

STUDY = Study(
    title="Cliff sensors in two layers (thesis 4.5.1)",
    about="a turning robot predicts a fourth cliff sensor from its predictions of three others",
    run=run,
    minutes=20.0,
    least_minutes=1.0,
)
