"""Tasks on the page's server: one run for all browsers, its trial, and the marks that it leaves."""

import asyncio
from collections.abc import Awaitable, Callable
from contextlib import suppress
from functools import partial

import pytest

from bentod.dashboard.arm_link import Knowledge
from bentod.dashboard.errands import WAITING, Errands
from bentod.dashboard.own import Stage
from bentod.dashboard.task_files import own_folder
from bentod.dashboard.tasks import METHODS
from bentod.errors import BadRequest, BentodError, Refused
from bentod.frames import Value
from tests.rig import table, tables

TICK = 1 / 30
TASK = """
kind = "waypoints"
title = "Two points"
joints = ["shoulder", "elbow"]
bounds_rad = [[-0.5, 0.5], [-0.5, 0.5]]
order = ["a", "b", "a"]
tolerance_rad = 0.02
dwell_s = 0.5
waypoints = [{ name = "a", at_rad = [0.0, 0.0] }, { name = "b", at_rad = [0.2, 0.2] }]
"""
A, B, BETWEEN = (0.0, 0.0), (0.2, 0.2), (0.1, 0.2)
INFO: Value = {"joints": [{"name": n, "min_rad": -1.0, "max_rad": 1.0} for n in ("shoulder", "elbow")]}


class Daemon:
    """Knows of trials and marks."""

    def __init__(self) -> None:
        self.trial: dict[str, Value] | None = None
        self.asked: list[str] = []
        self.marks: list[str] = []
        self.refuses = ""
        self.time = 100.0
        self.count = 0

    async def ask(self, method: str, params: dict[str, Value]) -> Value:
        self.asked.append(method)
        if method == self.refuses:
            raise Refused("not now")
        if method == "trial_start":
            self.count += 1
            self.trial = {"number": self.count, "started": self.time, **params}
            return {"trial": self.count}
        if method == "trial_stop":
            self.trial = None
        if method == "trial_mark":
            self.marks.append(str(params["mark"]))
        return None


class Server:
    """What all browsers share."""

    def __init__(self, daemon: Daemon) -> None:
        self.told: dict[str, Value] = {}
        self.watchers: list[Callable[[dict[str, Value]], None]] = []
        self.hearers: list[Callable[[dict[str, Value]], None]] = []
        self.knowledge: Knowledge | None = Knowledge(INFO, [], "operator")
        self.kept: dict[str, object] = {}
        self.daemon = daemon
        self.errands: list[Callable[[], Awaitable[None]]] = []

    async def look(self, method: str, params: dict[str, Value]) -> Value:
        return await self.daemon.ask(method, params)

    def later(self, errand: Callable[[], Awaitable[None]]) -> bool:
        self.errands.append(errand)
        return True


class Browser:
    """Somebody's page."""

    def __init__(self, server: Server) -> None:
        self.role = "operator"
        self.server = server
        self.farewells: list[Callable[[], Awaitable[None]]] = []

    @property
    def stage(self) -> Stage:
        return self.server

    async def act(self, method: str, params: dict[str, Value]) -> Value:
        return await self.server.daemon.ask(method, params)

    def on_leave(self, farewell: Callable[[], Awaitable[None]]) -> None:
        self.farewells.append(farewell)

    def stats(self) -> Value:
        return None


class Lab:
    """An arm that stands wherever it is put, the page's server, and a browser."""

    def __init__(self) -> None:
        self.daemon = Daemon()
        self.server = Server(self.daemon)
        self.browser = Browser(self.server)

    async def call(self, method: str, **params: Value) -> Value:
        return await METHODS[f"dashboard.{method}"].handler(self.browser, params)

    async def stay(
        self, position: tuple[float, float], seconds: float, mode: str = "active", freshness: str = "fresh"
    ) -> dict[str, Value]:
        """Let time pass, and say how far the task is."""
        for _ in range(round(seconds / TICK)):
            self.daemon.time += TICK
            joints: list[Value] = [
                {"name": name, "position": angle, "mode": mode, "freshness": freshness}
                for name, angle in zip(("shoulder", "elbow"), position, strict=True)
            ]
            frame: dict[str, Value] = {
                "time": self.daemon.time,
                "whole": True,
                "joints": joints,
                "trial": self.daemon.trial,
            }
            for watcher in self.server.watchers:
                watcher(frame)
            await self.run_errands()
        return self.state

    async def run_errands(self) -> None:
        errands, self.server.errands = self.server.errands, []
        for errand in errands:
            with suppress(BentodError):
                await errand()

    @property
    def state(self) -> dict[str, Value]:
        state = self.server.told["task"]
        assert isinstance(state, dict)
        return state

    async def begun(self) -> None:
        """The trial of the two points runs, and the arm is at its start."""
        await self.call("task_start", task="points", condition="manual")
        state = await self.stay(A, 0.7)
        assert (state["phase"], state["trial"]) == ("running", 1)


