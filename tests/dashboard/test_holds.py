"""Motion from a page lasts for as long as it is renewed, and one request a control is under way."""

import asyncio

import pytest

from bentod.dashboard.holds import LEASES, MOST, Holds
from bentod.errors import BadRequest, Refused
from bentod.frames import Value


class Daemon:
    """Answers after a tick, or refuses."""

    def __init__(self) -> None:
        self.asked: list[tuple[str, dict[str, Value]]] = []
        self.refusal = ""
        self.hold_up = 1 / 30

    async def ask(self, method: str, params: dict[str, Value]) -> Value:
        self.asked.append((method, params))
        await asyncio.sleep(self.hold_up)
        if self.refusal:
            raise Refused(self.refusal)
        return {"goal": 7} if method == "go_home" else None


class Hand:
    """A page that holds one control."""

    def __init__(self, daemon: Daemon, tasks: asyncio.TaskGroup) -> None:
        self.dropped: list[tuple[str, str]] = []
        now = asyncio.get_running_loop().time
        self.holds = Holds(daemon.ask, lambda key, why: self.dropped.append((key, why)), tasks, now)

    async def hold(self, times: int, velocity: float = 0.3) -> None:
        for _ in range(times):
            self.holds.renew("elbow", "move", {"joint": "elbow_flexion", "velocity": velocity})
            await asyncio.sleep(0.05)


async def test_each_renewal_is_a_lease_that_the_page_cannot_choose() -> None:
    daemon = Daemon()
    async with asyncio.TaskGroup() as tasks:
        hand = Hand(daemon, tasks)
        hand.holds.renew("elbow", "move", {"joint": "elbow_flexion", "velocity": 0.3, "lease_s": 10.0})
    assert daemon.asked == [("move", {"joint": "elbow_flexion", "velocity": 0.3, "lease_s": LEASES["move"]})]


async def test_letting_go_stops_at_once_and_does_not_wait_for_the_lease() -> None:
    daemon = Daemon()
    async with asyncio.TaskGroup() as tasks:
        hand = Hand(daemon, tasks)
        await hand.hold(3)
        hand.holds.release("elbow")
    assert daemon.asked[-1] == ("move", {"joint": "elbow_flexion", "velocity": 0.0, "lease_s": 0.05})


async def test_a_group_is_let_go_by_no_effort_and_going_home_by_its_end() -> None:
    daemon = Daemon()
    async with asyncio.TaskGroup() as tasks:
        hand = Hand(daemon, tasks)
        hand.holds.renew("hand", "group_command", {"group": "hand", "effort": -0.5})
        hand.holds.renew("home", "go_home", {"joints": None})
        await asyncio.sleep(0.1)
        hand.holds.release("hand")
        hand.holds.release("home")
    assert ("group_command", {"group": "hand", "effort": 0.0, "lease_s": 0.05}) in daemon.asked
    assert ("go_home_cancel", {}) in daemon.asked


async def test_letting_go_of_what_is_not_held_asks_for_nothing() -> None:
    daemon = Daemon()
    async with asyncio.TaskGroup() as tasks:
        Hand(daemon, tasks).holds.release("elbow")
    assert not daemon.asked


async def test_a_slow_daemon_gets_the_newest_wish_and_never_a_queue() -> None:
    daemon = Daemon()
    daemon.hold_up = 0.09
    async with asyncio.TaskGroup() as tasks:
        hand = Hand(daemon, tasks)
        for step in range(40):
            hand.holds.renew("elbow", "move", {"joint": "elbow_flexion", "velocity": step / 100})
            await asyncio.sleep(0.01)
    velocities = [params["velocity"] for _, params in daemon.asked]
    assert len(velocities) <= 7
    assert velocities[-1] == 0.39


async def test_a_wish_that_waited_for_a_daemon_that_stood_still_is_not_carried_out_late() -> None:
    daemon = Daemon()
    daemon.hold_up = 2.0
    async with asyncio.TaskGroup() as tasks:
        await Hand(daemon, tasks).hold(3)
    assert len(daemon.asked) == 1


async def test_a_refusal_lets_go_and_says_why() -> None:
    daemon = Daemon()
    daemon.refusal = "elbow_flexion is paused"
    async with asyncio.TaskGroup() as tasks:
        hand = Hand(daemon, tasks)
        await hand.hold(1)
        await asyncio.sleep(0.1)
        hand.holds.release("elbow")
    assert hand.dropped == [("elbow", "elbow_flexion is paused")]
    assert len(daemon.asked) == 1


async def test_a_homing_is_renewed_by_its_number_so_that_none_begins_anew() -> None:
    daemon = Daemon()
    async with asyncio.TaskGroup() as tasks:
        hand = Hand(daemon, tasks)
        for _ in range(3):
            hand.holds.renew("home", "go_home", {"joints": None})
            await asyncio.sleep(0.05)
        hand.holds.release("home")
        await asyncio.sleep(0.05)
        hand.holds.renew("home", "go_home", {"joints": None})
    asked = [params.get("goal") for method, params in daemon.asked if method == "go_home"]
    assert asked == [None, 7, 7, None]


async def test_nobody_holds_more_controls_than_hands_can() -> None:
    async with asyncio.TaskGroup() as tasks:
        hand = Hand(Daemon(), tasks)
        for key in range(MOST):
            hand.holds.renew(str(key), "move", {"joint": "elbow_flexion", "velocity": 0.1})
        with pytest.raises(BadRequest, match="32 controls"):
            hand.holds.renew("another", "move", {"joint": "elbow_flexion", "velocity": 0.1})
