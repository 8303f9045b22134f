"""How somebody gets on with a task: what happens at each step, and what each circuit took.

The clock of a circuit never stands still, because that of a recording's analysis does not either. Time in
which the arm was paused or not seen is counted beside it, so that nobody takes such a circuit for a good one.
"""

from dataclasses import dataclass, field, replace
from math import dist, isfinite
from typing import Literal, TypeAlias

from bentod.tasks.corridor import Point
from bentod.tasks.places import Place
from bentod.tasks.task import Task

UNSEEN = 0.25
"""s between two steps, above which what happened meanwhile is not known."""

Kind: TypeAlias = Literal[
    "entered",
    "left",
    "returned",
    "held",
    "ready",
    "circuit",
    "contact",
    "clear",
    "paused",
    "resumed",
    "unseen",
]
"""What can happen; "ready": the start is reached, and the first circuit may begin."""

Phase: TypeAlias = Literal["approach", "ready", "running"]


@dataclass(frozen=True, slots=True)
class Happening:
    """Something that happened at a step; `place`: the name of where, empty elsewhere."""

    kind: Kind
    place: str = ""


@dataclass(frozen=True, slots=True)
class Lap:
    """One circuit, under way or done."""

    number: int  # from 1
    began: float  # monotonic s
    time: float = 0.0  # s since then
    legs: tuple[float, ...] = ()  # s from leaving to reaching each place, in their order
    length: float = 0.0  # rad, of the path in the plane of the two joints
    contacts: int = 0
    slips: int = 0  # how often a place was left before its time was over
    paused: float = 0.0  # s of `time` in which the arm was not free to move
    unseen: float = 0.0  # s of `time` in which nobody saw where it was


@dataclass(slots=True)
class Engine:
    """Somebody at a task. Steps come in the order of time, one for each frame."""

    task: Task
    phase: Phase = "approach"
    leg: int = -1  # of the circuit, from 0; -1: on the way to the start
    laps: list[Lap] = field(default_factory=list)  # those that are done
    inside: bool = False  # the place that is aimed at
    touching: bool = False  # a wall, or so shortly ago that it is the same contact
    paused: bool = False
    lap: Lap = field(default=Lap(0, 0.0))
    _until: float | None = None
    _left: float = 0.0
    _touched: float = 0.0
    _time: float | None = None
    _position: Point | None = None

    @property
    def target(self) -> Place:
        """The place that is aimed at, or held."""
        return self.task.places[self.task.order[self.leg + 1]]

    @property
    def resting(self) -> bool:
        """Whether the target was reached and its time is not over."""
        return self._until is not None

    @property
    def held(self) -> float:
        """Which share of the time at the target is over, 0..1."""
        if self._until is None or self._time is None:
            return 0.0
        left = max(0.0, self._until - self._time)
        return 1.0 - min(1.0, left / self.task.dwell) if left else 1.0

    @property
    def contacts(self) -> int:
        """Since the first circuit began."""
        return sum(lap.contacts for lap in self.laps) + self.lap.contacts

    def begin(self, time: float) -> None:
        """The first circuit begins, at `time` (monotonic s)."""
        self.phase, self.lap, self._left = "running", Lap(1, time), time
        if self.task.counts == "entered":
            self._until = time + self.task.dwell
        else:
            self.leg, self.inside = 0, False

    def step(self, time: float, position: Point, paused: bool = False) -> list[Happening]:
        """Take in where the arm is (rad) at `time` (monotonic s), and whether it is not free to move.

        A position that is no number, or a time that is not after the last one, is as good as no step.
        """
        since = 0.0 if self._time is None else time - self._time
        if since < 0 or not all(map(isfinite, (time, *position))):
            return []
        found = self._account(since, position, paused)
        self._time, self._position = time, position
        found += self._feel(time, position)
        if self.phase != "ready":
            found += self._stand(time, position)
        self.lap = replace(self.lap, time=max(0.0, time - self.lap.began))
        return found

    def _account(self, since: float, position: Point, paused: bool) -> list[Happening]:
        """Count way and time, and how much of it means nothing."""
        found: list[Happening] = []
        was, lap = self.paused, self.lap
        way = dist(position, self._position) if self._position else 0.0
        unseen = since if since > UNSEEN else 0.0
        self.lap = replace(
            lap,
            length=lap.length + way,
            paused=lap.paused + (since if was and not unseen else 0.0),
            unseen=lap.unseen + unseen,
        )
        self.paused = paused
        if unseen:
            found.append(Happening("unseen"))
        if paused is not was:
            found.append(Happening("paused" if paused else "resumed"))
        return found

    def _feel(self, time: float, position: Point) -> list[Happening]:
        """Walls: a touch that bounces is one contact, and a later one another."""
        found: list[Happening] = []
        if self.touching and time - self._touched > self.task.bounce:
            self.touching = False
            found.append(Happening("clear"))
        if self.task.clearance(position) <= 0.0:
            if not self.touching:
                self.lap = replace(self.lap, contacts=self.lap.contacts + 1)
                found.append(Happening("contact"))
            self.touching, self._touched = True, time
        return found

    def _stand(self, time: float, position: Point) -> list[Happening]:
        """Places: reached, left too early, held for long enough."""
        was, self.inside = self.inside, self.target.holds(position)
        if self._until is None:
            return self._enter(time) if self.inside else []
        if time >= self._until and (self.inside or not self.task.restart):
            return self._hold(time)
        if was and not self.inside:
            return self._leave()
        return [self._here("returned")] if self.inside and not was else []

    def _enter(self, time: float) -> list[Happening]:
        self._until = time + self.task.dwell
        found = [self._here("entered")]
        legs = self.lap.legs[: self.leg]
        self.lap = replace(self.lap, time=time - self.lap.began, legs=(*legs, time - self._left))
        if self.task.counts == "entered":
            found += self._arrive(time)
        return found

    def _leave(self) -> list[Happening]:
        found = self._here("left")
        self.lap = replace(self.lap, slips=self.lap.slips + 1)
        if self.task.restart:
            self._until = None
        return [found]

    def _hold(self, time: float) -> list[Happening]:
        found = [self._here("held")]
        self._until, self._left = None, time
        if self.task.counts == "held":
            found += self._arrive(time)
        if self.phase == "running":
            self.leg, self.inside = self.leg + 1, False
        return found

    def _arrive(self, time: float) -> list[Happening]:
        """What the start, reached in the way that counts, means."""
        if self.phase == "approach":
            self.phase, self._until = "ready", None
            return [self._here("ready")]
        if self.leg < len(self.task.order) - 2:
            return []
        self.laps.append(replace(self.lap, time=time - self.lap.began))
        self.lap, self.leg = Lap(self.lap.number + 1, time), -1
        return [self._here("circuit")]

    def _here(self, kind: Kind) -> Happening:
        return Happening(kind, self.target.name)
