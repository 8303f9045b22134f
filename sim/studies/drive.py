"""Twenty minutes of a robot that turns on the spot, as thesis 4.5.1 recorded them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bentod.contracts import Vector
from sim.studies.create import NAMES, THRESHOLDS, Create
from sim.studies.floor import Floor
from sim.studies.study import RATE_HZ

SPEED_LASTS_S = 120
SLOWEST, FASTEST = 0.06, 0.15
"""m/s, of the wheels: half a radian to a little over one radian a second. The thesis does not say."""


@dataclass(frozen=True, slots=True)
class Drive:
    """What was recorded."""

    time: Vector  # s, shape (steps,)
    signals: NDArray[np.float64]  # counts of the sensors in the order of NAMES, shape (steps, 5)
    speed: Vector  # rad/s that was asked for, shape (steps,)

    @property
    def binary(self) -> NDArray[np.float64]:
        """1 where a signal is above its sensor's threshold, else 0; shape (steps, 5)."""
        return (self.signals > np.array(THRESHOLDS)).astype(np.float64)

    def seen(self, name: str) -> Vector:
        """The binary signal of one sensor, shape (steps,)."""
        column: Vector = self.binary[:, NAMES.index(name)]
        return column


def drive(floor: Floor, seed: int, minutes: float) -> Drive:
    """Turn counter-clockwise, at another speed every two minutes."""
    rng = np.random.default_rng(seed)
    robot = Create(floor, rng)
    steps = round(minutes * 60 * RATE_HZ)
    signals, speed = np.empty((steps, len(NAMES))), np.empty(steps)
    for step in range(steps):
        if step % (SPEED_LASTS_S * RATE_HZ) == 0:
            robot.right = float(rng.uniform(SLOWEST, FASTEST))
            robot.left = -robot.right
        robot.step(1 / RATE_HZ)
        signals[step] = robot.sense()
        speed[step] = robot.turning
    return Drive(np.arange(steps) / RATE_HZ, signals, speed)
