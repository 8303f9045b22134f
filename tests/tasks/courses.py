"""Small tasks for tests, and somebody who stands wherever they are put."""

from bentod.tasks.corridor import Corridor, Point
from bentod.tasks.engine import Engine, Happening
from bentod.tasks.places import Barrier, Spot
from bentod.tasks.task import Task

TICK = 1 / 30
ONE, TWO = (0.0, 0.0), (0.2, 0.3)
BOUNDS = ((-1.0, 1.0), (-1.0, 1.0))
BETWEEN = (0.1, 0.1)


def waypoints(restart: bool = False, dwell: float = 3.0) -> Task:
    """To 2 and back to 1, each to be held."""
    return Task(
        name="points",
        title="Points",
        joints=("shoulder", "elbow"),
        bounds=BOUNDS,
        places=(Spot("1", ONE, 0.02), Spot("2", TWO, 0.02)),
        order=(0, 1, 0),
        dwell=dwell,
        restart=restart,
        path="up_first",
        counts="held",
    )


def maze() -> Task:
    """Straight up from green to yellow, between walls at -0.1 and 0.1."""
    centre = ((0.0, 0.0), (0.0, 0.5))
    return Task(
        name="corridor",
        title="Corridor",
        joints=("shoulder", "elbow"),
        bounds=BOUNDS,
        places=(
            Barrier("green", centre[0], centre[1], 0.05, 0.01),
            Barrier("yellow", centre[1], centre[0], 0.05, 0.01),
        ),
        order=(0, 1, 0),
        dwell=1.0,
        restart=False,
        path="any",
        counts="entered",
        corridor=Corridor(centre, 0.1),
        bounce=0.3,
    )


class Somebody:
    """Puts the arm somewhere and lets time pass."""

    def __init__(self, task: Task, begun: bool = True) -> None:
        self.engine = Engine(task)
        self.time = 0.0
        if begun:
            self.engine.begin(0.0)

    def stay(self, position: Point, seconds: float = TICK, paused: bool = False) -> list[Happening]:
        """What happened meanwhile."""
        found: list[Happening] = []
        for _ in range(round(seconds / TICK)):
            found += self.engine.step(self.time, position, paused)
            self.time += TICK
        return found

    def kinds(self, position: Point, seconds: float = TICK, paused: bool = False) -> list[str]:
        """The same as words."""
        return [happening.kind for happening in self.stay(position, seconds, paused)]
