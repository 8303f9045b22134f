"""How much sooner an arm predicts well that is advised by others (thesis 4.6.1), in simulation.

Two arms are used for some minutes by scripted wearers, with learning on; one moves slower than the other. A
third arm has other limits, is slower still, and its wearer's muscles have noise of their own. Nothing helps
anybody. The third learns alone, advised by one of the others, and advised by what the two know together; what
each would have predicted is compared with the ideal return. The wearers follow the same script: that makes
transfer easy, and says nothing about how alike people are.
"""

import math
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from bentod.config import Config
from bentod.config_learn import Learn
from bentod.config_tables import Record
from bentod.learn.merge import merge
from bentod.learn.returns import ideal_predictions
from bentod.learn.snapshot import read, taken, write
from bentod.record.reader import Recording
from bentod.replay.relearn import Relearner, Tick, ticks
from sim import clock
from tests.benchmarks.harness import Row, at_most, main
from tests.rig import PLAIN, running, sim_config

JOINTS = ("shoulder_rotation", "elbow_flexion")
TIMESCALE = 20  # ticks
RATE_HZ = 30
OLD_SECONDS, NEW_SECONDS = 180, 125
EARLY = 60  # s, what is compared
AFTER = 5 * TIMESCALE  # ticks that only the ideal of earlier ones asks for
SEEDS = (11, 12, 13)
LIMITS = ((-1.2, 1.2), (-0.3, 0.7))
"""rad, of the new arm's joints: as much as the old arms' is left out at each end."""

Table = Mapping[str, object]


def arm(seed: int, speed: float, limits: tuple[tuple[float, float], ...] = ()) -> Config:
    """A simulated arm whose joints go at `speed` of the usual; nobody helps."""
    config = sim_config(PLAIN, ("seed = 1\n\n[[emg.sites]]", f"seed = {seed}\n\n[[emg.sites]]"))
    joints = []
    for place, joint in enumerate(config.joints):
        changes: dict[str, object] = {"max_velocity_rad_s": joint.max_velocity_rad_s * speed}
        if place < len(limits):
            changes |= {"min_rad": limits[place][0], "max_rad": limits[place][1]}
        joints.append(joint.model_copy(update=changes))
    return config.model_copy(update={"joints": tuple(joints), "assist": None})


def learning(config: Config, **changes: object) -> Config:
    """The same arm, learning otherwise."""
    table = {"joints": JOINTS, "timescales": (float(TIMESCALE),), **changes}
    return config.model_copy(update={"learn": Learn.model_validate(table)})


def used(config: Config, seconds: float, folder: Path) -> list[Tick]:
    """All ticks of a session."""
    recorded = config.model_copy(update={"learn": None, "record": Record(folder=folder / "recordings")})

    async def session() -> None:
        async with running(recorded, folder / "bentod.sock") as client:
            async for frame in client.subscribe_state(rate_hz=1):
                if int(str(frame["tick"])) > seconds * RATE_HZ:
                    break

    clock.run(session())
    with Recording(folder / "recordings") as found:
        return list(ticks(found.entries()))


def known(config: Config, session: list[Tick], path: Path) -> Path:
    """A snapshot of what is learned from a session."""
    relearner = Relearner(learning(config))
    for tick in session:
        relearner.step(tick)
    assert relearner.learners
    write(path, taken(relearner.learners, config.arm, 0.0, session[-1].frame.tick))
    return path


def conditions(one: Path, both: Path) -> dict[str, Table]:
    """How the new arm may learn."""
    low, high = zip(*LIMITS, strict=True)
    advice = [
        f'norm(advice("old", "{joint}.position@{TIMESCALE}"), {low[i]}, {high[i]})'
        for i, joint in enumerate(JOINTS)
    ]
    angles = [f"norm({joint}.position)" for joint in JOINTS]
    traces = [f"trace({angle}, 0.99)" for angle in angles]
    tiles = [
        {"inputs": (*angles, *traces), "tilings": 100, "memory": 2048},
        {"inputs": advice, "tilings": 32, "width": 0.25, "memory": 1024},
    ]
    heard = {"representation": "heard", "representations": [{"name": "heard", "tiles": tiles}]}
    old, merged = ({"advisers": [{"name": "old", "snapshot": path}]} for path in (one, both))
    return {
        "alone": {},
        "guess of one": {**old, "adviser": "old"},
        "guess of two merged": {**merged, "adviser": "old"},
        "advice of one as input": {**old, **heard},
        "advice of two merged as input": {**merged, **heard},
        "one adviser, nothing learned here": {**old, "adviser": "old", "step_size": 1e-12},
    }


def errors(config: Config, session: list[Tick], **learn: object) -> tuple[float, float]:
    """RMSE over both joints (rad): of the first `EARLY` s, and of what comes after."""
    relearner = Relearner(learning(config, **learn))
    frames = [relearner.step(tick) for tick in session]
    places = [[joint.name for joint in frames[0].joints].index(name) for name in JOINTS]
    positions = np.array([[frame.joints[place].position for place in places] for frame in frames])
    told = np.array([[frame.joints[p].predictions[f"{TIMESCALE}"] for p in places] for frame in frames])
    missed = (told - ideal_predictions(positions, TIMESCALE))[: len(frames) - AFTER]
    return _rms(missed[: EARLY * RATE_HZ]), _rms(missed[EARLY * RATE_HZ :])


def _rms(missed: NDArray[np.float64]) -> float:
    return math.sqrt(float((missed**2).mean()))


def rows() -> Iterator[Row]:
    """Some minutes of computing."""
    with tempfile.TemporaryDirectory() as name:
        found = {how: np.array(each) for how, each in _tried(Path(name)).items()}
    alone = found["alone"]
    for how, each in found.items():
        yield Row(f"{how}: RMSE, first {EARLY} s", float(each[:, 0].mean()), "rad")
        yield Row("  the same, afterwards", float(each[:, 1].mean()), "rad")
    for how, each in found.items():
        if how == "alone":
            continue
        early, late = (float((each[:, part] / alone[:, part]).max()) for part in (0, 1))
        bound = 1.0 if "input" in how else 0.8
        if "nothing" in how:
            yield Row(f"{how} over alone, first {EARLY} s, worst of {len(SEEDS)}", early, "")
            continue
        yield at_most(f"{how} over alone, first {EARLY} s, worst of {len(SEEDS)}", early, "", bound)
        yield at_most("  the same, afterwards", late, "", 1.05)


def _tried(folder: Path) -> dict[str, list[tuple[float, float]]]:
    paths = []
    for number, speed in enumerate((1.0, 0.9)):
        (place := folder / f"old{number}").mkdir()
        config = arm(number + 1, speed)
        paths.append(known(config, used(config, OLD_SECONDS, place), place / "old.snapshot"))
    both = folder / "both.snapshot"
    write(both, merge([read(path) for path in paths], [1.0, 1.0], [str(path) for path in paths]))
    tried: dict[str, list[tuple[float, float]]] = {}
    for seed in SEEDS:
        (place := folder / f"new{seed}").mkdir()
        config = arm(seed, 0.8, LIMITS)
        session = used(config, NEW_SECONDS, place)
        for how, learn in conditions(paths[0], both).items():
            tried.setdefault(how, []).append(errors(config, session, **learn))
    return tried


if __name__ == "__main__":
    main("transfer", rows())
