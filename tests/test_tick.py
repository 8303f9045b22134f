"""The loop in virtual time, over joints that can be slow and can break."""

import asyncio
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bentod.client import Client
from bentod.config import Config
from bentod.config_learn import Learn
from bentod.control.groups import Groups
from bentod.daemon import Daemon
from bentod.desk import Desk
from bentod.errors import Refused
from bentod.frames import Mode, Stop, Velocity
from bentod.learn.horde import HasTime, Horde, unhurried
from bentod.learn.signals import Percept
from bentod.mind import Mind
from bentod.supervise import Supervisor
from bentod.tick import AT_REST, next_deadline
from sim.clock import VirtualClock
from tests.fakes import PERIOD, SPECS, Bench
from tests.rig import PLAIN, quiet_config, wait_for


class WatchfulMind(Mind):
    """Remembers which of its readings came after a gap."""

    def __init__(self) -> None:
        super().__init__(SPECS, 30.0, Groups(SPECS, {}))
        self.gaps: list[bool] = []

    def predict(self, percept: Percept, has_time: HasTime = unhurried) -> None:
        self.gaps.append(percept.gap)
        super().predict(percept, has_time)


@pytest.fixture
async def bench() -> Bench:
    return Bench(WatchfulMind())


DUE = st.floats(0, 1e6)
PERIODS = st.floats(1 / 1000, 1 / 10)
LATE = st.floats(-1, 1000)  # in periods
TOLERANCE = 1e-6  # periods: rounding of the time after eleven days


@given(DUE, PERIODS, LATE)
def test_the_next_deadline_is_never_in_the_past(due: float, period: float, late: float) -> None:
    now = due + late * period
    following, _ = next_deadline(due, period, now)
    assert following > now - TOLERANCE * period


@given(DUE, PERIODS, LATE)
def test_the_next_deadline_is_on_the_grid_and_never_the_same_again(
    due: float, period: float, late: float
) -> None:
    following, skipped = next_deadline(due, period, due + late * period)
    assert (following - due) / period == pytest.approx(skipped + 1, abs=TOLERANCE)
    assert skipped >= 0


@given(DUE, PERIODS, st.floats(0, 1000))
def test_no_more_deadlines_are_skipped_than_have_passed(due: float, period: float, late: float) -> None:
    now = due + late * period
    following, skipped = next_deadline(due, period, now)
    assert skipped == pytest.approx(late - 0.5, abs=0.5 + TOLERANCE)
    assert following - now <= period * (1 + TOLERANCE)


async def test_ticks_come_once_a_period_and_are_numbered(bench: Bench) -> None:
    await bench.controller.run(30)
    assert [frame.tick for frame in bench.frames] == list(range(30))
    assert bench.arm.reads == pytest.approx([PERIOD * (i + 1) for i in range(30)])
    assert {frame.missed for frame in bench.frames} == {0}


async def test_a_tick_that_takes_three_periods_is_counted_and_not_made_up_for(bench: Bench) -> None:
    bench.arm.slow = {4: 3.2 * PERIOD}
    await bench.controller.run(12)
    starts = [round(time / PERIOD, 6) for time in bench.arm.reads]
    assert starts == [1, 2, 3, 4, 5, 9, 10, 11, 12, 13, 14, 15]
    assert [frame.missed for frame in bench.frames] == [0] * 5 + [3] * 7
    assert all(frame.lateness == pytest.approx(0, abs=1e-9) for frame in bench.frames)


async def test_the_learners_are_told_of_a_gap_and_only_of_a_gap() -> None:
    mind = WatchfulMind()
    bench = Bench(mind)
    bench.arm.slow = {2: 1.5 * PERIOD, 5: 0.9 * PERIOD}
    await bench.controller.run(8)
    assert mind.gaps == [False, False, False, True, False, False, False, False]


async def test_the_loop_ends_after_the_tick_under_way(bench: Bench) -> None:
    running = asyncio.create_task(bench.controller.run())
    await asyncio.sleep(10.5 * PERIOD)
    bench.controller.end()
    await running
    assert len(bench.frames) == 11


async def answer_in_a_tick_that_breaks(bench: Bench) -> str:
    """What a client is told whose request is served in a tick that breaks."""
    asked = asyncio.create_task(bench.inbox.ask(lambda desk: desk.set_meta("hello")))
    await asyncio.sleep(0)
    await bench.controller.run(1)
    with pytest.raises(Refused) as caught:
        await asked
    return str(caught.value)


def _muscles(bench: Bench, patch: pytest.MonkeyPatch) -> None:
    def cramp(now: float) -> None:
        patch.undo()
        raise ZeroDivisionError("oops")

    patch.setattr(bench.desk.muscles, "look", cramp)


def _call(name: str) -> Callable[[Bench, pytest.MonkeyPatch], None]:
    return lambda bench, patch: setattr(bench.arm, "broken", name)


