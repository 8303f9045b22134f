"""Requests that wait for the seam between two ticks."""

import asyncio

import pytest

from bentod.desk import Desk
from bentod.errors import BadRequest, Refused
from bentod.frames import Frame
from bentod.inbox import Answer, Inbox
from tests.fakes import Bench, at, desk_of
from tests.serve.helpers import frame


@pytest.fixture
def desk() -> Desk:
    return desk_of()


@pytest.fixture
async def inbox() -> Inbox:
    return Inbox()


async def left(inbox: Inbox, *names: str) -> list[asyncio.Task[Answer[str]]]:
    """Requests for the given answers, waiting."""

    def request(name: str) -> asyncio.Task[Answer[str]]:
        return asyncio.create_task(inbox.ask(lambda desk: name))

    tasks = [request(name) for name in names]
    await asyncio.sleep(0)
    return tasks


def refuse(desk: Desk) -> str:
    raise BadRequest("There is no such joint.", "joint")


async def test_a_request_is_answered_after_the_write_with_its_result_and_the_ticks_frame(
    inbox: Inbox, desk: Desk
) -> None:
    (asked,) = await left(inbox, "done")
    seam = inbox.take()
    seam.serve(desk)
    await asyncio.sleep(0)
    assert not asked.done()
    published: Frame = frame(7)
    seam.answer(published)
    assert await asked == Answer("done", published)


async def test_requests_are_carried_out_in_the_order_in_which_they_came(inbox: Inbox, desk: Desk) -> None:
    order: list[int] = []
    for number in range(5):
        inbox.post(lambda desk, number=number: order.append(number))  # type: ignore[misc]
    inbox.take().serve(desk)
    assert order == [0, 1, 2, 3, 4]


async def test_a_refusal_is_told_at_once_and_stops_no_other_request(inbox: Inbox, desk: Desk) -> None:
    refused = asyncio.create_task(inbox.ask(refuse))
    (other,) = await left(inbox, "done")
    seam = inbox.take()
    seam.serve(desk)
    with pytest.raises(BadRequest, match="no such joint"):
        await refused
    seam.answer(frame(1))
    assert (await other).result == "done"


async def test_each_request_belongs_to_one_tick_only(inbox: Inbox, desk: Desk) -> None:
    (early,) = await left(inbox, "early")
    first = inbox.take()
    (late,) = await left(inbox, "late")
    first.serve(desk)
    first.answer(frame(1))
    await early
    assert not late.done()
    second = inbox.take()
    second.serve(desk)
    second.answer(frame(2))
    assert (await late).frame.tick == 2


async def test_a_tick_that_breaks_refuses_what_it_had_not_answered(inbox: Inbox, desk: Desk) -> None:
    refused = asyncio.create_task(inbox.ask(refuse))
    served, other = await left(inbox, "served", "other")
    seam = inbox.take()
    seam.serve(desk)
    seam.refuse("the tick broke")
    for asked in (served, other):
        with pytest.raises(Refused, match="the tick broke"):
            await asked
    with pytest.raises(BadRequest):
        await refused


async def test_who_does_not_wait_any_more_is_not_obeyed(inbox: Inbox, desk: Desk) -> None:
    done: list[str] = []
    asked = asyncio.create_task(inbox.ask(lambda desk: done.append("moved")))
    await asyncio.sleep(0)
    asked.cancel()
    await asyncio.wait([asked])
    seam = inbox.take()
    seam.serve(desk)
    seam.answer(frame(1))
    assert done == []


async def test_what_is_posted_is_carried_out_although_nobody_waits(inbox: Inbox, desk: Desk) -> None:
    inbox.post(lambda desk: desk.set_meta("left"))
    inbox.post(refuse)
    seam = inbox.take()
    seam.serve(desk)
    seam.answer(frame(1))
    assert desk.meta == "left"


async def test_a_closed_inbox_refuses_what_waits_and_all_that_comes(inbox: Inbox) -> None:
    (waiting,) = await left(inbox, "early")
    inbox.close("the daemon is ending")
    (late,) = await left(inbox, "late")
    for asked in (waiting, late):
        with pytest.raises(Refused, match="the daemon is ending"):
            await asked
    inbox.post(refuse)


async def test_a_request_reaches_the_joints_in_the_next_tick() -> None:
    bench = Bench()
    await bench.controller.run(3)
    asked = asyncio.create_task(bench.inbox.ask(lambda desk: desk.set_meta("hello")))
    await bench.controller.run(1)
    answer = await asked
    assert (answer.frame.tick, answer.frame.meta) == (3, "hello")


async def test_all_who_ask_for_a_stop_before_a_seam_share_one(inbox: Inbox, desk: Desk) -> None:
    desk.watch(at(0.0, 0.0), 0.0)
    stops = [asyncio.create_task(inbox.stop(f"client {n}")) for n in range(3)]
    await asyncio.sleep(0)
    seam = inbox.take()
    later = asyncio.create_task(inbox.stop("a later one"))
    await asyncio.sleep(0)
    desk.pause((0, 1), False)
    desk.journal.take()
    seam.serve(desk)
    assert [event.text for event in desk.journal.take()] == ["stopped by client 0"]
    seam.answer(frame(1))
    await asyncio.gather(*stops)
    assert not later.done()
    inbox.take().answer(frame(2))
    await later


async def test_a_stop_comes_last_and_so_has_the_last_word(inbox: Inbox, desk: Desk) -> None:
    stop = asyncio.create_task(inbox.stop("a client"))
    await asyncio.sleep(0)
    inbox.post(lambda desk: desk.pause((0, 1), False))
    seam = inbox.take()
    seam.serve(desk)
    seam.answer(frame(1))
    await stop
    assert desk.modes.arm == "paused"


async def test_a_stop_is_answered_as_done_when_the_tick_breaks_or_the_daemon_ends(inbox: Inbox) -> None:
    broken = asyncio.create_task(inbox.stop("a client"))
    await asyncio.sleep(0)
    inbox.take().refuse("internal error in the tick")
    await broken
    waiting = asyncio.create_task(inbox.stop("a client"))
    await asyncio.sleep(0)
    inbox.close("the daemon is ending")
    await waiting
    await inbox.stop("a client")


async def test_a_stop_is_carried_out_although_whoever_asked_has_left(inbox: Inbox, desk: Desk) -> None:
    desk.watch(at(0.0, 0.0), 0.0)
    desk.pause((0, 1), False)
    stop = asyncio.create_task(inbox.stop("a client"))
    await asyncio.sleep(0)
    stop.cancel()
    await asyncio.sleep(0)
    inbox.take().serve(desk)
    assert desk.modes.arm == "paused"
