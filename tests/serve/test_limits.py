"""What one client may take is bounded; beyond it hears why, and nobody else notices."""

import asyncio
import os
import resource
import socket
from collections.abc import Iterator
from contextlib import AsyncExitStack, contextmanager
from dataclasses import replace
from pathlib import Path

import pytest

from bentod.bucket import Bucket, Seldom
from bentod.frames import Value
from bentod.messages import encode_notification, encode_request
from bentod.serve.line import Line
from bentod.serve.peers import Peer
from bentod.serve.requests import FLOOD
from bentod.serve.session import Bounds, Session
from bentod.serve.unix_door import UnixDoor
from tests.serve.doors import said
from tests.serve.helpers import Plug, plugged, serving


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "bentod.sock"


def now() -> float:
    return asyncio.get_running_loop().time()


@pytest.mark.parametrize(
    ("hostile", "words"),
    [
        (b"\x94\x00\x01\xa6double\xdd\xff\xff\xff\xff", "more than 256 values"),
        (b"\x94\x00\x01\xa6double\xdc\x00\xfd", "more than 256 values"),
        (b"\x94\x00\x01\xa6double\xdf\x00\x00\x00\x80", "more than 256 values"),
        (b"\x94\x00\x01\xa6double" + b"\x91" * 16, "nested more than 16 deep"),
        (b"\x94\x00\x01\xa6double" + b"\x81\xa1a" * 16, "nested more than 16 deep"),
        (b"\x94\x00\x01\xdb\xff\xff\xff\xff", "longer than 16384 bytes"),
        (b"\x94\x00\x01\xa6double\xc6\x00\x01\x00\x00", "longer than 16384 bytes"),
        (b"\x94\x00\x01\xa6double\x91\xc7\x00\x05", "0xc7 begins an extension"),
        (b"\x94\x00\x01\xa6double\x91\xd6\xff\x00\x00\x00\x00", "0xd6 begins an extension"),
        (b"\x94\x00\x01\xa6double\x91\x81\x01\x02", "int is not allowed for map key"),
        (b"\x94\x00\x01\xa6double\x91\x81\xc4\x01a\x02", "keys of a map must be texts"),
        (b"\x94\x00\x01\xa6double\x91\x81\x90\x02", "list is not allowed for map key"),
        (b"\x94\x00\x01\xa2\xff\xfe\x90", "not a message"),
    ],
)
async def test_a_message_beyond_its_bounds_is_refused_and_says_which(
    path: Path, hostile: bytes, words: str
) -> None:
    async with serving(path), plugged(path) as plug, plugged(path) as other:
        plug.writer.write(hostile)
        assert words in await said(plug)
        assert await plug.next() is None
        other.ask(1, "double", 1)
        assert await said(other) == "2.0"


@pytest.mark.parametrize(
    "begun", [b"\x94", b"\x94\x00\x01\xa6dou", b"\x94\x00\x01\xa6double\x91\xda\x30\x00"]
)
async def test_a_message_that_never_ends_is_given_up_after_5_s(path: Path, begun: bytes) -> None:
    async with serving(path) as server, plugged(path) as plug:
        plug.writer.write(begun)
        assert await said(plug) == "A message has begun and did not end within 5 s."
        assert 4.9 < now() < 5.1
        assert await plug.next() is None
        await asyncio.sleep(0.1)
        assert server.sessions == ()


async def test_a_message_that_drips_in_is_given_up_however_often_it_drips(path: Path) -> None:
    async with serving(path), plugged(path) as plug:
        for byte in encode_request(1, "double", [4])[:5]:
            plug.writer.write(bytes([byte]))
            await asyncio.sleep(0.9)
        assert "did not end within 5 s" in await said(plug)
        assert now() < 5.1


async def test_each_message_has_its_own_5_s_and_silence_between_them_is_free(path: Path) -> None:
    async with serving(path), plugged(path) as plug:
        for id_ in range(3):
            for byte in encode_request(id_, "double", [id_]):
                plug.writer.write(bytes([byte]))
                await asyncio.sleep(0.4)
            assert await said(plug) == str(2.0 * id_)
            await asyncio.sleep(100)


async def test_the_end_of_one_message_and_the_begin_of_the_next_may_come_together(path: Path) -> None:
    async with serving(path), plugged(path) as plug:
        whole = encode_request(1, "double", [1])
        for _ in range(6):
            plug.writer.write(whole[5:] if now() else whole)
            plug.writer.write(whole[:5])
            assert await said(plug) == "2.0"
            await asyncio.sleep(4)
        assert now() > 20


async def test_a_client_that_leaves_in_the_middle_of_a_message_is_forgotten(path: Path) -> None:
    async with serving(path) as server:
        async with plugged(path) as plug:
            plug.writer.write(b"\x94\x00\x01\xa6dou")
            await asyncio.sleep(0.1)
            assert len(server.sessions) == 1
        await asyncio.sleep(0.1)
        assert not server.sessions


