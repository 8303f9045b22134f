"""What is kept of every tick of a session for figures and errors: one row a tick."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from bentod.contracts import Vector
from bentod.frames import Frame
from bentod.learn.confidence.visits import Visit
from bentod.learn.returns import discount, ideal_predictions
from sim.people.scene import Act
from sim.studies.stage import Task

COLUMNS = (
    *("time_s", "circuit", "leg", "resting"),
    *("shoulder_rad", "elbow_rad", "shoulder_predicted_rad", "elbow_predicted_rad"),
    *("active", "effort", "touching", "contacts", "visits", "least_visits"),
)
"""`active`: 0 for the shoulder, 1 for the elbow. `visits`, `least_visits`: of Fig. 5.12, in ticks."""


class Tracker:
    """A `Watch` that keeps everything of `COLUMNS`."""

    def __init__(self, timescale: float) -> None:
        """`timescale`: of the predictions that are kept, ticks."""
        self._key = f"{timescale:g}"
        self._rows: list[tuple[float, ...]] = []
        self._circuit = 0
        self._leg = 0

    def __call__(self, frame: Frame, task: Task, act: Act, visit: Visit | None) -> None:
        """As `Watch`."""
        self._circuit += task.leg == 0 and self._leg != 0
        self._leg = task.leg
        joints = frame.joints[:2]
        self._rows.append(
            (
                *(frame.time, self._circuit, task.leg, task.resting),
                *(joint.position for joint in joints),
                *(joint.predictions.get(self._key, np.nan) for joint in joints),
                *(frame.groups[0].active == joints[1].name, act.effort, task.touching, task.contacts),
                *((visit.total, visit.least) if visit else (np.nan, np.nan)),
            )
        )

    @property
    def track(self) -> "Track":
        """What was kept."""
        return Track(np.array(self._rows, dtype=np.float64).reshape(-1, len(COLUMNS)), float(self._key))


class Track:
    """All ticks of a session; columns by name."""

    def __init__(self, rows: NDArray[np.float64], timescale: float) -> None:
        """`rows`: shape (ticks, columns)."""
        self.rows = rows
        self.timescale = timescale

    def __getitem__(self, name: str) -> Vector:
        """A column, shape (ticks,)."""
        column: Vector = self.rows[:, COLUMNS.index(name)]
        return column

    def circuit(self, number: int) -> "Track":
        """One circuit of it, from 0."""
        return Track(self.rows[self["circuit"] == number], self.timescale)

    def positions(self) -> NDArray[np.float64]:
        """Shoulder and elbow, rad, shape (ticks, 2)."""
        return self.rows[:, 4:6]

    def predictions(self) -> NDArray[np.float64]:
        """Of shoulder and elbow, rad, shape (ticks, 2)."""
        return self.rows[:, 6:8]

    def ideal(self) -> NDArray[np.float64]:
        """What a perfect learner would have predicted, rad, shape (ticks, 2)."""
        return ideal_predictions(self.positions(), self.timescale)

    def errors(self) -> NDArray[np.float64]:
        """TD error of the predictions as they were made, rad, shape (ticks, 2); 0 in the first tick."""
        gamma, positions, predicted = discount(self.timescale), self.positions(), self.predictions()
        found = np.zeros_like(predicted)
        found[1:] = (1 - gamma) * positions[1:] + gamma * predicted[1:] - predicted[:-1]
        return found

    def rmse(self) -> Sequence[float]:
        """Of predictions against the ideal, by joint (rad); without the end, where that is not known."""
        end = max(1, len(self.rows) - round(5 * self.timescale))
        missed = (self.predictions() - self.ideal())[:end]
        return [float(np.sqrt(np.nanmean(column**2))) for column in missed.T]
