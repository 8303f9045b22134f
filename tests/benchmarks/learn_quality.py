"""How well each algorithm predicts on line where a simulated arm goes, over a sweep of step sizes.

The synthetic wearer drives the simulated arm in virtual time, nothing helps them, and both joints' positions
are kept. Then each algorithm learns, from the representation and with the γ and λ of the thesis, where each
joint will be 20 ticks ahead, and every prediction is compared with what a perfect learner would have said.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TypeAlias

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from bentod import registry
from bentod.contracts import Arrival, LearnerSettings
from bentod.learn.returns import discount, ideal_predictions
from sim import clock
from tests.benchmarks.harness import BUILD, Row, at_most, main
from tests.learn.arm_features import ArmFeatures
from tests.rig import PLAIN, Table, joint, number, running, sim_config

JOINTS = ("shoulder_rotation", "elbow_flexion")
RATE_HZ = 30
TIMESCALE = 20  # ticks
LAMBDA = 0.95
SECONDS = 300
AFTER = 5 * TIMESCALE  # ticks that only the ideal of earlier ones asks for
SEEDS = (1, 2)
DEFAULT, DEFAULT_STEP = "true_online", 0.3
ALGORITHMS = ("true_online", "td", "td_replacing", "tidbd", "autostep", "swifttd")
STEPS = (0.01, 0.03, 0.1, 0.2, 0.3, 0.5, 1.0)
NEAR = 1.1
"""Times the least error found: what a default may have that needs no tuning."""

_FARTHEST = 10.0  # rad: errors beyond are counted as this, so that one that diverged can be drawn at all

Series = NDArray[np.float64]
"""Rad, shape (ticks, joints) or (ticks,)."""


@dataclass(frozen=True, slots=True)
class Tour:
    """What one wearer did, as learners see it."""

    phi: Series  # of the features that are ever active, shape (ticks, features)
    active: float  # the nominal number of them at a time
    positions: Series
    initial: Sequence[float]  # the joints' minima, rad


@dataclass(frozen=True, slots=True)
class Score:
    """Root mean square of prediction minus ideal, rad; the median over joints and wearers."""

    whole: float
    late: float  # of the second half
    span: tuple[float, float]  # of `late`, least to greatest


Scores: TypeAlias = Mapping[str, Mapping[float, Score]]
"""By algorithm and step size."""


async def driven(seed: int) -> Tour:
    """A wearer's day at the arm; `seed`: of their muscles' noise."""
    config = sim_config(PLAIN, ("seed = 1\n\n[[emg.sites]]", f"seed = {seed}\n\n[[emg.sites]]"))
    config = config.model_copy(update={"learn": None, "assist": None})
    seen: list[Table] = []
    with TemporaryDirectory() as folder:
        async with running(config, Path(folder, "bentod.sock")) as arm:
            async for frame in arm.subscribe_state(rate_hz=500):
                seen.append(frame)
                if len(seen) == SECONDS * RATE_HZ + AFTER:
                    break
    ticks = [number(frame, "tick") for frame in seen]
    assert ticks == [ticks[0] + place for place in range(len(ticks))], "a tick is missing"
    limits = {spec.name: (spec.min_rad, spec.max_rad) for spec in config.joints}
    positions = [[number(joint(frame, name), "position") for name in JOINTS] for frame in seen]
    return tour(np.array(positions), [limits[name] for name in JOINTS])


def tour(positions: Series, limits: Sequence[tuple[float, float]]) -> Tour:
    """Features that are never active are left out: no algorithm could learn anything with them."""
    representation = ArmFeatures(limits)
    phi = np.zeros((len(positions) - AFTER, representation.size))
    for row, now in zip(phi, positions.tolist(), strict=False):
        row[representation.features(now)] = 1
    return Tour(phi[:, phi.any(axis=0)], representation.active, positions, [low for low, _ in limits])


@cache
def tours() -> tuple[Tour, ...]:
    """What all algorithms learn from."""
    return tuple(clock.run(driven(seed)) for seed in SEEDS)


def squares(journey: Tour, place: int, algorithm: str, step_size: float) -> Series:
    """Squared errors of the predictions of one joint, tick by tick."""
    gamma = discount(TIMESCALE)
    start = journey.initial[place] / journey.active
    settings = LearnerSettings(journey.phi.shape[1], journey.active, step_size, start, {})
    learner = registry.open_learner(algorithm)(settings)
    positions = journey.positions[:, place]
    ideal = ideal_predictions(positions, TIMESCALE)
    answers = [
        learner.step(phi, Arrival((1 - gamma) * position, gamma, LAMBDA))
        for phi, position in zip(journey.phi, positions.tolist(), strict=False)
    ]
    missed: Series = np.minimum(np.abs(np.array(answers) - ideal[: len(answers)]), _FARTHEST) ** 2
    return missed


def score(algorithm: str, step_size: float) -> Score:
    """Over all joints of all tours."""
    runs = [squares(it, place, algorithm, step_size) for it in tours() for place in range(len(JOINTS))]
    whole = [math.sqrt(run.mean()) for run in runs]
    late = [math.sqrt(run[len(run) // 2 :].mean()) for run in runs]
    return Score(float(np.median(whole)), float(np.median(late)), (min(late), max(late)))


def rows() -> Iterator[Row]:
    """About two minutes of computing."""
    scores = {name: {step: score(name, step) for step in STEPS} for name in ALGORITHMS}
    for name, found in scores.items():
        best = min(found, key=lambda step: found[step].late)
        yield Row(f"{name}: RMSE, second half, step size {best:g} (its best)", found[best].late, "rad")
        yield Row("  the same, whole", found[best].whole, "rad")
        yield Row(f"  second half, step size {DEFAULT_STEP:g}", found[DEFAULT_STEP].late, "rad")
        yield Row("  worst of the sweep over its best", _spread(found), "")
    yield verdict(scores, "second half", lambda it: it.late)
    yield verdict(scores, "whole", lambda it: it.whole)
    least = min(it.late for found in scores.values() for it in found.values())
    own = min(it.late for it in scores[DEFAULT].values())
    yield at_most(f"{DEFAULT} at its best step size over the best: RMSE, second half", own / least, "", NEAR)
    yield Row('  RMSE of "it stays where it is", second half', _stays(), "rad")
    draw(scores)


def verdict(scores: Scores, part: str, error: Callable[[Score], float]) -> Row:
    """Whether the default is about as good as the best of all that were tried."""
    tried = {(name, step): error(it) for name, found in scores.items() for step, it in found.items()}
    name, step = min(tried, key=lambda it: tried[it])
    what = f"{DEFAULT} at {DEFAULT_STEP:g} over the best, {name} at {step:g}: RMSE, {part}"
    return at_most(what, tried[DEFAULT, DEFAULT_STEP] / tried[name, step], "", NEAR)


def draw(scores: Scores) -> None:
    """Error against step size, each algorithm a line, all joints and wearers within its band."""
    figure = Figure(figsize=(7.2, 4.2))
    axes = figure.subplots()
    for name, found in scores.items():
        (line,) = axes.plot(STEPS, [found[step].late for step in STEPS], marker="o", label=name)
        spans = np.array([found[step].span for step in STEPS])
        axes.fill_between(STEPS, spans[:, 0], spans[:, 1], color=line.get_color(), alpha=0.1, linewidth=0)
    axes.axhline(_stays(), color="grey", linestyle=":", label="it stays where it is")
    axes.set(
        xscale="log", yscale="log", xlabel="step size, α times active features (the first, if it adapts)"
    )
    axes.set_ylabel(f"RMSE {TIMESCALE} ticks ahead, second half (rad)")
    axes.legend(frameon=False)
    BUILD.mkdir(parents=True, exist_ok=True)
    figure.savefig(BUILD / "learn_quality.png", dpi=160, bbox_inches="tight")


def _spread(found: Mapping[float, Score]) -> float:
    late = [it.late for it in found.values()]
    return max(late) / min(late)


def _stays() -> float:
    late = []
    for it in tours():
        ideal = ideal_predictions(it.positions, TIMESCALE)
        half = slice(len(it.phi) // 2, len(it.phi))
        late += np.sqrt(((it.positions - ideal)[half] ** 2).mean(axis=0)).tolist()
    return float(np.median(late))


if __name__ == "__main__":
    main("learn_quality", rows())