@pytest.mark.parametrize(
    "sabotage",
    [
        pytest.param(_call("read"), id="read"),
        pytest.param(_call("write"), id="write"),
        pytest.param(_muscles, id="muscles"),
    ],
)
async def test_a_tick_that_breaks_is_a_fault_with_the_joints_stopped_and_the_loop_goes_on(
    bench: Bench,
    sabotage: Callable[[Bench, pytest.MonkeyPatch], None],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    await bench.set_off()
    sabotage(bench, monkeypatch)
    told = await answer_in_a_tick_that_breaks(bench)
    assert told == "internal error in the tick: ZeroDivisionError: oops"
    assert bench.arm.sent[-1] == (Stop(), Stop())
    await bench.controller.run(20)
    assert (bench.frames[-1].mode, bench.frames[-1].fault) == (Mode.FAULT, told)
    assert abs(bench.arm.speeds[0]) < AT_REST
    assert bench.arm.on == [True, True]
    assert [event.text for event in bench.events if event.kind == "fault"] == [told]


async def test_torque_that_cannot_be_switched_for_an_unknown_reason_is_a_fault_too(bench: Bench) -> None:
    bench.arm.broken = "set_torque"
    with pytest.raises(Refused, match="ZeroDivisionError"):
        await asyncio.gather(bench.inbox.ask(lambda desk: desk.torque([0], False)), bench.controller.run(1))
    await bench.controller.run(2)
    assert bench.frames[-1].mode is Mode.FAULT


async def test_after_a_tick_that_broke_the_fault_can_be_cleared_and_the_arm_moves_again(
    bench: Bench,
) -> None:
    bench.arm.broken = "read"
    await bench.controller.run(2)
    for request in (Desk.clear_fault, lambda desk: desk.pause((0, 1), False)):
        bench.inbox.post(request)
    await bench.set_off()
    assert bench.frames[-1].mode is Mode.ACTIVE


async def test_a_learner_that_breaks_is_off_and_nothing_else_is(monkeypatch: pytest.MonkeyPatch) -> None:
    learn = Learn(joints=("shoulder", "elbow"))
    bench = Bench(Mind(SPECS, 30.0, Groups(SPECS, {}), learn))
    await bench.set_off()

    def break_down(horde: Horde, *step: object) -> None:
        raise ZeroDivisionError("oops")

    monkeypatch.setattr(Horde, "step", break_down)
    await bench.controller.run(5)
    assert bench.frames[-1].mode is Mode.ACTIVE
    assert bench.arm.sent[-1] == (Velocity(0.4), Stop())
    assert len(bench.frames) == 8


async def test_settling_stops_a_moving_joint_before_it_lets_go(bench: Bench) -> None:
    await bench.set_off()
    assert await bench.controller.settle(limp=True) == (False, False)
    assert (Stop(), Stop()) in bench.arm.sent
    assert bench.arm.sent[-1] == (Stop(), Stop())
    assert [abs(speed) < AT_REST for speed in bench.arm.let_go_at] == [True]


async def test_settling_can_leave_the_arm_holding(bench: Bench) -> None:
    await bench.set_off()
    assert await bench.controller.settle(limp=False) == (True, True)
    assert bench.arm.sent[-1] == (Stop(), Stop())
    assert abs(bench.arm.speeds[0]) < AT_REST


async def test_settling_waits_for_a_joint_that_does_not_stop_but_not_for_ever(
    bench: Bench, clock: VirtualClock
) -> None:
    await bench.set_off()
    bench.arm.brakes = 1.0
    began = clock.now()
    assert await bench.controller.settle(limp=True, patience=1.0) == (False, False)
    assert 1.0 < clock.now() - began < 1.2
    assert bench.arm.let_go_at == [0.4]


async def test_settling_works_after_the_loop_was_told_to_end(bench: Bench) -> None:
    await bench.set_off()
    bench.controller.end()
    await bench.controller.run()
    assert await bench.controller.settle(limp=True) == (False, False)


async def farewell(config: Config, socket: Path, ticks: int, fault: str = "") -> tuple[str, float]:
    """How a daemon says that it left an arm that was moving, and how long its end took (s)."""
    daemon = Daemon(config, VirtualClock(), Supervisor(), socket)
    task = asyncio.create_task(daemon.run(ticks))
    await asyncio.sleep(3 * PERIOD)
    async with Client.connect(socket) as arm:
        await wait_for(arm, lambda frame: frame["mode"] == "active")
        await arm.call("move", joint="wrist_rotation", velocity=0.5, lease_s=2.0)
        await asyncio.sleep(0.3)
        if fault:
            await arm.call("inject", fault=fault)
    left = await task
    return left, asyncio.get_running_loop().time() - (ticks + 1) * PERIOD


async def test_a_daemon_says_that_it_left_the_arm_limp(tmp_path: Path) -> None:
    left, _ = await farewell(quiet_config(), tmp_path / "s", 30)
    assert left == "The arm was left limp."


async def test_a_daemon_says_which_joints_it_left_holding_because_it_was_asked_to(tmp_path: Path) -> None:
    config = quiet_config(PLAIN, ('exit = "limp"', 'exit = "hold"'))
    left, _ = await farewell(config, tmp_path / "s", 30)
    assert left.startswith("The arm was left with torque on, as the config asks: shoulder_rotation, elbow")


@pytest.mark.parametrize("fault", ["cable", "silent"])
async def test_a_daemon_whose_bus_is_dead_ends_in_time_and_says_that_torque_may_be_on(
    tmp_path: Path, fault: str
) -> None:
    left, took = await farewell(quiet_config(), tmp_path / "s", 30, fault)
    assert left.startswith("Torque may still be on, because nothing confirmed that it is off: shoulder_rot")
    assert took < 2.5
