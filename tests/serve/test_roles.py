"""Who may look and who may move, as the kernel tells who is who."""

import asyncio
import logging
import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from bentod.config_tables import Access
from bentod.frames import Value
from bentod.inbox import Inbox
from bentod.messages import Response, encode_notification
from bentod.serve import unix_door
from bentod.serve.methods import arm_methods
from bentod.serve.peers import Peer, Role
from bentod.serve.room import About, Room
from bentod.serve.server import Server
from bentod.serve.session import Bounds
from bentod.serve.unix_door import Credentials, UnixDoor, credentials
from tests.serve.doors import OURS, said, strict
from tests.serve.helpers import Plug, plugged


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "bentod.sock"


def methods_of(role: Role) -> set[str]:
    about = About(arm="", driver="", rate_hz=30.0, joints=(), groups={}, emg="", lease_max=1.0)
    table = arm_methods(Room(Inbox(), about))
    return {name for name, method in table.items() if method.role is role}


def test_an_observer_can_look_and_ask_to_stop_and_nothing_else() -> None:
    assert methods_of(Role.OBSERVER) == {
        "list_methods",
        "challenge",
        "authenticate",
        "hello",
        "list_clients",
        "get_info",
        "get_state",
        "subscribe",
        "unsubscribe",
        "stop",
        "group_list",
        "emg_get",
        "emg_levels",
        "assist_get",
        "get_recording",
        "gvf_list",
        "emg_classes",
        "joystick_get",
    }


def test_everything_that_moves_or_changes_the_arm_needs_an_operator() -> None:
    assert {"move", "torque", "pause", "clear_fault", "go_home", "inject"} < methods_of(Role.OPERATOR)


async def test_the_daemons_own_user_operates(path: Path) -> None:
    async with strict(path, masters=frozenset((os.getuid(),))), plugged(path) as plug:
        plug.ask(1, "move")
        assert await said(plug) == "moved"


async def test_a_user_in_the_operators_group_operates(path: Path) -> None:
    async with strict(path, Access(operators=(OURS,))), plugged(path) as plug:
        plug.ask(1, "move")
        assert await said(plug) == "moved"


async def test_anybody_else_looks_and_is_told_how_to_do_more(path: Path) -> None:
    async with strict(path, Access(operators=("a-group-elsewhere",))), plugged(path) as plug:
        plug.ask(1, "move")
        assert await said(plug) == (
            f"move needs the role operator. uid {os.getuid()} is observer. "
            "Operators are in one of these groups (access.operators) when they connect: a-group-elsewhere."
        )
        plug.ask(2, "double", 4)
        assert await said(plug) == "8.0"


async def test_without_groups_the_refusal_says_that_nobody_else_operates(path: Path) -> None:
    async with strict(path), plugged(path) as plug:
        plug.ask(1, "move")
        assert "Only the daemon's own user and root" in await said(plug)


async def test_an_order_that_wants_no_answer_is_refused_too(path: Path) -> None:
    async with strict(path) as server, plugged(path) as plug:
        plug.writer.write(encode_notification("move", []))
        plug.ask(1, "double", 1)
        assert await said(plug) == "2.0"
        assert len(server.sessions) == 1


async def test_refusals_are_logged_now_and_then(path: Path, caplog: pytest.LogCaptureFixture) -> None:
    async with strict(path), plugged(path) as plug:
        for id_ in range(100):
            plug.ask(id_, "move")
            await plug.next()
    assert len(caplog.records) == 1
    assert f"Refused move to pid {os.getpid()} (uid {os.getuid()}, observer)" in caplog.text


