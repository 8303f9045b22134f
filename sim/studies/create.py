"""A small mobile robot with two wheels, four cliff sensors and a wall sensor: as an iRobot Create.

Where the cliff sensors sit and how far the wheels stand apart is what the description of the Create 1 in
AutonomyLab/create_robot says (create_description/urdf, BSD), and signals go from 0 to 4095, as the maker's
"Create Open Interface" has it for packets 27 to 31. Sensitivities, noise, the size of the spot that a sensor
sees and slip are guesses.
"""

import math
from dataclasses import dataclass

import numpy as np

from sim.studies.floor import Floor

WHEELS_APART = 0.26  # m
SPOT = 0.012  # m, of the floor that a cliff sensor sees
FULL_SCALE = 4095
DARK = 40.0
"""Counts of a cliff sensor over nothing that reflects."""
WALL_NEAR = 0.05
"""m, at which the wall sensor's signal is full; it falls with the square of the distance."""
SLIP = 0.02
"""Standard deviation of how much further or less far the robot turns than its wheels ask, as a share."""
SLIP_LASTS = 1.0  # s


@dataclass(frozen=True, slots=True)
class CliffSensor:
    """Looks down, from under the front edge."""

    name: str
    x: float  # m, forward of the middle
    y: float  # m, to the left of the middle
    sensitivity: float  # counts over a surface that reflects all
    noise: float  # counts, standard deviation

    @property
    def threshold(self) -> float:
        """Counts above which the floor is bright: half-way between blue tape and beige tiles."""
        return DARK + 0.5 * self.sensitivity


CLIFFS = (
    CliffSensor("left", 0.07, 0.14, 2600.0, 45.0),
    CliffSensor("front_left", 0.15, 0.04, 3100.0, 30.0),
    CliffSensor("front_right", 0.15, -0.04, 2900.0, 60.0),
    CliffSensor("right", 0.07, -0.14, 2300.0, 40.0),
)
WALL_X = 0.16  # m, forward of the middle; looks forward (thesis 4.5.1)
WALL_NOISE = 25.0  # counts, standard deviation
WALL_THRESHOLD = 700.0  # counts

NAMES = (*(cliff.name for cliff in CLIFFS), "wall")
THRESHOLDS = (*(cliff.threshold for cliff in CLIFFS), WALL_THRESHOLD)


class Create:
    """The robot, at the origin and looking along x. `left`, `right`: m/s, what its wheels are asked for."""

    def __init__(self, floor: Floor, rng: np.random.Generator) -> None:
        self._floor = floor
        self._rng = rng
        self._slip = 0.0
        self.x = self.y = self.heading = 0.0
        """m, m, rad."""
        self.left = self.right = 0.0

    @property
    def turning(self) -> float:
        """rad/s, counter-clockwise, if no wheel slips."""
        return (self.right - self.left) / WHEELS_APART

    def step(self, dt: float) -> None:
        """Let `dt` (s) pass: an arc around the point that both wheels turn about."""
        keep = math.exp(-dt / SLIP_LASTS)
        self._slip = keep * self._slip + SLIP * math.sqrt(1 - keep**2) * float(self._rng.standard_normal())
        turn = self.turning * (1 + self._slip) * dt
        way = (self.right + self.left) / 2 * dt
        chord = way * (math.sin(turn / 2) / (turn / 2) if turn else 1.0)
        self.x += chord * math.cos(self.heading + turn / 2)
        self.y += chord * math.sin(self.heading + turn / 2)
        self.heading += turn

    def sense(self) -> list[float]:
        """Counts, 0..4095, of the four cliff sensors from left to right and of the wall sensor."""
        noise = self._rng.standard_normal(len(NAMES)).tolist()
        cliffs = [self._cliff(cliff, z) for cliff, z in zip(CLIFFS, noise[:-1], strict=True)]
        return [*cliffs, self._wall(noise[-1])]

    def _cliff(self, cliff: CliffSensor, z: float) -> float:
        cos, sin = math.cos(self.heading), math.sin(self.heading)
        x = self.x + cliff.x * cos - cliff.y * sin
        y = self.y + cliff.x * sin + cliff.y * cos
        return _counts(DARK + cliff.sensitivity * self._floor.under(x, y, SPOT) + cliff.noise * z)

    def _wall(self, z: float) -> float:
        x = self.x + WALL_X * math.cos(self.heading)
        y = self.y + WALL_X * math.sin(self.heading)
        distance = max(self._floor.range(x, y, self.heading), WALL_NEAR)
        return _counts(FULL_SCALE * (WALL_NEAR / distance) ** 2 + WALL_NOISE * z)


def _counts(signal: float) -> float:
    return float(round(min(max(signal, 0.0), FULL_SCALE)))
