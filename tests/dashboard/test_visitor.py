"""What one browser may ask, by its role and by what it has seen."""

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager

import msgpack
import pytest

from bentod.client import Client
from bentod.dashboard.arm_link import Knowledge
from bentod.dashboard.audience import Audience
from bentod.dashboard.messages import Call, Hold, Release, Seen, Token
from bentod.dashboard.own import Own, Visit, own
from bentod.dashboard.visitor import AT_ONCE, House, Visitor
from bentod.endpoint import Disconnected
from bentod.errors import BadRequest
from bentod.frames import Value

METHODS: Value = [
    {"name": name, "role": role}
    for name, role in (
        ("get_info", "observer"),
        ("stop", "observer"),
        ("pause", "operator"),
        ("move", "operator"),
    )
]


async def _echo(visit: Visit, params: dict[str, Value]) -> Value:
    return params["word"]


class Stage:
    """What browsers share, and a daemon that is written down."""

    def __init__(self) -> None:
        self.told: dict[str, Value] = {}
        self.watchers: list[Callable[[dict[str, Value]], None]] = []
        self.hearers: list[Callable[[dict[str, Value]], None]] = []
        self.knowledge: Knowledge | None = Knowledge({}, METHODS, "operator")
        self.kept: dict[str, object] = {}
        self.looked: list[str] = []
        self.acted: list[tuple[str, dict[str, Value]]] = []
        self.left = 0

    def later(self, errand: Callable[[], Awaitable[None]]) -> bool:
        raise AssertionError("nothing here is put off")

    async def look(self, method: str, params: dict[str, Value]) -> Value:
        self.looked.append(method)
        return "looked"


class Arm(Client):
    """A connection that writes down what it is asked."""

    def __init__(self, stage: Stage) -> None:
        self._stage = stage

    async def call(self, method: str, /, *params: Value, **named: Value) -> Value:
        if method != "hello":
            self._stage.acted.append((method, named))
        await asyncio.sleep(0.01)
        return "done"


class Room:
    """A visitor and what is said to it."""

    def __init__(self, tasks: asyncio.TaskGroup, role: str = "operator") -> None:
        self.stage = Stage()
        self.audience = Audience(asyncio.get_running_loop().time)
        self.said: list[list[Value]] = []
        self.connects_in = 0.0  # s
        table: dict[str, Own] = own(observer={"dashboard.echo": _echo}, operator={"dashboard.do": _echo})
        house = House(self.stage, self.audience, self._connect, table)
        self.visitor = Visitor(house, role, "page 1", self._hear, tasks)

    def show(self, frames: int = 1) -> int:
        """So many frames go out; the number of the last."""
        number = 0
        for _ in range(frames):
            number = self.audience.next_number()
            self.visitor.sent(number)
        return number

    @asynccontextmanager
    async def _connect(self) -> AsyncIterator[Client]:
        await asyncio.sleep(self.connects_in)
        yield Arm(self.stage)
        self.stage.left += 1

    def _hear(self, frame: bytes) -> None:
        self.said.append(msgpack.unpackb(frame[2:] if frame[1] < 126 else frame[4:]))


PUSH: dict[str, Value] = {"joint": "elbow_flexion", "velocity": 0.3}


async def test_who_sees_the_arm_may_move_it() -> None:
    async with asyncio.TaskGroup() as tasks:
        room = Room(tasks)
        room.visitor.take(Hold("key", "move", dict(PUSH), room.show()))
    assert room.stage.acted == [("move", {**PUSH, "lease_s": 0.12})]


async def test_who_sees_the_arm_too_late_moves_nothing_and_is_told() -> None:
    async with asyncio.TaskGroup() as tasks:
        room = Room(tasks)
        seen = room.show()
        await asyncio.sleep(0.26)
        room.visitor.take(Hold("key", "move", dict(PUSH), seen))
    assert not room.stage.acted
    assert room.said[0][:2] == ["dropped", "key"]


async def test_what_was_held_is_let_go_when_the_page_falls_behind() -> None:
    async with asyncio.TaskGroup() as tasks:
        room = Room(tasks)
        seen = room.show()
        room.visitor.take(Hold("key", "move", dict(PUSH), seen))
        await asyncio.sleep(0.3)
        room.visitor.take(Hold("key", "move", dict(PUSH), seen))
    assert room.stage.acted[-1] == ("move", {**PUSH, "velocity": 0.0, "lease_s": 0.05})


@pytest.mark.parametrize("seen", [0, -1, 10**9])
async def test_a_frame_that_was_never_sent_was_never_seen(seen: int) -> None:
    async with asyncio.TaskGroup() as tasks:
        room = Room(tasks)
        room.show()
        room.visitor.take(Hold("key", "move", dict(PUSH), seen))
    assert not room.stage.acted


async def test_motion_cannot_be_asked_for_without_holding_it() -> None:
    async with asyncio.TaskGroup() as tasks:
        room = Room(tasks)
        room.visitor.take(Call(1, "move", {**PUSH, "lease_s": 10.0}, room.show()))
    assert room.said == [["refused", 1, "move moves the arm: it must be held."]]
    assert not room.stage.acted


async def test_nothing_but_motion_can_be_held() -> None:
    async with asyncio.TaskGroup() as tasks:
        room = Room(tasks)
        with pytest.raises(BadRequest, match="torque is no motion"):
            room.visitor.take(Hold("key", "torque", {"on": True}, room.show()))


