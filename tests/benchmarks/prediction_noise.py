"""How noisy predictions are (thesis 5.6.1): error against the ideal one, by what they are made from.

Simulated operators do the maze solo and then helped as in the thesis; every representation learns from the
same ticks. Then each is lived with: the assist follows it, and it learns from what it has led to itself. The
synthetic wearer of config/sim.toml goes round their rectangle besides. People who do not exist prove nothing
about people; they show what a representation can tell apart.
"""

import asyncio
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from bentod import registry
from bentod.config import Config
from bentod.config_file import parse
from bentod.config_learn import ARM
from bentod.config_tables import Record
from bentod.contracts import Vector
from bentod.learn.returns import ideal_predictions
from bentod.record.reader import Recording
from bentod.replay.relearn import Relearner, Tick, ticks
from sim.clock import run
from sim.people.traits import AUTHOR, NAIVE, Traits
from sim.studies.maze import Maze
from sim.studies.representations import SEEING, seeing
from sim.studies.session import run_session
from sim.studies.session_config import GROUP, Help, configured
from sim.studies.stage import Circuits
from tests.benchmarks.harness import Row, at_most, main
from tests.rig import PLAIN, running, sim_config

ELBOW = 1
OURS = "look_ahead"
TIMESCALE = 10.0  # ticks
PEOPLE = {"like the author": (AUTHOR, 1), "naive": (NAIVE, 2)}
CIRCUITS = Circuits(solo=10, assisted=10)
SECONDS = 240  # of the synthetic wearer
BOUND = 0.7

Errors = Mapping[str, NDArray[np.float64]]
"""Prediction less ideal (rad), shape (ticks,), by representation."""


@dataclass(frozen=True, slots=True)
class Lived:
    """A session: its ticks, and in which the assist was on."""

    ticks: Sequence[Tick]
    assisted: NDArray[np.bool_]

    @property
    def elbow(self) -> Vector:
        """rad, shape (ticks,)."""
        return np.array([tick.frame.joints[ELBOW].position for tick in self.ticks])


def lived(traits: Traits, seed: int, sees: str = ARM) -> Lived:
    """A session with the thesis' assist, that follows predictions made from what `sees` names."""
    seen: list[Tick] = []
    helping = Help(timescale=TIMESCALE, sees=sees)
    run_session(traits, Maze(), CIRCUITS, helping, seed, watch=lambda frame, *_: seen.append(Tick(frame, ())))
    assisted = np.array([tick.frame.assist.mode != "off" for tick in seen])
    return Lived(seen, assisted)


def errors(session: Lived, config: Config, key: str) -> Vector:
    """Of the elbow's prediction, by learners that see the session from its first tick on."""
    relearner = Relearner(config)
    told = [relearner.step(tick).joints[ELBOW].predictions.get(key, np.nan) for tick in session.ticks]
    return against_ideal(np.array(told), session.elbow)


def against_ideal(predictions: Vector, positions: Vector) -> Vector:
    """Without the end, whose future is not known."""
    known = len(positions) - round(5 * TIMESCALE)
    missed: Vector = (predictions - ideal_predictions(positions, TIMESCALE))[:known]
    return missed


def own_errors(session: Lived) -> Vector:
    """Of the predictions that were followed."""
    told = [tick.frame.joints[ELBOW].predictions.get(f"{TIMESCALE:g}", np.nan) for tick in session.ticks]
    return against_ideal(np.array(told), session.elbow)


def rms(missed: Vector, where: NDArray[np.bool_] | slice = slice(None)) -> float:
    """Root of the mean square, rad."""
    return float(np.sqrt(np.nanmean(missed[where] ** 2)))


def maze_config(sees: str) -> Config:
    """Of the sessions, if predictions are made from `sees`."""
    task = Maze()
    return configured(task.start, task.limits, Help(timescale=TIMESCALE, sees=sees), 0, "sim", "joystick")


