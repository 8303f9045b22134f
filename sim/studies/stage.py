"""What happens at each tick's end: the task learns where the arm is, the operator what there is to see."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import dist
from typing import Literal, Protocol

from bentod.control.leases import Holder
from bentod.desk import Desk
from bentod.frames import Event, Frame, Mode
from bentod.inbox import Inbox
from bentod.learn.confidence.visits import Visit
from sim.people.operator import Operator
from sim.people.scene import Act, Course, Point, View
from sim.studies.session_config import GROUP, SPEED

PATIENCE = 240.0
"""s after which a circuit is given up, and the session with it."""

LEASE = 0.2
"""s, as a joystick's client asks for it."""

HOLDER = Holder(1, "joystick")

Condition = Literal["solo", "assisted"]


class Task(Course, Protocol):
    """A task: what it is, and how far the operator has come in it."""

    name: str
    leg: int
    resting: bool
    touching: bool
    pressing: bool
    contacts: int

    @property
    def start(self) -> Point:
        """Where the arm is at the beginning (rad)."""
        ...

    @property
    def limits(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Bounds of the workspace by joint (rad)."""
        ...

    def step(self, time: float, position: Point) -> bool:
        """Take in where the arm is at `time` (s); whether a circuit ends with that."""
        ...

    def resume(self) -> None:
        """Go on after a break between two circuits: a rest at the start begins with the next step."""
        ...


@dataclass(frozen=True, slots=True)
class Circuits:
    """How many circuits of each kind, in this order."""

    solo: int = 20
    assisted: int = 20


TABLE_B1 = Circuits()
"""Appendix B."""


@dataclass(frozen=True, slots=True)
class CircuitResult:
    """One circuit, from one start of its first leg to the next."""

    number: int  # from 1 within its condition
    condition: Condition
    time: float  # s
    toggles: int
    contacts: int
    distance: float  # rad in the plane of the two joints
    whole: bool = True  # False: it was given up
    trust: float = 0.0  # 0..1, the operator's at its end


Watch = Callable[[Frame, Task, Act, Visit | None], None]
"""Told of every tick of the task, e.g. to keep it for a figure; the last is how well its state was known."""


class Stage:
    """Where an operator, a task and an arm meet."""

    def __init__(
        self,
        operator: Operator,
        task: Task,
        circuits: Circuits,
        mode: str,
        inbox: Inbox,
        watch: Watch | None = None,
        toggles: int = 0,
    ) -> None:
        """`mode`: of the assist, once the solo circuits are done. `toggles`: those of earlier sessions."""
        self.results: list[CircuitResult] = []
        self.over = False
        self.act = Act()
        """What the operator does now, for whoever measures muscles."""
        self.operator = operator
        self.task = task
        self.toggles = self._toggles_before = toggles
        self.position: Point | None = None
        self.active = ""
        self._circuits = circuits
        self._mode = mode
        self.inbox = inbox
        self._watch = watch
        self._contacts_before = 0
        self._way = 0.0
        self._began: float | None = None
        self.asks: Callable[[Act], None] = self._ask
        self.visit: Callable[[], Visit | None] = lambda: None

    def publish(self, frame: Frame, events: Sequence[Event], whole: bool) -> None:
        """A tick is over: `Publish` of the controller."""
        if frame.mode is not Mode.ACTIVE or self.over:
            return
        position = (frame.joints[0].position, frame.joints[1].position)
        self._count(frame, position)
        if self._began is None:
            self._begin(frame.time)
        ended = self.task.step(frame.time, position)
        if ended or frame.time - (self._began or 0.0) > PATIENCE:
            self._end(frame.time, ended)
        if not self.over:
            self.act = self.operator.step(self._view(frame, position), self.task)
            self.asks(self.act)
        if self._watch:
            self._watch(frame, self.task, self.act, self.visit())

    @property
    def condition(self) -> Condition:
        """Of the circuit under way."""
        return "solo" if len(self.results) < self._circuits.solo else "assisted"

    def _count(self, frame: Frame, position: Point) -> None:
        group = next(group for group in frame.groups if group.name == GROUP)
        if self.active and group.active != self.active:
            self.toggles += 1
        self.active = group.active
        if self.position is not None:
            self._way += dist(position, self.position)
        self.position = position

    def _view(self, frame: Frame, position: Point) -> View:
        active = 0 if self.active == frame.joints[0].name else 1
        task = self.task
        return View(
            time=frame.time,
            position=position,
            active=active,
            toggles=self.toggles,
            resting=task.resting,
            touching=task.touching,
            leg=task.leg,
            assisted=self.condition == "assisted",
            pressing=task.pressing,
        )

    def _begin(self, time: float) -> None:
        self._began, self._way = time, 0.0
        self._toggles_before, self._contacts_before = self.toggles, self.task.contacts
        if self.condition == "assisted" and len(self.results) == self._circuits.solo:
            mode = self._mode
            self.inbox.post(lambda desk: desk.change_assist({"mode": mode}))

    def _end(self, time: float, whole: bool) -> None:
        assisted = self.condition == "assisted"
        number = len(self.results) - (self._circuits.solo if assisted else 0) + 1
        self.operator.circuit_done(assisted)
        self.results.append(
            CircuitResult(
                number=number,
                condition=self.condition,
                time=time - (self._began or 0.0),
                toggles=self.toggles - self._toggles_before,
                contacts=self.task.contacts - self._contacts_before,
                distance=self._way,
                whole=whole,
                trust=self.operator.trust.trust,
            )
        )
        self.over = not whole or len(self.results) >= self._circuits.solo + self._circuits.assisted
        if not self.over:
            self._begin(time)

    def _ask(self, act: Act) -> None:
        """As the client of a joystick does: one request a tick, on the seam before the next."""
        self.inbox.post(lambda desk: _obey(desk, act))


def _obey(desk: Desk, act: Act) -> None:
    if act.toggle:
        desk.toggle(GROUP, 1, HOLDER.client)
    top = desk.specs[desk.groups.group(GROUP).active].max_velocity
    desk.group_command(GROUP, act.effort * SPEED / top, HOLDER, LEASE)
