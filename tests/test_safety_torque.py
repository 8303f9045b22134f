"""Torque goes when it is to go, whatever else breaks; what started before a stop does not outlive it."""

import asyncio
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from bentod.arm_state import Rules
from bentod.client import Client
from bentod.control.guard import Guard
from bentod.control.journal import QUIET
from bentod.control.leases import Holder
from bentod.control.operators import Asked
from bentod.daemon import Daemon
from bentod.desk import Desk
from bentod.errors import BusError, Refused
from bentod.frames import Command, Mode, State, Velocity
from bentod.supervise import Supervisor
from bentod.tick import ANSWER, Controller
from sim.clock import VirtualClock
from tests.fakes import LADDER, PERIOD, Bench, FakeArm, at, desk_of
from tests.rig import PLAIN, quiet_config, state

ALL = (0, 1)
ANN = Holder(1, "ann")


class BadArm(FakeArm):
    """Fails for longer than once."""

    def __init__(self) -> None:
        super().__init__()
        self.refusals = 0  # times that torque will not be switched
        self.write_is_broken = False
        self.silence = 0.0  # s that a reading takes
        self.complaints: tuple[str, ...] = ()

    async def read(self) -> State:
        found = await super().read()
        await asyncio.sleep(self.silence)
        return replace(found, joints=tuple(replace(joint, errors=self.complaints) for joint in found.joints))

    async def write(self, commands: Sequence[Command | None]) -> None:
        if self.write_is_broken:
            raise ZeroDivisionError("a bug in one driver")
        await super().write(commands)

    async def set_torque(self, on: Sequence[bool]) -> None:
        if self.refusals:
            self.refusals -= 1
            raise BusError("no answer")
        await super().set_torque(on)


class Trial(Bench):
    """The bench with an arm that fails, and what the clock does not count."""

    def __init__(self, *, limp_on_fault: bool = False) -> None:
        super().__init__()
        self.bad = self.arm = BadArm()
        self.desk.rules = Rules(LADDER, limp_on_fault, 0.35, 2.0)
        self.slept = 0.0
        self.controller = Controller(
            self.arm,
            self.desk,
            self.inbox,
            VirtualClock(),
            1 / PERIOD,
            self._publish,
            slept=lambda: self.slept,
        )

    def texts(self, kind: str) -> list[str]:
        return [event.text for event in self.events if event.kind == kind]


async def test_an_arm_that_is_to_go_limp_in_a_fault_is_told_until_it_is() -> None:
    trial = Trial(limp_on_fault=True)
    await trial.controller.run(3)
    trial.bad.refusals = 5
    trial.desk.fault("smoke")
    await trial.controller.run(10)
    assert trial.arm.torque() == (False, False)
    assert trial.texts("fault") == ["smoke", "torque could not be switched: no answer"]


async def test_torque_that_never_goes_is_told_seldom() -> None:
    trial = Trial()
    trial.bad.refusals = 1000
    trial.inbox.post(lambda desk: desk.torque(ALL, False))
    await trial.controller.run(round(2.5 * QUIET / PERIOD))
    assert 2 <= len(trial.texts("fault")) <= 4


async def test_a_joint_that_loses_torque_by_itself_does_not_keep_the_other_from_going_limp() -> None:
    trial = Trial(limp_on_fault=True)
    await trial.controller.run(3)
    trial.desk.fault("smoke")
    trial.arm.on[0] = False
    await trial.controller.run(2)
    assert trial.arm.torque() == (False, False)


async def test_torque_off_is_carried_out_in_the_tick_in_which_another_joint_loses_it() -> None:
    trial = Trial()
    await trial.controller.run(3)
    trial.inbox.post(lambda desk: desk.torque((1,), False))
    trial.arm.on[0] = False
    await trial.controller.run(1)
    assert trial.arm.torque() == (False, False)


async def test_torque_goes_on_request_and_at_the_end_although_writing_breaks() -> None:
    trial = Trial()
    await trial.controller.run(3)
    trial.bad.write_is_broken = True
    trial.inbox.post(lambda desk: desk.torque((0,), False))
    await trial.controller.run(2)
    assert trial.arm.torque() == (False, True)
    assert trial.frames[-1].mode is Mode.FAULT
    assert await trial.controller.settle(limp=True) == (False, False)


async def test_an_error_in_every_tick_is_logged_once(caplog: pytest.LogCaptureFixture) -> None:
    trial = Trial()
    await trial.controller.run(1)
    trial.bad.write_is_broken = True
    await trial.controller.run(100)
    assert len([record for record in caplog.records if record.exc_info]) == 1


