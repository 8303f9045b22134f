"""A whole session in virtual time: an operator, a task, and the daemon's own controller between them."""

import asyncio
from collections.abc import Callable, Mapping
from contextlib import AsyncExitStack
from copy import deepcopy
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from bentod import registry
from bentod.config import Config
from bentod.contracts import ArmConfig, Clock
from bentod.contracts_assist import OpenAssist
from bentod.control.groups import Groups
from bentod.desk import Desk
from bentod.emg.feed import Feed
from bentod.errors import BentodError
from bentod.frames import Mode, Value
from bentod.furnish import furnished
from bentod.inbox import Inbox
from bentod.start import Start
from bentod.tick import Controller
from sim.clock import VirtualClock, run
from sim.people.electrodes import Electrodes
from sim.people.operator import Operator
from sim.people.scene import Point
from sim.people.traits import Traits
from sim.studies.session_config import GROUP, MAZE_HELP, SPEED, Help, configured
from sim.studies.stage import TABLE_B1, CircuitResult, Circuits, Stage, Task, Watch
from sim.studies.studied import StudiedMind

OpenStudied: TypeAlias = Callable[[Task], OpenAssist]
"""A factory of an assist that only a study knows, and that may know the study's task."""


@dataclass(frozen=True, slots=True)
class Setup:
    """The arm's side of a session."""

    help: Help = MAZE_HELP
    seed: int = 0  # of the arm
    driver: Literal["sim", "sim-dynamixel"] = "sim"
    through: Literal["joystick", "emg"] = "joystick"
    assists: Mapping[str, OpenStudied] = field(default_factory=dict)  # by mode, besides the daemon's own
    learns: bool = True  # False: what was learned before is all that it knows


@dataclass(frozen=True, slots=True)
class Ending:
    """Where a session ended, for others to go on from; nobody may change what is in it."""

    operator: Operator
    task: Task
    time: float  # s
    position: Point  # rad
    active: str  # the joint
    toggles: int
    questions: Mapping[str, Value]  # that the learners were asked
    learned: Mapping[str, NDArray[np.float64]]


@dataclass(frozen=True, slots=True)
class Played:
    """A session that is over."""

    results: list[CircuitResult]
    ending: Ending


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
    people. Raises BentodError: the arm could not be started, or a fault stopped it.
    """
    setup = Setup(help, seed, driver, through)
    return begin(Operator(traits, seed, SPEED), task, circuits, setup, watch).results


def begin(
    operator: Operator, task: Task, circuits: Circuits, setup: Setup, watch: Watch | None = None
) -> Played:
    """The first session of an operator at a task. Raises BentodError: as `run_session`."""
    return run(_session(Stage(operator, task, circuits, setup.help.mode, Inbox(), watch), setup, None))


def go_on(before: Ending, circuits: Circuits, setup: Setup, watch: Watch | None = None) -> Played:
    """A session that goes on where another ended: people, arm and learners know what they knew then.

    Only the history traces of the learners begin anew, in the rest with which it begins. Raises BentodError:
    as `run_session`.
    """
    operator, task = deepcopy((before.operator, before.task))
    task.resume()
    stage = Stage(operator, task, circuits, setup.help.mode, Inbox(), watch, before.toggles)
    return run(_session(stage, setup, before))


async def _session(stage: Stage, setup: Setup, before: Ending | None) -> Played:
    clock, inbox = VirtualClock(), stage.inbox
    start = before.position if before else stage.task.start
    config = configured(start, stage.task.limits, setup.help, setup.seed, setup.driver, setup.through)
    if before:
        await clock.sleep_until(before.time)
    async with AsyncExitStack() as stack:
        opened = registry.open_joints(config.shares()[0].driver.name)(_arm(config), clock)
        joints = await stack.enter_async_context(opened)
        feed = _feed(config, stage, clock)
        mind = _mind(config, setup, stage.task, before)
        stage.visit = mind.visit
        desk = furnished(config, joints.torque(), feed, mind)
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
    return Played(stage.results, _ending(stage, mind, clock.now()))


def _mind(config: Config, setup: Setup, task: Task, before: Ending | None) -> StudiedMind:
    specs = [joint.spec() for joint in config.joints]
    groups = Groups(specs, {group.name: group.joints for group in config.groups})
    assists = {mode: make(task) for mode, make in setup.assists.items()}
    mind = StudiedMind(config, specs, groups, assists, setup.learns)
    if before:
        groups.activate(GROUP, before.active)
        mind.learners.recall(before.questions, before.learned)
    return mind


def _ending(stage: Stage, mind: StudiedMind, time: float) -> Ending:
    return Ending(
        operator=stage.operator,
        task=stage.task,
        time=time,
        position=stage.position or stage.task.start,
        active=stage.active,
        toggles=stage.toggles,
        questions=mind.learners.spec(),
        learned=mind.learners.memory(),
    )


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
