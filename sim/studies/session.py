"""A whole session in virtual time: an operator, a task, and the daemon's own controller between them."""

import asyncio
from collections.abc import Callable, Sequence
from contextlib import AsyncExitStack
from dataclasses import dataclass
from math import dist
from typing import Literal, Protocol

from bentod import registry
from bentod.config import Config
from bentod.contracts import ArmConfig, Clock
from bentod.control.leases import Holder
from bentod.desk import Desk
from bentod.emg.feed import Feed
from bentod.errors import BentodError
from bentod.frames import Event, Frame, Mode
from bentod.furnish import furnished
from bentod.inbox import Inbox
from bentod.start import Start
from bentod.tick import Controller
from sim.clock import VirtualClock, run
from sim.people.electrodes import Electrodes
from sim.people.operator import Operator
from sim.people.scene import Act, Course, Point, View
from sim.people.traits import Traits
from sim.studies.session_config import GROUP, MAZE_HELP, SPEED, Help, configured

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


Watch = Callable[[Frame, Task, Act], None]
"""Told of every tick of the task, e.g. to keep it for a figure."""


class Stage:
    """What happens at each tick's end: the task is told where the arm is, the operator what is to be seen."""

    def __init__(
        self,
        operator: Operator,
        task: Task,
        circuits: Circuits,
        help: Help,
        inbox: Inbox,
        watch: Watch | None = None,
    ) -> None:
        self.results: list[CircuitResult] = []
        self.over = False
        self.act = Act()
        """What the operator does now, for whoever measures muscles."""
        self._operator = operator
        self._task = task
        self._circuits = circuits
        self._help = help
        self._inbox = inbox
        self._watch = watch
        self._toggles = self._toggles_before = 0
        self._contacts_before = 0
        self._active: str | None = None
        self._way = 0.0
        self._position: Point | None = None
        self._began: float | None = None
        self.asks: Callable[[Act], None] = self._ask

    def publish(self, frame: Frame, events: Sequence[Event], whole: bool) -> None:
        """A tick is over: `Publish` of the controller."""
        if frame.mode is not Mode.ACTIVE or self.over:
            return
        position = (frame.joints[0].position, frame.joints[1].position)
        self._count(frame, position)
        if self._began is None:
            self._begin(frame.time)
        ended = self._task.step(frame.time, position)
        if ended or frame.time - (self._began or 0.0) > PATIENCE:
            self._end(frame.time, ended)
        if not self.over:
            self.act = self._operator.step(self._view(frame, position), self._task)
            self.asks(self.act)
        if self._watch:
            self._watch(frame, self._task, self.act)

    @property
    def condition(self) -> Condition:
        """Of the circuit under way."""
        return "solo" if len(self.results) < self._circuits.solo else "assisted"

    def _count(self, frame: Frame, position: Point) -> None:
        group = next(group for group in frame.groups if group.name == GROUP)
        if self._active is not None and group.active != self._active:
            self._toggles += 1
        self._active = group.active
        if self._position is not None:
            self._way += dist(position, self._position)
        self._position = position

    def _view(self, frame: Frame, position: Point) -> View:
        active = 0 if self._active == frame.joints[0].name else 1
        task = self._task
        assisted = self.condition == "assisted"
        return View(
            frame.time, position, active, self._toggles, task.resting, task.touching, task.leg, assisted
        )

    def _begin(self, time: float) -> None:
        self._began, self._way = time, 0.0
        self._toggles_before, self._contacts_before = self._toggles, self._task.contacts
        if self.condition == "assisted" and len(self.results) == self._circuits.solo:
            mode = self._help.mode
            self._inbox.post(lambda desk: desk.change_assist({"mode": mode}))

    def _end(self, time: float, whole: bool) -> None:
        assisted = self.condition == "assisted"
        number = len(self.results) - (self._circuits.solo if assisted else 0) + 1
        self._operator.circuit_done(assisted)
        self.results.append(
            CircuitResult(
                number=number,
                condition=self.condition,
                time=time - (self._began or 0.0),
                toggles=self._toggles - self._toggles_before,
                contacts=self._task.contacts - self._contacts_before,
                distance=self._way,
                whole=whole,
                trust=self._operator.trust.trust,
            )
        )
        self.over = not whole or len(self.results) >= self._circuits.solo + self._circuits.assisted
        if not self.over:
            self._begin(time)

    def _ask(self, act: Act) -> None:
        """As the client of a joystick does: one request a tick, on the seam before the next."""
        self._inbox.post(lambda desk: _obey(desk, act))


def _obey(desk: Desk, act: Act) -> None:
    if act.toggle:
        desk.toggle(GROUP, 1, HOLDER.client)
    top = desk.specs[desk.groups.group(GROUP).active].max_velocity
    desk.group_command(GROUP, act.effort * SPEED / top, HOLDER, LEASE)


def run_session(
    traits: Traits,
    task: Task,
    circuits: Circuits = TABLE_B1,
    help: Help = MAZE_HELP,
    seed: int = 0,
    driver: Literal["sim", "sim-dynamixel"] = "sim",
    through: Literal["joystick", "emg"] = "joystick",
    watch: Watch | None = None,
) -> list[CircuitResult]:
    """Let a simulated operator do `circuits` of `task`, solo and then assisted, with learning on throughout.

    Everything random comes from `seed`. A simulated operator checks the software and is no evidence about
    people.

    Raises:
        BentodError: the arm could not be started, or a fault stopped it.
    """
    config = configured(task.start, task.limits, help, seed, driver, through)
    operator = Operator(traits, seed, SPEED)
    inbox = Inbox()
    return run(_session(config, Stage(operator, task, circuits, help, inbox, watch), inbox))


async def _session(config: Config, stage: Stage, inbox: Inbox) -> list[CircuitResult]:
    clock = VirtualClock()
    async with AsyncExitStack() as stack:
        opened = registry.open_joints(config.shares()[0].driver.name)(_arm(config), clock)
        joints = await stack.enter_async_context(opened)
        feed = _feed(config, stage, clock)
        desk = furnished(config, joints.torque(), feed)
        controller = Controller(joints, desk, inbox, clock, config.rate_hz, stage.publish)
        async with asyncio.TaskGroup() as tasks:
            helpers = [tasks.create_task(Start(inbox, clock).run("active"))]
            if feed:
                helpers.append(tasks.create_task(feed.pump()))
            ended = await _play(controller, stage, desk, clock)
            for helper in helpers:
                helper.cancel()
    if ended:
        raise BentodError(f"the session ended early: {ended}")
    return stage.results


async def _play(controller: Controller, stage: Stage, desk: Desk, clock: Clock) -> str:
    """Tick until the session is over; returns why it ended early, empty if it did not."""
    begun = clock.now()
    while not stage.over:
        await controller.run(30)
        if desk.modes.fault or (desk.modes.arm is not Mode.ACTIVE and clock.now() > begun + 10):
            return desk.modes.fault or "the arm did not start"
    return ""


def _arm(config: Config) -> ArmConfig:
    share = config.shares()[0]
    specs = tuple(joint.spec() for joint in config.joints)
    return ArmConfig(specs, 1 / config.rate_hz, share.driver.options)


def _feed(config: Config, stage: Stage, clock: Clock) -> Feed | None:
    """The operator's muscles, if the config listens to any; then nothing goes through the inbox."""
    if config.emg is None:
        return None
    stage.asks = lambda act: None
    return Feed(Electrodes(lambda: stage.act, config.emg.rate_hz, clock, 1), config.emg.stall_s)
