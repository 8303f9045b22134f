"""A client that leaves in the very moment in which its collection begins."""

import asyncio
from types import SimpleNamespace
from typing import cast

from bentod.desk import Desk
from bentod.emg.live.recogniser import Recogniser
from bentod.frames import Frame
from bentod.inbox import Inbox
from bentod.serve.emg_methods import EmgMethods
from bentod.serve.room import About, Room
from tests.emg.live.test_recogniser import Rig


def desk(recogniser: Recogniser) -> Desk:
    found = SimpleNamespace(recognition=recogniser, collect=lambda one: recogniser.collect(one, 0))
    return cast("Desk", found)


async def test_no_collection_goes_on_for_whoever_left_while_it_began() -> None:
    recogniser, inbox = Rig().recogniser, Inbox()
    methods = EmgMethods(Room(inbox, About("arm", "sim", 30.0, (), {}, "", 1.0)))
    task = asyncio.create_task(methods._collected([], 1.0, 1.0, 1))
    await asyncio.sleep(0)
    seam = inbox.take()
    seam.serve(desk(recogniser))
    seam.answer(cast("Frame", None))
    while recogniser.collection is None:
        inbox.take().serve(desk(recogniser))
        await asyncio.sleep(0)
    task.cancel()  # it was carried out, and not answered yet
    await asyncio.wait([task])
    inbox.take().serve(desk(recogniser))
    assert recogniser.collection is None
