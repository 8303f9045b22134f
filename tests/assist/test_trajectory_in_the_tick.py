"""All joints of a group at once, from a toggle and an effort to what is sent: and how it all ends at once."""

import math
from collections.abc import Callable

import pytest

from bentod.config_learn import Learn
from bentod.config_tables import Assist
from bentod.control.groups import Groups
from bentod.control.leases import Holder
from bentod.desk import Desk
from bentod.errors import Refused
from bentod.frames import EmgFrame, Frame, Stop, Velocity
from bentod.learn.predictor import Predictor
from bentod.mind import Mind
from bentod.muscles import Look, Muscles
from tests.fakes import PERIOD, SPECS, Bench

SHOULDER, ELBOW = 0, 1
BOTH = ("shoulder", "elbow")
ANN, BOB = Holder(1, "ann"), Holder(2, "bob")
READY = {"confidence": 0.0, "familiarity": 0.0, "hysteresis": 1.0, "after": 0.0}
"""Offered from the first tick on."""


class Hand(Muscles):
    """A wearer who does what the test says."""

    def __init__(self) -> None:
        super().__init__()
        self.effort = 0.0
        self.toggles: list[str] = []
        self.alive = True

    def look(self, now: float) -> Look:
        toggles, self.toggles = self.toggles, []
        frame = EmgFrame(self.alive, False, "", 0, 0.0, 0, {}, 0)
        return Look({"arm": self.effort} if self.alive else {}, toggles, frame)


class Arm(Bench):
    """The fake arm with a wearer, and an assist that offers all joints together."""

    def __init__(self, mode: str = "trajectory", options: dict[str, float] = READY) -> None:
        table = Assist(group="arm", mode=mode, manual_after_toggle_s=0.0, options=options)
        learn = Learn(joints=BOTH, tilings=4, memory=64)
        mind = Mind(SPECS, 1 / PERIOD, Groups(SPECS, {"arm": BOTH}), learn, [table])
        super().__init__(mind)
        self.desk.groups = mind.groups
        self.hand = self.desk.muscles = Hand()

    async def tick(self, effort: float | None = None, toggles: int = 0, ticks: int = 1) -> Frame:
        if effort is not None:
            self.hand.effort = effort
        self.hand.toggles = ["arm"] * toggles
        await self.controller.run(ticks)
        return self.frames[-1]

    async def ask(self, request: Callable[[Desk], object]) -> Frame:
        self.inbox.post(request)
        return await self.tick()

    def sent(self) -> list[float]:
        return [it.velocity if isinstance(it, Velocity) else 0.0 for it in self.arm.sent[-1]]

    async def pushing(self, effort: float = 1.0) -> Frame:
        """Both joints on their way, pushed by the wearer."""
        await self.tick(0.0, ticks=2)
        await self.tick(toggles=2)
        await self.tick()
        frame = await self.tick(effort, ticks=5)
        assert all(self.sent())
        return frame


@pytest.fixture
async def arm() -> Arm:
    return Arm()


async def test_all_joints_are_one_more_entry_of_the_toggle_list(arm: Arm) -> None:
    await arm.tick(0.0, ticks=2)
    seen = []
    for _ in range(3):
        (group,) = (await arm.tick(toggles=1)).groups
        seen.append((group.active, group.together))
        await arm.tick()
    assert seen == [("elbow", False), ("elbow", True), ("shoulder", False)]
    told = [event for event in arm.events if event.kind == "group"]
    assert [event.data["together"] for event in told] == [False, True, False]
    assert told[1].text == "the wearer switched arm to all joints together"


async def test_both_joints_move_and_the_frame_tells_of_it(arm: Arm) -> None:
    frame = await arm.pushing()
    assert arm.sent() == pytest.approx([-0.5, -0.5])
    (group,) = frame.groups
    assert (group.together, group.effort, group.operator) == (True, 1.0, "emg")
    assert frame.assist.moving == pytest.approx({"shoulder": -0.5, "elbow": -0.5})
    assert frame.assist.engaged
    assert frame.assist.offers_together
    assert {joint.holder for joint in frame.joints} == {"assist"}


async def test_nothing_moves_without_effort(arm: Arm) -> None:
    await arm.pushing()
    frame = await arm.tick(0.0)
    assert arm.arm.sent[-1] == (Stop(), Stop())
    assert frame.assist.moving == {}


@pytest.mark.parametrize("effort", [-7.0, -1.0, 0.3, 1.0, 7.0])
async def test_no_joint_is_ever_sent_faster_than_its_own_maximum(arm: Arm, effort: float) -> None:
    await arm.tick(0.0, ticks=2)
    await arm.tick(toggles=2)
    await arm.tick()
    for _ in range(10):
        await arm.tick(effort)
        assert max(map(abs, arm.sent())) <= 0.5 * min(abs(effort), 1.0) + 1e-9


ENDS: dict[str, Callable[[Desk], object]] = {
    "stop": lambda desk: desk.stop("ann"),
    "pause": lambda desk: desk.pause((SHOULDER, ELBOW), True),
    "pause of one joint": lambda desk: desk.pause((ELBOW,), True),
    "torque off": lambda desk: desk.torque((ELBOW,), False),
    "fault": lambda desk: desk.fault("The cable is pulled."),
    "client's toggle": lambda desk: desk.toggle("arm", 1, "ann"),
    "joint by name": lambda desk: desk.activate("arm", "shoulder", "ann"),
    "assist off": lambda desk: desk.change_assist({"mode": "off"}),
    "other mode": lambda desk: desk.change_assist({"mode": "dpcc"}),
    "muscles paused": lambda desk: setattr(desk.muscles, "alive", False),
    "confidence": lambda desk: desk.change_assist({"options": {"confidence": 1.0, "hysteresis": 0.0}}),
}


