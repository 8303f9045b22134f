"""The server: one client's mistakes, slowness or end are nobody else's."""

import asyncio
import logging
import os
from pathlib import Path

import pytest

from bentod.errors import Refused
from bentod.frames import Value
from bentod.messages import Notification, Response, encode_notification, encode_request
from bentod.serve.session import Bounds, Session
from tests.serve.helpers import event, frame, plugged, serving


def error_of(message: object) -> dict[str, Value]:
    assert isinstance(message, Response)
    assert isinstance(message.error, dict)
    return message.error


def is_gone(path: Path) -> bool:
    return not os.path.lexists(path)


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "bentod.sock"


async def test_a_request_is_answered(path: Path) -> None:
    async with serving(path), plugged(path) as plug:
        plug.ask(7, "double", 4)
        assert await plug.next() == Response(7, None, 8.0)


async def test_a_quick_request_overtakes_a_slow_one(path: Path) -> None:
    async with serving(path), plugged(path) as plug:
        plug.ask(1, "wait", 5)
        plug.ask(2, "double", 1)
        assert [await plug.next(), await plug.next()] == [Response(2, None, 2.0), Response(1, None, 5.0)]


async def test_many_requests_at_once_are_all_answered(path: Path) -> None:
    async with serving(path), plugged(path) as plug:
        for id_ in range(500):
            plug.ask(id_, "double", 1)
        answers = [await plug.next() for _ in range(500)]
    assert answers == [Response(id_, None, 2.0) for id_ in range(500)]


async def test_too_many_requests_in_flight_are_refused(path: Path) -> None:
    async with serving(path, bounds=Bounds(in_flight=2)), plugged(path) as plug:
        for id_ in range(3):
            plug.ask(id_, "wait", 1)
        assert error_of(await plug.next())["code"] == "refused"
        assert await plug.next() == Response(0, None, 1.0)


async def test_a_bad_request_keeps_the_connection(path: Path) -> None:
    async with serving(path), plugged(path) as plug:
        plug.ask(1, "double", 40)
        assert error_of(await plug.next()) == {
            "code": "bad_request",
            "message": "number = 40 rad is above its maximum, 10 rad.",
            "field": "number",
        }
        plug.ask(2, "duble", 4)
        assert "did you mean 'double'?" in str(error_of(await plug.next())["message"])
        plug.ask(3, "refuse")
        assert error_of(await plug.next())["code"] == "refused"
        plug.ask(4, "double", 4)
        assert await plug.next() == Response(4, None, 8.0)


async def test_a_bug_is_logged_and_keeps_the_connection(path: Path, caplog: pytest.LogCaptureFixture) -> None:
    async with serving(path), plugged(path) as plug:
        plug.ask(1, "break_down")
        assert error_of(await plug.next())["code"] == "internal"
        plug.ask(2, "double", 4)
        assert await plug.next() == Response(2, None, 8.0)
    assert "ZeroDivisionError: oops" in caplog.text


@pytest.mark.parametrize(
    "garbage", [b"\xc1", b"\x90", b"\x00", b"GET / HTTP/1.1\r\n", b"\x94\x01\x01\xc0\xc0"]
)
async def test_bad_framing_is_explained_and_closes_the_connection(path: Path, garbage: bytes) -> None:
    async with serving(path), plugged(path) as bystander:
        async with plugged(path) as plug:
            plug.writer.write(encode_request(1, "double", [1]) + garbage)
            messages = [await plug.next(), await plug.next()]
            complaint = next(m for m in messages if isinstance(m, Notification))
            assert complaint.method == "error"
            assert "bad_framing" in str(complaint.params)
            assert Response(1, None, 2.0) in messages
            assert await plug.next() is None
        bystander.ask(1, "double", 1)
        assert await bystander.next() == Response(1, None, 2.0)


async def test_a_request_without_id_is_carried_out_and_not_answered(path: Path) -> None:
    async with serving(path), plugged(path) as plug:
        plug.writer.write(encode_notification("refuse", []) + encode_notification("double", [1]))
        plug.ask(1, "double", 4)
        assert await plug.next() == Response(1, None, 8.0)


async def test_subscribers_get_frames_at_their_own_rate(path: Path) -> None:
    async with serving(path) as server, plugged(path) as plug:
        plug.ask(0, "subscribe", "state", 10)
        assert isinstance(await plug.next(), Response)
        ticks = []
        for tick in range(10):
            server.publish_state(frame(tick))
            await asyncio.sleep(1 / 30)
        for _ in range(4):
            message = await plug.next()
            assert isinstance(message, Notification)
            match message.params:
                case [{"tick": int(tick)}]:
                    ticks.append(tick)
        assert ticks == [0, 3, 6, 9]
        plug.ask(1, "unsubscribe", "state")
        assert await plug.next() == Response(1, None, None)
        server.publish_state(frame(30))
        plug.ask(2, "double", 1)
        assert await plug.next() == Response(2, None, 2.0)


async def test_events_reach_those_who_asked_for_them(path: Path) -> None:
    async with serving(path) as server, plugged(path) as listener, plugged(path) as other:
        listener.ask(0, "subscribe", "events")
        await listener.next()
        server.publish_event(event(1))
        heard = await listener.next()
        assert isinstance(heard, Notification)
        assert heard.method == "event"
        other.ask(1, "double", 1)
        assert await other.next() == Response(1, None, 2.0)