def people() -> Iterator[Row]:
    """The same ticks for all representations, and then each with its own consequences."""
    ratios: dict[str, list[float]] = {name: [] for name in SEEING}
    lives: list[float] = []
    for who, (traits, seed) in PEOPLE.items():
        session = lived(traits, seed)
        found = {sees: errors(session, maze_config(sees), f"{TIMESCALE:g}") for sees in (ARM, *SEEING)}
        solo, helped = ~session.assisted[: len(found[ARM])], session.assisted[: len(found[ARM])]
        yield Row(f"{who}, helped circuits: RMSE, thesis' representation", rms(found[ARM], helped), "rad")
        for sees in SEEING:
            ratios[sees].append(rms(found[sees], helped) / rms(found[ARM], helped))
            yield Row(f"  {sees} over thesis', helped circuits", ratios[sees][-1], "")
            yield Row("    the same, solo circuits", rms(found[sees], solo) / rms(found[ARM], solo), "")
        followed = {
            sees: session if sees == ARM else lived(traits, seed, sees) for sees in (ARM, *SEEING[1:])
        }
        yield from consequences(followed)
        own = {sees: rms(own_errors(one), helped_of(one)) for sees, one in followed.items()}
        lives.append(own[OURS] / own[ARM])
    name = f"{OURS} over thesis', each followed by the assist: RMSE, helped circuits, mean of people"
    yield at_most(name, float(np.mean(lives)), "", BOUND)
    for sees in SEEING:
        mean = float(np.mean(ratios[sees]))
        name = f"{sees} over thesis': RMSE, helped circuits, mean of people"
        yield at_most(name, mean, "", BOUND) if sees == OURS else Row(name, mean, "")


def helped_of(session: Lived) -> NDArray[np.bool_]:
    """Ticks with help whose future is known."""
    return session.assisted[: len(own_errors(session))]


def consequences(followed: Mapping[str, Lived]) -> Iterator[Row]:
    """Whether learning from one's own help does harm: later half of the helped ticks over the earlier."""
    for sees, own in followed.items():
        missed, helped = own_errors(own), np.flatnonzero(helped_of(own))
        early, late = np.array_split(helped, 2)
        yield Row(f"  {sees}, followed by the assist: RMSE, helped circuits", rms(missed[helped]), "rad")
        yield Row("    later half of them over the earlier", rms(missed[late]) / rms(missed[early]), "")


def wearer() -> Iterator[Row]:
    """The rectangle of config/sim.toml, whose assist is on from the start."""
    with tempfile.TemporaryDirectory() as name:
        run(_recorded(Path(name)))
        with Recording(Path(name, "recordings")) as recording:
            config = parse(recording.header.config, "the recording", registry)
            seen = list(ticks(recording.entries()))
    missing = seen[-1].frame.tick - seen[0].frame.tick + 1 - len(seen)
    yield Row("synthetic wearer: ticks that were not recorded", missing, "", "<= 0", missing == 0)
    session = Lived(seen, np.ones(len(seen), dtype=np.bool_))
    later = slice(len(seen) // 4, None)
    thesis = rms(errors(session, config, f"{TIMESCALE:g}"), later)
    yield Row("synthetic wearer, after the first quarter: RMSE, thesis' representation", thesis, "rad")
    for sees in SEEING:
        found = rms(errors(session, _seeing(config, sees), f"{TIMESCALE:g}"), later)
        name = f"  {sees} over thesis'"
        yield at_most(name, found / thesis, "", BOUND) if sees == OURS else Row(name, found / thesis, "")


def _seeing(config: Config, sees: str) -> Config:
    assert config.learn is not None
    table = seeing(sees, config.learn.joints, GROUP, 0.537, 0.8)
    learn = config.learn.model_copy(update={"representation": sees, "representations": (table,)})
    return config.model_copy(update={"learn": learn})


async def _recorded(folder: Path) -> None:
    config = sim_config(PLAIN).model_copy(update={"record": Record(folder=folder / "recordings")})
    async with running(config, folder / "bentod.sock"):
        for _ in range(SECONDS):
            await asyncio.sleep(1)
            time.sleep(0.1)  # noqa: ASYNC251 -- the recorder's thread lives in real time, and would drop ticks


def rows() -> Iterator[Row]:
    """Some minutes of computing."""
    yield from people()
    yield from wearer()


if __name__ == "__main__":
    main("prediction_noise", rows())