@pytest.mark.parametrize("end", ENDS)
async def test_within_one_tick_everything_stands_still_although_the_wearer_pushes_on(
    arm: Arm, end: str
) -> None:
    await arm.pushing()
    await arm.ask(ENDS[end])
    for _ in range(3):
        assert not any(arm.sent())
        await arm.tick()


@pytest.mark.parametrize("toggles", [1, 2])
async def test_a_toggle_stops_what_moved_until_the_wearer_has_rested_once(arm: Arm, toggles: int) -> None:
    await arm.pushing()
    frame = await arm.tick(toggles=toggles)
    assert all("emg" not in joint.asked for joint in frame.joints)
    for _ in range(3):
        assert not any(arm.sent())
        await arm.tick()
    await arm.tick(0.0)
    await arm.tick(0.5)
    assert arm.sent() == pytest.approx([0.25, 0.0] if toggles == 1 else [0.0, 0.25])


@pytest.mark.parametrize("effort", [1.0, -1.0])
async def test_a_prediction_that_is_not_finite_stops_all_joints_in_its_tick(
    arm: Arm, effort: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    await arm.pushing(1.0)
    await arm.tick(effort)
    monkeypatch.setattr(Predictor, "fresh", lambda self, name: math.nan)
    frame = await arm.tick()
    assert not any(arm.sent())
    assert frame.assist.reason.startswith("All joints stop and fall back to one.")


async def test_learning_that_breaks_stops_all_joints_in_its_tick(
    arm: Arm, monkeypatch: pytest.MonkeyPatch
) -> None:
    await arm.pushing()
    monkeypatch.setattr(Predictor, "see", lambda self, percept: 1 / 0)
    await arm.tick()
    assert not any(arm.sent())
    assert not (await arm.tick()).groups[0].together


async def test_an_assist_that_is_no_longer_sure_gives_one_joint_back_and_says_so(arm: Arm) -> None:
    await arm.pushing()
    frame = await arm.ask(ENDS["confidence"])
    assert frame.groups[0].together
    assert frame.assist.reason.startswith("All joints stop and fall back to one.")
    frame = await arm.tick()
    assert (frame.groups[0].together, frame.groups[0].active) == (False, "elbow")
    assert arm.events[-1].text == "the assist, no longer sure of the way, switched arm to elbow"
    await arm.tick(0.0)
    await arm.tick(1.0)
    assert arm.sent() == pytest.approx([0.0, 0.5], abs=0.2)
    assert arm.sent()[ELBOW]


async def test_a_client_pushes_all_joints_for_as_long_as_its_lease(arm: Arm) -> None:
    await arm.tick(0.0, ticks=2)
    await arm.tick(toggles=2)
    frame = await arm.ask(lambda desk: desk.group_command("arm", 0.5, ANN, 0.1))
    assert (frame.groups[0].operator, frame.groups[0].effort) == ("client:ann", 0.5)
    assert all(arm.sent())
    with pytest.raises(Refused, match="'ann' holds it"):
        arm.desk.group_command("arm", 0.5, BOB, 1.0)
    await arm.tick(ticks=4)
    assert not any(arm.sent())


@pytest.mark.parametrize("end", ["stop", "pause", "pause of one joint", "client's toggle", "joint by name"])
async def test_what_a_client_pushes_ends_with_what_it_was_asked_of(arm: Arm, end: str) -> None:
    await arm.tick(0.0, ticks=2)
    await arm.tick(toggles=2)
    await arm.ask(lambda desk: desk.group_command("arm", 0.5, ANN, 2.0))
    await arm.ask(ENDS[end])
    assert not any(arm.sent())
    assert arm.desk.clients.pusher("arm") is None


async def test_a_joint_that_a_client_moves_by_itself_stops_the_others(arm: Arm) -> None:
    await arm.pushing()
    await arm.ask(lambda desk: desk.move(ELBOW, Velocity(0.1), ANN, 1.0))
    assert arm.sent()[SHOULDER] == 0.0
    assert (await arm.tick()).assist.reason == "Waits: elbow is moved by itself."


async def test_what_an_assist_asks_for_is_learned_as_soon_as_its_mode_is_chosen() -> None:
    arm = Arm("dpcc", {})
    names = {"arm.use.shoulder", "arm.use.elbow", "arm.use.together"}
    assert not names & (await arm.tick(ticks=2)).learn.predictions.keys()
    frame = await arm.ask(lambda desk: desk.change_assist({"mode": "dpcc+adaptive_switching"}))
    assert names <= frame.learn.predictions.keys()
    reason = (await arm.tick()).assist.reason
    assert reason.endswith("the next toggle goes to elbow (0.00), by need.")
    await arm.ask(lambda desk: desk.remove_gvfs(["arm.use.elbow"]))
    assert "Toggles go as the joints are listed" in (await arm.tick()).assist.reason.replace(
        "toggles", "Toggles"
    )


async def test_a_joint_that_is_used_much_is_toggled_to_before_the_others() -> None:
    arm = Arm("adaptive_switching", {"use_timescale": 10.0})
    await arm.tick(0.0, ticks=2)
    await arm.tick(1.0, ticks=30)
    told = (await arm.tick()).learn.predictions
    assert told["arm.use.shoulder"] > 0.3 > told["arm.use.elbow"]
    assert arm.desk.mind.order("arm") == (ELBOW, -1, SHOULDER)