async def test_a_driver_that_does_not_answer_is_a_fault_and_the_loop_goes_on() -> None:
    trial = Trial()
    await trial.controller.run(1)
    trial.bad.silence = 1e6
    await trial.controller.run(2)
    assert trial.frames[-1].fault == f"the driver does not answer: reading took longer than {ANSWER:g} s"
    trial.bad.silence = 0.0
    await trial.controller.run(10)
    trial.inbox.post(Desk.clear_fault)
    await trial.controller.run(1)
    assert trial.frames[-1].mode is Mode.HOLDING


async def test_a_fault_whose_clearing_broke_is_not_cleared_later() -> None:
    trial = Trial()
    trial.bad.complaints = ("Overload",)
    await trial.controller.run(1)
    trial.desk.fault("smoke")
    asked = asyncio.create_task(trial.inbox.ask(Desk.clear_fault))
    await asyncio.sleep(0)
    trial.arm.broken = "clear_errors"
    await trial.controller.run(1)
    with pytest.raises(Refused):
        await asked
    await trial.controller.run(5)
    assert trial.desk.modes.fault == "smoke"


async def test_no_wish_outlives_a_suspend_of_the_machine() -> None:
    trial = Trial()
    await trial.set_off()
    trial.slept = 3600.0
    trial.inbox.post(lambda desk: desk.move(0, Velocity(0.4), ANN, 2.0))
    await trial.controller.run(3)
    assert trial.frames[-1].mode is Mode.PAUSED
    assert trial.desk.clients.wishes() == {}
    assert "stopped by the machine, which was suspended for 3600.0 s" in trial.texts("mode")


@pytest.mark.parametrize(
    "ask",
    [
        lambda desk: desk.pause(ALL, False),
        lambda desk: desk.torque(ALL, True),
        lambda desk: desk.go_home(ALL),
        lambda desk: desk.move(0, Velocity(0.2), ANN, 1.0),
        lambda desk: desk.group_command("arm", 0.5, ANN, 1.0),
        lambda desk: desk.toggle("arm", 1, "ann"),
        lambda desk: desk.activate("arm", "elbow", "ann"),
        lambda desk: desk.pause_muscles(False),
        lambda desk: desk.clear_fault(),
    ],
)
def test_what_may_start_motion_and_waited_while_the_daemon_was_held_up_is_refused(ask: object) -> None:
    desk = desk_of()
    desk.begin(0.0)
    desk.watch(at(0.5, 0.5), 0.0)
    desk.begin(10.0)
    assert callable(ask)
    with pytest.raises(Refused, match=r"held up for 10\.00 s"):
        ask(desk)
    for restraint in (desk.stop, lambda who: desk.pause(ALL, True), lambda who: desk.torque(ALL, False)):
        restraint("ann")


def test_stopping_an_arm_that_is_stopped_is_not_told() -> None:
    desk = desk_of()
    desk.pause(ALL, False)
    desk.journal.take()
    for _ in range(100):
        desk.stop("ann")
    assert [event.text for event in desk.journal.take()] == ["stopped by ann"]


@pytest.mark.parametrize("muscles", [True, False])
def test_whoever_contracts_at_a_release_moves_nothing_until_seen_at_rest(muscles: bool) -> None:
    desk = desk_of()
    flexed, rest = {"emg": Asked({"arm": 1.0})}, {"emg": Asked({"arm": 0.0})}
    desk.pause_muscles(muscles)
    desk.operate(rest)
    desk.operate(flexed)
    desk.pause_muscles(False)
    desk.pause(ALL, False)
    assert desk.operate(flexed) == {"emg": {}}
    desk.operate(rest)
    assert desk.operate(flexed)["emg"]
    desk.pause(ALL, False)  # nothing is released that was not free already
    assert desk.operate(flexed)["emg"]


@pytest.mark.parametrize("method", ["stop", "pause", "torque"])
async def test_who_stops_the_arm_while_it_starts_has_the_last_word(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, method: str
) -> None:
    moving = ["elbow moves"]
    monkeypatch.setattr(Guard, "unfit", lambda *args: "".join(moving))
    daemon = Daemon(quiet_config(PLAIN), VirtualClock(), Supervisor(), tmp_path / "s")
    task = asyncio.create_task(daemon.run(90))
    await asyncio.sleep(0.1)
    async with Client.connect(tmp_path / "s") as arm:
        await arm.call(method, **({"on": False} if method == "torque" else {}))
        moving.clear()  # the arm has come to rest
        await asyncio.sleep(1)
        assert (await state(arm))["mode"] == "limp"
        await arm.call("stop")
    await task
