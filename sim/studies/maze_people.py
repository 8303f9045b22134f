"""A population at the maze: each operator alone once, and then with every assist from the same moment on."""

from collections.abc import Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from copy import deepcopy
from dataclasses import dataclass, field, replace
from multiprocessing import get_context

from bentod.contracts_assist import OpenAssist
from bentod.errors import BadRequest, nearest
from sim.people.operator import Operator
from sim.people.scene import Point
from sim.people.traits import Traits
from sim.studies.ablations import oracle, shuffled
from sim.studies.maze import Maze
from sim.studies.session import Ending, OpenStudied, Setup, begin, go_on
from sim.studies.session_config import OURS, SPEED, Help
from sim.studies.stage import CircuitResult, Circuits, Task
from sim.studies.track import Track, Tracker

TIMESCALES = (10.0, 15.0, 20.0)
"""Ticks, of appendix B and of 5.5."""

AHEAD = 0.04
"""rad on the centre line that the assist who knows the maze looks ahead."""


@dataclass(frozen=True, slots=True)
class Way:
    """One way to be helped."""

    help: Help
    learns: bool = True


WAYS: Mapping[str, Way] = {
    **{f"thesis {timescale:g}": Way(Help(timescale)) for timescale in TIMESCALES},
    "confident": Way(OURS),
    "frozen": Way(Help(10.0), learns=False),
    "shuffled": Way(Help(10.0, mode="shuffled")),
    "oracle": Way(Help(10.0, mode="oracle")),
}
"""By name. The first three are the thesis', the last three show what these owe to their predictions."""

TOLD: Mapping[str, str] = {
    "thesis": "DPCC as in the thesis, at 10, 15 and 20 steps",
    "confident": "dpcc_confident as it comes",
    "frozen": "the thesis' at 10 steps, whose learners stop learning when it is switched on",
    "shuffled": "the thesis' at 10 steps, which follows predictions made at another moment",
    "oracle": "an assist that knows the maze, as an upper bound",
}


def chosen(modes: Sequence[str]) -> tuple[str, ...]:
    """Names of ways, in the order of `WAYS`; "thesis" stands for three. Raises BadRequest: there is none."""
    for mode in modes:
        if mode not in TOLD and mode not in WAYS:
            raise BadRequest(f"there is no assist '{mode}'{nearest(mode, [*TOLD, *WAYS])}", "modes")
    return tuple(name for name in WAYS if name in modes or name.split()[0] in modes)


@dataclass(frozen=True, slots=True)
class Order:
    """What one operator is to do."""

    traits: Traits
    seed: int
    ways: tuple[str, ...]
    solo: int = 20
    assisted: int = 20
    changed: int = 0  # circuits in the mirrored maze after that
    tracked: bool = True  # whether every tick is kept


@dataclass(frozen=True, slots=True)
class Helped:
    """What came of one way to be helped."""

    results: list[CircuitResult]
    changed: list[CircuitResult] = field(default_factory=list)
    rmse: Sequence[float] = ()  # of predictions against the ideal, rad, by joint
    track: Track | None = None


@dataclass(frozen=True, slots=True)
class Person:
    """All that one operator did."""

    name: str
    solo: list[CircuitResult]
    helped: Mapping[str, Helped]
    track: Track | None = None  # of the solo circuits

    def circuits(self, way: str) -> list[CircuitResult]:
        """Solo and assisted."""
        return [*self.solo, *self.helped[way].results]


def play(order: Order) -> Person:
    """One operator, from the first circuit to the last. Raises BentodError: the arm failed."""
    learned = tuple(sorted({WAYS[name].help.timescale for name in order.ways})) or TIMESCALES[:1]
    setup = Setup(Help(learned[0], mode="off", learned=learned), order.seed)
    operator = Operator(order.traits, order.seed, SPEED)
    tracker = Tracker(learned[0])
    alone = begin(operator, Maze(both=order.changed > 0), Circuits(order.solo, 0), setup, tracker)
    helped = {name: _helped(order, name, alone.ending) for name in order.ways}
    return Person(order.traits.name, alone.results, helped, tracker.track if order.tracked else None)


def everybody(orders: Sequence[Order], jobs: int = 1) -> list[Person]:
    """All operators, in `jobs` processes at once, with the same outcome for any number of them."""
    if jobs <= 1 or len(orders) <= 1:
        return [play(order) for order in orders]
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        return list(pool.map(play, orders))


def _helped(order: Order, name: str, alone: Ending) -> Helped:
    way, tracker = WAYS[name], Tracker(WAYS[name].help.timescale)
    setup = Setup(way.help, order.seed, assists=_assists(order.seed), learns=way.learns)
    played = go_on(alone, Circuits(0, order.assisted), setup, tracker)
    changed = go_on(_mirrored(played.ending), Circuits(0, order.changed), setup) if order.changed else None
    track = tracker.track
    return Helped(
        played.results, changed.results if changed else [], track.rmse(), track if order.tracked else None
    )


def _assists(seed: int) -> Mapping[str, OpenStudied]:
    return {"shuffled": lambda _: shuffled(seed), "oracle": _oracle}


def _oracle(task: Task) -> OpenAssist:
    def guide(position: Point) -> Point:
        return task.ahead(position, AHEAD) if isinstance(task, Maze) else position

    return oracle(guide)


def _mirrored(ending: Ending) -> Ending:
    """The maze's other diagonal, from the green barrier on, which stays where it is."""
    task = deepcopy(ending.task)
    if isinstance(task, Maze):
        task.mirrored = not task.mirrored
    return replace(ending, task=task)