async def test_an_observer_looks_and_stops_and_does_nothing_else() -> None:
    async with asyncio.TaskGroup() as tasks:
        room = Room(tasks, "observer")
        for number, method in enumerate(["get_info", "stop", "pause", "dashboard.do"]):
            room.visitor.take(Call(number, method, {}, room.show()))
        room.visitor.take(Hold("key", "move", dict(PUSH), room.show()))
    assert room.stage.looked == ["get_info", "stop"]
    assert not room.stage.acted
    assert [said[0] for said in room.said].count("answer") == 2
    assert [said[0] for said in room.said].count("refused") == 2
    assert ["dropped", "key"] in [said[:2] for said in room.said]


@pytest.mark.parametrize("method", ["hello", "authenticate", "subscribe", "fly"])
async def test_what_is_not_for_pages_is_not_there(method: str) -> None:
    async with asyncio.TaskGroup() as tasks:
        room = Room(tasks)
        room.visitor.take(Call(1, method, {}, room.show()))
    assert room.said[0][0] == "refused"


async def test_the_servers_own_methods_are_answered_by_it() -> None:
    async with asyncio.TaskGroup() as tasks:
        room = Room(tasks)
        room.visitor.take(Call(5, "dashboard.echo", {"word": "hi"}, room.show()))
    assert room.said == [["answer", 5, "hi"]]


async def test_a_daemon_that_makes_an_observer_of_the_server_makes_one_of_its_browsers() -> None:
    async with asyncio.TaskGroup() as tasks:
        room = Room(tasks)
        room.visitor.welcome("build", Knowledge({}, METHODS, "observer"))
    welcome = room.said[0][1]
    assert isinstance(welcome, dict)
    assert welcome["role"] == "observer"


async def test_so_many_calls_are_open_at_once_and_no_more() -> None:
    async with asyncio.TaskGroup() as tasks:
        room = Room(tasks)
        for number in range(AT_ONCE + 3):
            room.visitor.take(Call(number, "get_info", {}, room.show()))
    assert [said[0] for said in room.said].count("refused") == 3


async def test_frames_that_were_taken_in_are_not_on_their_way() -> None:
    async with asyncio.TaskGroup() as tasks:
        room = Room(tasks)
        last = room.show(5)
        assert room.visitor.ahead == 5
        room.visitor.take(Seen(last - 1))
        assert room.visitor.ahead == 1


async def test_a_browser_that_is_gone_takes_its_connection_with_it_and_makes_no_other() -> None:
    async with asyncio.TaskGroup() as tasks:
        room = Room(tasks)
        room.visitor.take(Hold("key", "move", dict(PUSH), room.show()))
        await asyncio.sleep(0.01)
        gone: list[bool] = []

        async def farewell() -> None:
            gone.append(True)

        room.visitor.on_leave(farewell)
        await room.visitor.leave()
        room.visitor.take(Release("key"))
        await asyncio.sleep(0.01)
    assert gone == [True]
    assert room.stage.left == 1
    assert len(room.stage.acted) == 1


async def test_a_second_token_is_refused() -> None:
    async with asyncio.TaskGroup() as tasks:
        with pytest.raises(BadRequest):
            Room(tasks).visitor.take(Token("again"))


async def test_a_daemon_that_is_not_there_is_a_refusal() -> None:
    async with asyncio.TaskGroup() as tasks:
        room = Room(tasks)

        async def look(method: str, params: dict[str, Value]) -> Value:
            raise Disconnected("The daemon is not there.")

        room.stage.look = look  # type: ignore[method-assign]
        room.visitor.take(Call(1, "stop", {}, room.show()))
    assert room.said == [["refused", 1, "The daemon is not there."]]


@pytest.mark.parametrize(
    ("method", "params"),
    [("pause", {"on": False}), ("torque", {"on": False}), ("dashboard.do", {"word": "now"})],
)
async def test_what_arrives_late_was_meant_for_then(method: str, params: dict[str, Value]) -> None:
    async with asyncio.TaskGroup() as tasks:
        room = Room(tasks)
        seen = room.show()
        await asyncio.sleep(1.01)
        room.show()
        room.visitor.take(Call(1, method, params, seen))
    assert room.said[0][:2] == ["refused", 1]
    assert not room.stage.acted


@pytest.mark.parametrize("method", ["stop", "pause"])
async def test_what_halts_the_arm_is_never_too_late(method: str) -> None:
    async with asyncio.TaskGroup() as tasks:
        room = Room(tasks)
        room.visitor.take(Call(1, method, {}, 0))
    assert room.said == [["answer", 1, None if method == "stop" else "done"]]


async def test_a_release_that_waits_for_its_connection_does_not_undo_a_stop() -> None:
    async with asyncio.TaskGroup() as tasks:
        room = Room(tasks)
        room.connects_in = 0.05
        room.visitor.take(Call(1, "pause", {"on": False}, room.show()))
        await asyncio.sleep(0.03)
        room.visitor.take(Call(2, "stop", {}, room.show()))
    assert not room.stage.acted
    assert ["refused", 1, "somebody pressed STOP meanwhile"] in room.said


async def test_a_stop_goes_after_what_is_on_its_way_too() -> None:
    async with asyncio.TaskGroup() as tasks:
        room = Room(tasks)
        room.visitor.take(Call(1, "pause", {"on": False}, room.show()))
        await asyncio.sleep(0.03)
        room.visitor.take(Call(2, "stop", {}, room.show()))
    assert room.stage.acted[-1] == ("stop", {})
    assert room.stage.looked == ["stop"]


async def test_a_stop_is_heard_however_much_is_open_and_whoever_asks() -> None:
    async with asyncio.TaskGroup() as tasks:
        room = Room(tasks, "observer")
        room.stage.knowledge = None
        for number in range(AT_ONCE):
            room.visitor.take(Call(number, "get_info", {}, room.show()))
        room.visitor.take(Call(99, "stop", {}, 0))
    assert "stop" in room.stage.looked
