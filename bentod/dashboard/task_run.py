"""One run of a task: its trial on the daemon, and what each frame means for it."""

from collections.abc import Awaitable, Callable, Mapping
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

from bentod.errors import BentodError
from bentod.frames import Mode, Value
from bentod.tasks.corridor import Point
from bentod.tasks.engine import Engine, Happening, Lap
from bentod.tasks.task import Task

Ask: TypeAlias = Callable[[str, dict[str, Value]], Awaitable[Value]]
"""Asks the daemon: a method and its parameters. Raises BentodError: it refuses, or is not there."""

Later: TypeAlias = Callable[[Callable[[], Awaitable[None]]], bool]
"""Has something done after what was asked for before; False: it will not be done."""

BEGINS = "task"
"""The first mark of a trial whose circuits are marked by us, followed by the task's name."""

Phase: TypeAlias = Literal["approach", "starting", "running", "over"]


@dataclass(frozen=True, slots=True)
class Sight:
    """What one frame says of the two joints of a task."""

    time: float  # monotonic s
    position: Point  # rad
    free: bool  # both joints may move


@dataclass(slots=True)
class Run:
    """From the wish to do a task until its trial is over. `act`: asks for who began it, `look`: for us."""

    task: Task
    name: str  # of the trial
    condition: str
    act: Ask
    look: Ask
    later: Later
    trial: int = 0  # its number; 0: it has not begun
    why: str = ""  # it is over
    stopping: bool = False  # this page's server has asked for its end
    unmarked: int = 0  # marks that did not reach the daemon
    _starting: bool = False
    _begun: float | None = None  # monotonic s, the start of the trial
    engine: Engine = field(init=False)

    def __post_init__(self) -> None:
        """Nobody has come anywhere yet."""
        self.engine = Engine(self.task)

    @property
    def phase(self) -> Phase:
        """How far it is."""
        if self.why:
            return "over"
        if self._begun is not None:
            return "running"
        return "starting" if self._starting else "approach"

    def watch(self, frame: Mapping[str, Value]) -> None:
        """Take in a frame; marks are asked for, and nothing waits."""
        if self.why:
            return
        if self.trial:
            self._follow(frame.get("trial"))
        sight = seen(frame, self.task)
        if sight is None or self.why:
            return
        for happening in self.engine.step(sight.time, sight.position, not sight.free):
            self._happened(happening)

    def end(self, why: str) -> None:
        """It is over; the first reason stays."""
        self.why = self.why or why

    def _follow(self, trial: Value) -> None:
        """Begin with the trial, and end with it."""
        match trial:
            case {"number": self.trial, "started": float(started)} if self._begun in (None, started):
                if self._begun is None:
                    self._begun = started
                    self.engine.begin(started)
                    self._mark(f"{BEGINS} {self.task.name}")
            case _ if self._begun is not None:
                elsewhere = f"Trial {self.trial} is over: it was stopped elsewhere, or the daemon began anew."
                self.end("It was stopped." if self.stopping else elsewhere)

    def _happened(self, happening: Happening) -> None:
        if happening.kind == "ready" and not self._starting:
            self._starting = True
            if not self.later(self._start):
                self.end("The page's server has too much to do to begin a trial.")
        elif self._begun is not None:
            for mark in marks(happening):
                self._mark(mark)

    async def _start(self) -> None:
        if self.why:
            return
        try:
            answer = await self.act("trial_start", {"name": self.name, "condition": self.condition})
        except BentodError as error:
            self.end(f"The trial could not begin: {error}")
            return
        match answer:
            case {"trial": int(number)} if not self.why:
                self.trial = number
            case _:  # it was given up meanwhile
                await self.act("trial_stop", {})

    def _mark(self, mark: str) -> None:
        async def errand() -> None:
            try:
                await self.look("trial_mark", {"mark": mark})
            except BentodError:
                self.unmarked += 1
                raise

        if not self.later(errand):
            self.unmarked += 1


def seen(frame: Mapping[str, Value], task: Task) -> Sight | None:
    """What `frame` says of the joints of `task`; None if it does not say where they are."""
    rows = frame.get("joints")
    found = {row["name"]: row for row in rows if isinstance(row, dict)} if isinstance(rows, list) else {}
    match [frame.get("time"), frame.get("whole", True), *(found.get(name) for name in task.joints)]:
        case [
            float(time),
            True,
            {"position": float(x), "freshness": "fresh" | "stale", "mode": one},
            {"position": float(y), "freshness": "fresh" | "stale", "mode": two},
        ]:
            return Sight(time, (x, y), one == two == Mode.ACTIVE.value)
    return None


def marks(happening: Happening) -> tuple[str, ...]:
    """What to note in the trial. `bentod recording tasks` counts "circuit" and "contact"."""
    place = f"waypoint {happening.place}"
    match happening.kind:
        case "entered":
            return (place,)
        case "held" | "left" | "returned":
            return (f"{place} {happening.kind}",)
        case "clear":
            return ("clear of the wall",)
        case "ready":
            return ()
    return (happening.kind,)


def lap_table(lap: Lap) -> dict[str, Value]:
    """A circuit as the page gets it; s, rad."""
    return {
        "number": lap.number,
        "time": lap.time,
        "legs": list[Value](lap.legs),
        "length": lap.length,
        "contacts": lap.contacts,
        "slips": lap.slips,
        "paused": lap.paused,
        "unseen": lap.unseen,
    }