@pytest.fixture
def lab(monkeypatch: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory) -> Lab:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path_factory.mktemp("config")))
    own_folder().mkdir(parents=True)
    (own_folder() / "points.toml").write_text(TASK)
    return Lab()


async def test_the_list_tells_what_a_page_draws_and_which_tasks_do_not_fit(lab: Lab) -> None:
    told = table(await lab.call("tasks"))
    shown = {str(task["name"]): task for task in tables(told, "tasks")}
    points, maze = shown["points"], shown["maze"]
    assert (points["order"], points["dwell"], points["problem"]) == ([0, 1, 0], 0.5, "")
    assert tables(points, "places")[1] == {"name": "b", "centre": [0.2, 0.2], "tolerance": 0.02}
    assert table(maze["corridor"])["half_width"] == 0.058
    assert "the arm has no joint 'shoulder_rotation'" in str(maze["problem"])
    assert (told["problems"], told["laps"], told["state"]) == ([], [], None)


async def test_a_trial_begins_at_the_start_and_a_circuit_leaves_its_marks(lab: Lab) -> None:
    await lab.call("task_start", task="points", name="morning", condition="manual")
    assert (await lab.stay(BETWEEN, 1.0))["phase"] == "approach"
    assert not lab.daemon.asked
    await lab.stay(A, 0.7)
    trial = table(lab.daemon.trial)
    assert (trial["number"], trial["name"], trial["condition"]) == (1, "morning", "manual")
    await lab.stay(BETWEEN, 0.5)
    state = await lab.stay(B, 0.3)
    assert (state["inside"], state["target"], state["number"]) == (True, "b", 1)
    assert state["held"] == pytest.approx(0.55, abs=0.1)
    await lab.stay(B, 0.4)
    state = await lab.stay(A, 0.7)
    assert (state["done"], state["number"], state["leg"]) == (1, 2, 0)
    assert lab.daemon.marks == [
        *("task points", "waypoint b", "waypoint b held", "waypoint a", "waypoint a held", "circuit")
    ]
    laps = await lab.call("task_laps")
    assert isinstance(laps, list)
    assert isinstance(laps[0], dict)
    assert laps[0]["time"] == pytest.approx(1.7, abs=0.2)


async def test_stopping_ends_the_trial_and_the_task_for_everybody(lab: Lab) -> None:
    await lab.begun()
    await lab.call("task_stop")
    assert lab.daemon.trial is None
    assert (await lab.stay(A, TICK))["why"] == "It was stopped."
    with pytest.raises(Refused, match="no task is under way"):
        await lab.call("task_stop")


async def test_a_task_goes_on_when_its_page_goes_once_the_trial_has_begun(lab: Lab) -> None:
    await lab.begun()
    await lab.browser.farewells[0]()
    await lab.stay(B, 0.1)
    assert (lab.state["phase"], lab.daemon.marks[-1]) == ("running", "waypoint b")


async def test_a_task_that_has_not_begun_goes_with_its_page(lab: Lab) -> None:
    await lab.call("task_start", task="points")
    await lab.browser.farewells[0]()
    assert (await lab.stay(A, 1.0))["why"] == "The page that wanted to begin it is gone."
    assert lab.daemon.asked == []


async def test_a_trial_that_somebody_else_stops_ends_the_task(lab: Lab) -> None:
    await lab.begun()
    lab.daemon.trial = None
    state = await lab.stay(B, 0.1)
    assert state["why"] == "Trial 1 is over: it was stopped elsewhere, or the daemon began anew."
    assert lab.daemon.marks == ["task points"]


async def test_the_trial_of_a_daemon_that_began_anew_is_another_one(lab: Lab) -> None:
    await lab.begun()
    lab.daemon.trial = {"number": 1, "name": "points", "condition": "", "started": lab.daemon.time}
    assert (await lab.stay(B, 0.1))["phase"] == "over"


