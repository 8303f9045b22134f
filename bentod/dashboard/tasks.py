"""Tasks on the page: which there are, who does one, and how far it has come, the same for all browsers."""

import asyncio
from collections.abc import Mapping

from bentod.dashboard.own import Own, Stage, Visit, own
from bentod.dashboard.task_files import Shelf, read_shelf
from bentod.dashboard.task_run import Run, lap_table
from bentod.errors import BadRequest, Refused, nearest
from bentod.frames import Value
from bentod.tasks.places import Place, Spot
from bentod.tasks.task import Range, Task, misfits

KEY = "task"
"""Under which the state goes with every frame, and under which the server keeps it."""

LONGEST = 64
"""Characters of a trial's name and condition, as the daemon allows them."""


class Tasks:
    """What the server knows about tasks. At most one is done at a time."""

    def __init__(self, stage: Stage) -> None:
        self._stage = stage
        self.run: Run | None = None
        self.trial: Value = None
        """The trial of the newest frame."""
        stage.watchers.append(self._watch)

    def begin(self, visit: Visit, task: Task, name: str, condition: str) -> None:
        """Wait for the arm to reach the start, and begin the trial then. Raises Refused: not now."""
        if self.run and self.run.phase != "over":
            raise Refused(f"{self.run.task.title} is under way: stop it first")
        if self.trial is not None:
            raise Refused("a trial is running: stop it first")
        if self._stage.knowledge is None:
            raise Refused("the daemon is not there")
        if problems := misfits(task, _limits(self._stage)):
            raise Refused(f"{task.title} does not fit this arm: {'; '.join(problems)}")
        run = Run(task, name, condition, visit.act, self._stage.look, self._stage.later)
        self.run = run
        visit.on_leave(lambda: _forsaken(run))

    async def stop(self, visit: Visit) -> None:
        """End the run and its trial. Raises Refused: nothing runs."""
        run = self.run
        if run and run.phase in ("approach", "starting") and not run.trial:
            run.end("It was given up before it began.")
        elif self.trial is None and not (run and run.phase == "starting"):
            raise Refused("no task is under way")
        else:
            await _end_trial(visit, run)

    def state(self) -> Value:
        """What goes with every frame; None: nothing to tell."""
        if self.run is None:
            return None
        return _state(self.run)

    def _watch(self, frame: dict[str, Value]) -> None:
        self.trial = frame.get("trial")
        if self.run:
            self.run.watch(frame)
        self._stage.told[KEY] = self.state()


async def _end_trial(visit: Visit, run: Run | None) -> None:
    """Stop the trial that runs, be it ours or not."""
    if run is None:
        await visit.act("trial_stop", {})
        return
    run.stopping = True
    try:
        await visit.act("trial_stop", {})
    finally:
        run.stopping = False
    run.end("It was stopped.")


async def _forsaken(run: Run) -> None:
    if run.phase in ("approach", "starting") and not run.trial:
        run.end("The page that wanted to begin it is gone.")


def _state(run: Run) -> dict[str, Value]:
    """How far it has come; s, rad, and shares of 1."""
    engine, lap = run.engine, run.engine.lap
    told: dict[str, Value] = {
        "task": run.task.name,
        "trial": run.trial,
        "name": run.name,
        "condition": run.condition,
        "phase": run.phase,
        "why": run.why,
        "leg": engine.leg,
        "target": engine.target.name,
        "inside": engine.inside,
        "resting": engine.resting,
        "held": engine.held,
        "touching": engine.touching,
        "halted": engine.paused,
        "done": len(engine.laps),
        "contacts_in_all": engine.contacts,
        "unmarked": run.unmarked,
    }
    return told | {key: value for key, value in lap_table(lap).items() if key != "legs"}


def _tasks(stage: Stage) -> Tasks:
    kept = stage.kept.get(KEY)
    if not isinstance(kept, Tasks):
        kept = stage.kept[KEY] = Tasks(stage)
    return kept


def _limits(stage: Stage) -> dict[str, Range]:
    """Lowest and highest angle (rad) by joint; empty while the daemon is not there."""
    info = stage.knowledge.info if stage.knowledge else None
    found: dict[str, Range] = {}
    match info:
        case {"joints": [*joints]}:
            for joint in joints:
                match joint:
                    case {
                        "name": str(name),
                        "min_rad": int() | float() as low,
                        "max_rad": int() | float() as high,
                    }:
                        found[name] = (float(low), float(high))
    return found


def _shown(task: Task, limits: Mapping[str, Range]) -> dict[str, Value]:
    """A task as the page draws it; rad, s."""
    corridor: Value = None
    if task.corridor:
        centre = [list[Value](point) for point in task.corridor.centre]
        corridor = {"centre": list[Value](centre), "half_width": task.corridor.half_width}
    return {
        "name": task.name,
        "title": task.title,
        "kind": task.kind,
        "joints": list[Value](task.joints),
        "bounds": [list[Value](one) for one in task.bounds],
        "places": [_place(place) for place in task.places],
        "order": list[Value](task.order),
        "dwell": task.dwell,
        "restart": task.restart,
        "path": task.path,
        "corridor": corridor,
        "problem": "; ".join(misfits(task, limits)) if limits else "",
    }


def _place(place: Place) -> Value:
    centre = list[Value](place.centre)
    if isinstance(place, Spot):
        return {"name": place.name, "centre": centre, "tolerance": place.tolerance}
    return {
        "name": place.name,
        "centre": centre,
        "inwards": list[Value](place.inwards),
        "exposed": place.exposed,
    }


async def _shelf() -> Shelf:
    return await asyncio.to_thread(read_shelf)


async def list_tasks(visit: Visit, params: dict[str, Value]) -> Value:
    """The tasks with their geometry, mistakes in files of tasks, and the circuits of the run."""
    shelf, kept = await _shelf(), _tasks(visit.stage)
    limits = _limits(visit.stage)
    laps = [lap_table(lap) for lap in kept.run.engine.laps] if kept.run else []
    return {
        "tasks": [_shown(task, limits) for task in shelf.tasks.values()],
        "problems": list[Value](shelf.problems),
        "laps": list[Value](laps),
        "state": kept.state(),
    }


async def list_laps(visit: Visit, params: dict[str, Value]) -> Value:
    """The circuits of the run that are done."""
    run = _tasks(visit.stage).run
    return [lap_table(lap) for lap in run.engine.laps] if run else []


async def start(visit: Visit, params: dict[str, Value]) -> Value:
    """Do a task: its trial begins once the arm is at its start. Raises BadRequest, Refused."""
    task = _text(params, "task")
    tasks = (await _shelf()).tasks
    if task not in tasks:
        raise BadRequest(f"there is no task '{task}'{nearest(task, tasks)}", "task")
    name = _text(params, "name") or task
    kept = _tasks(visit.stage)
    kept.begin(visit, tasks[task], name, _text(params, "condition"))
    return kept.state()


async def stop(visit: Visit, params: dict[str, Value]) -> Value:
    """End the task and its trial. Raises Refused: none is under way."""
    kept = _tasks(visit.stage)
    await kept.stop(visit)
    return kept.state()


def _text(params: dict[str, Value], key: str) -> str:
    value = params.get(key, "")
    if not isinstance(value, str) or len(value) > LONGEST:
        raise BadRequest(f"{key} must be a text of at most {LONGEST} characters", key)
    return value.strip()


METHODS: dict[str, Own] = own(
    observer={"dashboard.tasks": list_tasks, "dashboard.task_laps": list_laps},
    operator={"dashboard.task_start": start, "dashboard.task_stop": stop},
)
"""By name."""