async def test_where_observers_are_named_others_are_sent_away(
    path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    async with strict(path, Access(observers=("a-group-elsewhere",))) as server, plugged(path) as plug:
        assert f"uid {os.getuid()} may not look at this arm" in await said(plug)
        assert await plug.next() is None
        assert server.sessions == ()
    assert "Sent away uid" in caplog.text


async def test_where_observers_are_named_their_group_looks(path: Path) -> None:
    async with strict(path, Access(observers=(OURS,))), plugged(path) as plug:
        plug.ask(1, "double", 4)
        assert await said(plug) == "8.0"
        plug.ask(2, "move")
        assert "needs the role operator" in await said(plug)


async def test_operators_need_not_be_named_as_observers(path: Path) -> None:
    async with strict(path, Access(operators=(OURS,), observers=())), plugged(path) as plug:
        plug.ask(1, "move")
        assert await said(plug) == "moved"


def test_a_group_that_does_not_exist_is_a_warning_and_lets_nobody_in(
    caplog: pytest.LogCaptureFixture,
) -> None:
    UnixDoor(Access(operators=("no-such-group",), observers=("nor-this",)))
    assert [record.levelno for record in caplog.records] == [logging.WARNING] * 2
    assert "access.operators: there is no group 'no-such-group' on this machine" in caplog.text


async def test_the_kernel_tells_user_and_groups() -> None:
    ours, theirs = socket.socketpair()
    with ours, theirs:
        found = await credentials(ours)
    assert found == Credentials(os.getpid(), os.getuid(), frozenset((os.getgid(), *os.getgroups())))


@pytest.mark.real_time
async def test_a_kernel_that_tells_no_groups_is_made_up_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(unix_door, "SO_PEERGROUPS", 9999)
    ours, theirs = socket.socketpair()
    with ours, theirs:
        found = await credentials(ours)
    assert os.getgid() in found.groups


@contextmanager
def acting_as(uid: int, groups: list[int]) -> Iterator[None]:
    """Be another user for a moment; what connects meanwhile stays theirs."""
    before = os.getgroups()
    os.setgroups(groups)
    os.setegid(uid)
    os.seteuid(uid)
    try:
        yield
    finally:
        os.seteuid(0)
        os.setegid(0)
        os.setgroups(before)


@pytest.mark.skipif(os.getuid() != 0, reason="only root can be somebody else")
@pytest.mark.parametrize(("groups", "answer"), [([], "uid 54321 is observer"), ([5, 54322], "moved")])
async def test_another_user_of_this_machine_moves_only_with_the_right_group(
    monkeypatch: pytest.MonkeyPatch, groups: list[int], answer: str
) -> None:
    monkeypatch.setattr(unix_door, "_numbers", lambda names, key: frozenset((54322,)))
    with TemporaryDirectory() as folder:
        Path(folder).chmod(0o711)
        path = Path(folder, "bentod.sock")
        async with strict(path, masters=frozenset((0,))):
            path.chmod(0o666)
            with socket.socket(socket.AF_UNIX) as connection:
                with acting_as(54321, groups):
                    connection.connect(str(path))
                reader, writer = await asyncio.open_unix_connection(sock=connection)
                plug = Plug(reader, writer)
                plug.ask(1, "move")
                assert answer in await said(plug)
                writer.close()
                await writer.wait_closed()


async def admitted(door: UnixDoor) -> Peer:
    """What the door makes of somebody who runs as we do."""
    ours, theirs = socket.socketpair()
    with theirs:
        line, peer = await door.admit(ours)
        line.writer.close()
        await line.writer.wait_closed()
    return peer


async def test_the_user_who_stands_for_all_whom_the_kernel_cannot_name_is_nobodys_master(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    assert (await admitted(UnixDoor(Access()))).role is Role.OPERATOR
    user, group = tmp_path / "overflowuid", tmp_path / "overflowgid"
    user.write_text(f"{os.getuid()}\n")
    group.write_text(f"{os.getgid()}\n")
    monkeypatch.setattr(unix_door, "OVERFLOW", (user, group))
    peer = await admitted(UnixDoor(Access(operators=(OURS,))))
    assert (peer.role, peer.master) == (Role.OBSERVER, False)
    assert f"The daemon runs as uid {os.getuid()}, which may be anybody" in caplog.text


async def test_without_a_word_from_the_kernel_that_user_is_the_usual_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(unix_door, "OVERFLOW", (tmp_path / "none", tmp_path / "none"))
    monkeypatch.setattr(os, "getuid", lambda: 65_534)
    assert not (await admitted(UnixDoor(Access(), masters=(65_534,)))).master
    monkeypatch.setattr(unix_door, "UNNAMED", 1)
    assert UnixDoor(Access(), masters=(65_534,))._role(Credentials(1, 65_534, frozenset())) is Role.OPERATOR


async def test_a_name_cannot_play_tricks_on_a_terminal(path: Path) -> None:
    about = About(arm="", driver="", rate_hz=30.0, joints=(), groups={}, emg="", lease_max=1.0)
    async with Server(arm_methods(Room(Inbox(), about)), path), plugged(path) as plug:
        plug.ask(1, "hello", "\x1b[2Jroot")
        assert "cannot be printed" in await said(plug)
        plug.ask(2, "hello", "Zoë")
        assert await said(plug) == "{'session': 1, 'role': 'operator'}"


async def test_a_token_is_not_echoed_where_none_is_wanted(path: Path) -> None:
    about = About(arm="", driver="", rate_hz=30.0, joints=(), groups={}, emg="", lease_max=1.0)
    async with Server(arm_methods(Room(Inbox(), about)), path), plugged(path) as plug:
        plug.ask(1, "authenticate", None, "very secret")
        assert await said(plug) == "this connection has been let in already, as operator"
        plug.ask(2, "authenticate", None, ["very secret"])
        assert await said(plug) == "token must be a text."
        plug.ask(3, "challenge")
        assert await said(plug) == "this connection has been let in already, as operator"


async def test_who_is_connected_can_be_asked(path: Path) -> None:
    about = About(arm="", driver="", rate_hz=30.0, joints=(), groups={}, emg="", lease_max=1.0)
    room = Room(Inbox(), about)
    async with Server(arm_methods(room), path) as server, plugged(path) as plug, plugged(path) as other:
        room.sessions = lambda: server.sessions
        other.ask(1, "hello", "other")
        await other.next()
        plug.ask(1, "list_clients")
        answer = await plug.next()
        assert isinstance(answer, Response)
        same: dict[str, Value] = {"user": f"uid {os.getuid()}", "role": "operator"}
        same |= {"replaced_frames": 0, "dropped_events": 0}
        assert answer.result == [
            {"session": 1, "name": f"pid {os.getpid()}", **same},
            {"session": 2, "name": "other", **same},
        ]


async def test_one_user_takes_no_more_than_its_share(path: Path) -> None:
    bounds = Bounds(per_user=2)
    async with strict(path, bounds=bounds), plugged(path) as first, plugged(path) as second:
        for plug in (first, second):
            plug.ask(1, "double", 1)
            await plug.next()
        async with plugged(path) as third:
            third.ask(1, "double", 1)
            assert f"uid {os.getuid()} has 2 connections; no more fit" in await said(third)
            assert f"uid {os.getuid()} has 2 connections; no more fit" in await said(third)
            assert await third.next() is None
        second.writer.close()
        await asyncio.sleep(0.1)
        async with plugged(path) as fourth:
            fourth.ask(1, "double", 1)
            assert await said(fourth) == "2.0"


async def test_observers_cannot_keep_operators_out(path: Path) -> None:
    bounds = Bounds(clients=3, reserved=2)
    async with strict(path, bounds=bounds), plugged(path) as looking:
        looking.ask(1, "double", 1)
        await looking.next()
        async with plugged(path) as another:
            assert await said(another) == "1 clients are connected; no more fit."
    ours = strict(path, bounds=bounds, masters=frozenset((os.getuid(),)))
    async with ours, plugged(path) as one, plugged(path) as two, plugged(path) as three:
        for plug in (one, two, three):
            plug.ask(1, "move")
            assert await said(plug) == "moved"
