"""How fast the prediction of the joints that the wearer drives becomes good, from lap to lap.

The whole daemon in virtual time. The synthetic wearer goes round their circuit, the arm follows the muscles,
the horde learns. Its answer at each tick is compared with what a perfect learner would have said, the
discounted sum of what the joints did afterwards.
"""

from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray

from bentod.config import Config
from bentod.learn.returns import ideal_predictions
from sim import clock
from sim.emg_wearer import CIRCUIT
from tests.benchmarks.harness import Row, at_least, main
from tests.rig import Table, joint, number, running, sim_config, table

JOINTS = ("shoulder_rotation", "elbow_flexion")
"""The group that the wearer drives; the other joints stand still, and would flatter the error."""

TIMESCALE = 20  # ticks
LAP = round(sum(step.seconds for step in CIRCUIT) * 30)  # ticks
LAPS = 10
AFTER = 5 * TIMESCALE  # ticks beyond the last lap that its ideal still asks for: what is cut off weighs 0.6 %

Series = NDArray[np.float64]
"""Rad, shape (ticks, joints)."""


async def recorded(config: Config) -> tuple[Series, Series]:
    """Positions and predictions of every tick, from the first one of an active arm on."""
    seen: list[Table] = []
    with TemporaryDirectory() as folder:
        async with running(config, Path(folder, "bentod.sock")) as arm:
            async for frame in arm.subscribe_state(rate_hz=500):
                seen.append(frame)
                if len(seen) == LAPS * LAP + AFTER:
                    break
    ticks = [number(frame, "tick") for frame in seen]
    assert ticks == [ticks[0] + place for place in range(len(ticks))], "a tick is missing"
    joints = [[joint(frame, name) for name in JOINTS] for frame in seen]
    positions = [[number(found, "position") for found in row] for row in joints]
    predictions = [[number(table(found["predictions"]), f"{TIMESCALE}") for found in row] for row in joints]
    return np.array(positions), np.array(predictions)


def errors(predictions: Series, positions: Series) -> list[float]:
    """Root mean square of prediction minus ideal over both joints (rad), lap by lap."""
    missed = predictions - ideal_predictions(positions, TIMESCALE)
    laps = missed[: LAPS * LAP].reshape(LAPS, -1)
    found: list[float] = np.sqrt((laps**2).mean(axis=1)).tolist()
    return found


def rows() -> Iterator[Row]:
    """About 15 s."""
    for name, mode in (("assist off", "off"), ("assist on", "dpcc")):
        config = sim_config(('mode = "dpcc"', f'mode = "{mode}"'))
        positions, predictions = clock.run(recorded(config))
        learned, stays = errors(predictions, positions), errors(positions, positions)
        fall = (1 - learned[-1] / learned[0]) * 100
        yield at_least(f"{TIMESCALE}-step prediction, {name}: error falls, lap 1 to {LAPS}", fall, "%", 60)
        yield Row("  RMSE in lap 1, from the joint's minimum", learned[0], "rad")
        yield Row("  RMSE in lap 2", learned[1], "rad")
        yield Row(f"  RMSE in lap {LAPS}", learned[-1], "rad")
        yield Row(f'  RMSE in lap {LAPS} of "it stays where it is"', stays[-1], "rad")


if __name__ == "__main__":
    main("learning", rows())