async def test_a_stuck_client_is_dropped_and_others_miss_nothing(
    path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    bounds = Bounds(unsent=4096, stuck=2.0)
    async with serving(path, bounds=bounds) as server, plugged(path) as stuck, plugged(path) as awake:
        stuck.writer.transport.pause_reading()  # type: ignore[attr-defined]
        stuck.ask(0, "subscribe", "state", 30)
        awake.ask(0, "subscribe", "state", 30)
        assert isinstance(await awake.next(), Response)
        for tick in range(300):
            server.publish_state(frame(tick, meta="x" * 2000))
            message = await awake.next()
            assert isinstance(message, Notification)
            await asyncio.sleep(1 / 30)
        assert len(server.sessions) == 1
    assert [record.levelno for record in caplog.records] == [logging.WARNING]
    assert "has not read for 2 s" in caplog.text


async def test_a_slow_client_gets_the_newest_frame_and_what_it_missed_is_counted(path: Path) -> None:
    async with serving(path, bounds=Bounds(unsent=4096, notices=8)) as server, plugged(path) as slow:
        slow.ask(0, "subscribe", "state", 500)
        slow.ask(1, "subscribe", "events")
        assert [await slow.next(), await slow.next()] == [Response(0, None, None), Response(1, None, None)]
        slow.writer.transport.pause_reading()  # type: ignore[attr-defined]
        for tick in range(100):
            server.publish_state(frame(tick, meta="x" * 2000))
            server.publish_event(event(tick))
            await asyncio.sleep(1 / 30)
        (session,) = server.sessions
        assert session.replaced_frames > 50
        assert session.dropped_events > 50
        slow.writer.transport.resume_reading()  # type: ignore[attr-defined]
        last = 0
        while last < 99:
            message = await slow.next()
            assert isinstance(message, Notification)
            match message.params:
                case [{"tick": int(tick)}]:
                    assert tick == 0 or tick > last
                    last = tick


async def test_a_client_that_never_reads_its_answers_is_dropped(path: Path) -> None:
    bounds = Bounds(unsent=4096, stuck=2.0)
    async with serving(path, bounds=bounds) as server, plugged(path) as plug:
        plug.writer.transport.pause_reading()  # type: ignore[attr-defined]
        for id_ in range(3000):
            plug.ask(id_, "double", 1)
        await asyncio.sleep(4)
        assert server.sessions == ()


async def test_what_a_client_held_ends_with_it(path: Path) -> None:
    ended = []

    async def hold(session: Session) -> Value:
        """Hold on to something."""
        session.on_close(lambda: ended.append(session.client))
        session.once("same", lambda: ended.append("once"))
        session.once("same", lambda: ended.append("twice"))
        session.client = "researcher"
        return [session.peer.name, session.peer.user]

    async with serving(path, hold) as server:
        async with plugged(path) as plug:
            plug.ask(1, "hold")
            assert await plug.next() == Response(1, None, [f"pid {os.getpid()}", f"uid {os.getuid()}"])
            assert ended == []
        await asyncio.sleep(0.1)
        assert ended == ["once", "researcher"]
        assert server.sessions == ()


async def test_the_last_request_of_a_client_that_leaves_is_still_carried_out(path: Path) -> None:
    done = []

    async def stop(session: Session) -> Value:
        """Stop at the next tick."""
        await asyncio.sleep(1 / 30)
        done.append("stop")
        return None

    async with serving(path, stop):
        async with plugged(path) as plug:
            plug.ask(1, "stop")
            plug.writer.close()
        await asyncio.sleep(0.1)
        assert done == ["stop"]


async def test_a_client_that_leaves_does_not_wait_for_ever_for_its_requests(path: Path) -> None:
    async with serving(path) as server:
        async with plugged(path) as plug:
            plug.ask(1, "wait", 100)
            await asyncio.sleep(0.1)
        await asyncio.sleep(1.5)
        assert server.sessions == ()


async def test_a_clean_up_that_fails_is_logged_and_the_next_one_runs(
    path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    ended = []

    async def hold(session: Session) -> Value:
        """Hold on to something."""
        session.on_close(lambda: ended.append("first"))
        session.on_close(lambda: 1 // 0)
        return None

    async with serving(path, hold):
        async with plugged(path) as plug:
            plug.ask(1, "hold")
            await plug.next()
        await asyncio.sleep(0.1)
    assert ended == ["first"]
    assert "ZeroDivisionError" in caplog.text


async def test_clients_are_let_go_when_the_server_ends(path: Path) -> None:
    async with serving(path) as server:
        reader, writer = await asyncio.open_unix_connection(path)
        writer.write(encode_request(1, "wait", [50]))
        await asyncio.sleep(0.1)
        assert len(server.sessions) == 1
    assert await reader.read() == b""
    assert is_gone(path)
    writer.close()
    await writer.wait_closed()


async def test_what_the_body_raises_comes_out_unchanged(path: Path) -> None:
    with pytest.raises(Refused, match="not now"):
        async with serving(path):
            raise Refused("not now")
    assert is_gone(path)


async def test_a_second_server_is_refused(path: Path) -> None:
    async with serving(path), plugged(path) as plug:
        with pytest.raises(Refused, match="already serves"):
            await serving(path).__aenter__()
        plug.ask(1, "double", 1)
        assert await plug.next() == Response(1, None, 2.0)


async def test_clients_beyond_the_bound_are_sent_away(path: Path) -> None:
    async with serving(path, bounds=Bounds(clients=1)), plugged(path) as first:
        first.ask(1, "double", 1)
        await first.next()
        async with plugged(path) as second:
            message = await second.next()
            assert isinstance(message, Notification)
            assert "1 clients are connected" in str(message.params)
            assert await second.next() is None


async def test_a_client_can_be_notified_alone(path: Path) -> None:
    async def greet(session: Session) -> Value:
        """Send something else first."""
        session.notify("hello", [session.id])
        return None

    async with serving(path, greet), plugged(path) as plug:
        plug.ask(1, "greet")
        messages = [await plug.next(), await plug.next()]
        assert Notification("hello", [1]) in messages