async def one_after_the_other(plug: Plug, number: int) -> float:
    """How long (s) so many requests take, each asked when the one before is answered."""
    begin = now()
    for id_ in range(number):
        plug.ask(id_, "double", 1)
        assert await said(plug) == "2.0"
    return now() - begin


async def test_a_client_that_asks_too_often_is_slowed_down_and_not_refused(path: Path) -> None:
    async with serving(path, bounds=Bounds(requests_per_s=100)), plugged(path) as plug:
        assert await one_after_the_other(plug, 25) < 0.01  # a quarter of a second's may come at once
        assert await one_after_the_other(plug, 100) == pytest.approx(1.0, abs=0.05)


async def seated(stack: AsyncExitStack, path: Path) -> Plug:
    """A client that has been answered once."""
    plug = await stack.enter_async_context(plugged(path))
    plug.ask(0, "double", 1)
    assert await said(plug) == "2.0"
    return plug


async def test_a_user_who_asks_too_often_slows_down_its_own_connections_only(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    users = iter(("busy", "busy", "other"))
    admit = UnixDoor.admit

    async def as_somebody(self: UnixDoor, connection: socket.socket) -> tuple[Line, Peer]:
        line, peer = await admit(self, connection)
        return line, replace(peer, user=next(users))

    monkeypatch.setattr(UnixDoor, "admit", as_somebody)
    async with serving(path, bounds=Bounds(requests_per_s=100)), AsyncExitStack() as stack:
        busy, again, other = [await seated(stack, path) for _ in range(3)]
        for id_ in range(1000):
            busy.ask(id_, "double", 1)
        await asyncio.sleep(0.01)
        assert await one_after_the_other(other, 20) < 0.01
        assert await one_after_the_other(again, 5) > 0.3


async def test_a_stop_overtakes_the_requests_that_came_too_often(path: Path) -> None:
    stopped: list[float] = []

    async def stop(session: Session) -> Value:
        """Stop."""
        stopped.append(now())
        return None

    async with serving(path, stop, bounds=Bounds(requests_per_s=10)), plugged(path) as plug:
        for id_ in range(100):
            plug.ask(id_, "double", 1)
        plug.ask(100, "stop")
        await asyncio.sleep(0.01)
        assert len(stopped) == 1


async def test_a_flood_is_read_no_faster_than_ten_times_the_rate(path: Path) -> None:
    heard = 0

    async def stop(session: Session) -> Value:
        """Count."""
        nonlocal heard
        heard += 1
        return None

    rate = 20
    async with serving(path, stop, bounds=Bounds(requests_per_s=rate)), plugged(path) as plug:
        plug.writer.write(encode_notification("stop", []) * 5000)
        await asyncio.sleep(4)
        assert heard <= FLOOD * rate * 5 + 40
        assert heard > 100


async def test_connections_that_are_not_read_do_not_pile_up(path: Path) -> None:
    async with serving(path, bounds=Bounds(clients=2)) as server:
        crowd = [await asyncio.open_unix_connection(path) for _ in range(200)]
        await asyncio.sleep(0.5)
        assert len(server._hosts) <= 40
        for _, writer in crowd:
            writer.transport.abort()
        await asyncio.sleep(2)
        assert not server._hosts


@contextmanager
def out_of_files() -> Iterator[None]:
    """Not one more file descriptor for this process."""
    lowest = os.dup(0)
    os.close(lowest)
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (lowest, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))


async def test_clients_that_come_while_there_are_no_files_are_served_once_there_are(
    path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    async with serving(path), plugged(path) as old:
        old.ask(1, "double", 1)
        await old.next()
        with socket.socket(socket.AF_UNIX) as late:
            late.connect(str(path))  # the kernel keeps it until it is taken
            with out_of_files():
                await asyncio.sleep(10)
                old.ask(2, "double", 2)
                assert await said(old) == "4.0"
            reader, writer = await asyncio.open_unix_connection(sock=late)
            plug = Plug(reader, writer)
            plug.ask(1, "double", 3)
            assert await said(plug) == "6.0"
            writer.close()
            await writer.wait_closed()
    assert caplog.text.count("No connection can be taken now: Too many open files.") == 1


def test_a_bucket_gives_what_it_holds_and_then_at_its_rate() -> None:
    time = 0.0
    bucket = Bucket(10, 3, lambda: time)
    assert [round(bucket.take(), 9) for _ in range(5)] == [0.0, 0.0, 0.0, 0.1, 0.2]
    time = 0.1
    assert bucket.debt() == pytest.approx(0.1)
    time = 100.0
    assert [round(bucket.take(), 9) for _ in range(4)] == [0.0, 0.0, 0.0, 0.1]


def test_what_is_said_seldom_counts_what_was_not_said() -> None:
    time = 0.0
    seldom = Seldom(10, lambda: time)
    assert [seldom.take() for _ in range(3)] == ["", None, None]
    time = 10.0
    assert seldom.take() == " (2 more like it were not logged)"
    time = 20.0
    assert seldom.take() == ""