async def test_a_trial_that_may_not_begin_ends_the_task_and_says_why(lab: Lab) -> None:
    lab.daemon.refuses = "trial_start"
    await lab.call("task_start", task="points")
    assert (await lab.stay(A, 0.7))["why"] == "The trial could not begin: not now"


async def test_a_task_that_is_given_up_while_its_trial_begins_leaves_none(lab: Lab) -> None:
    await lab.call("task_start", task="points")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(lab, "run_errands", lambda: asyncio.sleep(0))
        await lab.stay(A, 0.7)
    (start,) = lab.server.errands
    ask = lab.daemon.ask

    async def slow(method: str, params: dict[str, Value]) -> Value:
        answer = await ask(method, params)
        if method == "trial_start":
            await lab.browser.farewells[0]()
        return answer

    lab.daemon.ask = slow  # type: ignore[method-assign]
    await start()
    assert lab.daemon.trial is None
    assert lab.daemon.asked == ["trial_start", "trial_stop"]


async def test_a_mark_that_is_lost_is_counted(lab: Lab) -> None:
    await lab.begun()
    lab.daemon.refuses = "trial_mark"
    await lab.stay(B, 0.1)
    assert (await lab.stay(B, TICK))["unmarked"] == 1


async def test_a_pause_and_a_joint_that_is_lost_are_marked(lab: Lab) -> None:
    await lab.begun()
    await lab.stay(BETWEEN, 0.5, mode="paused")
    await lab.stay(BETWEEN, 0.5)
    await lab.stay(B, 1.0, freshness="lost")
    state = await lab.stay(BETWEEN, 0.1)
    assert lab.daemon.marks == ["task points", "paused", "resumed", "unseen"]
    assert (state["paused"], state["unseen"]) == pytest.approx((0.5, 1.0), abs=2 * TICK)


async def test_what_cannot_be_done_is_refused(lab: Lab) -> None:
    with pytest.raises(BadRequest, match="there is no task 'pints'; did you mean 'points'"):
        await lab.call("task_start", task="pints")
    with pytest.raises(BadRequest, match="at most 64"):
        await lab.call("task_start", task="points", name="x" * 65)
    with pytest.raises(BadRequest, match="must be a text"):
        await lab.call("task_start", task=3)
    with pytest.raises(Refused, match="Angle maze does not fit this arm"):
        await lab.call("task_start", task="maze")
    await lab.call("task_start", task="points")
    with pytest.raises(Refused, match="Two points is under way"):
        await lab.call("task_start", task="points")


async def test_no_task_begins_without_the_daemon(lab: Lab) -> None:
    lab.server.knowledge = None
    with pytest.raises(Refused, match="the daemon is not there"):
        await lab.call("task_start", task="points")


async def test_a_task_waits_for_the_end_of_anybodys_trial(lab: Lab) -> None:
    await lab.call("tasks")
    lab.daemon.trial = {"number": 7, "name": "other", "condition": "", "started": 1.0}
    for watcher in lab.server.watchers:
        watcher({"trial": lab.daemon.trial})
    with pytest.raises(Refused, match="a trial is running"):
        await lab.call("task_start", task="points")
    await lab.call("task_stop")
    assert lab.daemon.trial is None


def test_observers_may_look_at_tasks_and_not_begin_them() -> None:
    assert {name: method.role for name, method in METHODS.items()} == {
        "dashboard.tasks": "observer",
        "dashboard.task_laps": "observer",
        "dashboard.task_start": "operator",
        "dashboard.task_stop": "operator",
    }


async def test_errands_are_done_in_their_order_and_a_refusal_ends_none(
    caplog: pytest.LogCaptureFixture,
) -> None:
    errands, done = Errands(), list[int]()

    async def errand(number: int) -> None:
        await asyncio.sleep(0.1 / number)
        done.append(number)
        if number == 2:
            raise Refused("no trial is running")

    assert all(errands.later(partial(errand, number)) for number in (1, 2, 3))
    running = asyncio.create_task(errands.run())
    await asyncio.sleep(1.0)
    running.cancel()
    assert done == [1, 2, 3]
    assert "no trial is running" in caplog.text


async def test_no_more_errands_wait_than_can_be_done_soon() -> None:
    errands = Errands()
    assert all(errands.later(lambda: asyncio.sleep(0)) for _ in range(WAITING))
    assert not errands.later(lambda: asyncio.sleep(0))
