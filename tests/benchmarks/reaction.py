"""How many ticks lie between a request's arrival and the write that carries it out, at the servo itself."""

import asyncio
import random
from collections import Counter
from collections.abc import AsyncIterator, Iterator
from contextlib import ExitStack, asynccontextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from unittest import mock

from bentod.client import Client
from bentod.messages import Message
from bentod.serve.requests import Requests
from bentod.tick import Controller
from sim import clock
from sim.dynamixel import tables1 as tables
from sim.dynamixel.cells import Refusal
from sim.dynamixel.device import Device
from tests import rig
from tests.benchmarks.harness import Row, at_most, main
from tests.rig import number, quiet_config, running, state

JOINT, SERVO = "wrist_flexion", 4
FAR = 1.5
"""Rad: where the joint is sent, to and fro; it is stopped long before it is there."""

PERIOD = 1 / 30  # s
PAIRS = 600  # of a move and a pause at random phases
EDGES = 200  # of them at the very moment at which a tick is due
TURNS = 12
"""Turns of the event loop around the edge of a tick; to read and decode a request takes a few."""


class Witness:
    """Sees ticks begin, requests arrive, and goals reach the servo."""

    def __init__(self) -> None:
        self.begun = 0  # ticks
        self.arrived = 0  # ticks begun when the newest request did
        self.changed = 0  # ticks begun when the servo was first given another goal than before
        self._goal = b""

    @property
    def waited(self) -> int:
        """Ticks from the one under way when the newest request arrived to the one that carried it out."""
        assert self.changed, "the servo was told nothing new"
        return self.changed - self.arrived

    def request(self) -> None:
        """A request has been read from the socket."""
        self.arrived, self.changed = self.begun, 0

    def goal(self, goal: bytes) -> None:
        """The servo was given a goal: position and speed, as bytes."""
        if goal != self._goal and not self.changed:
            self.changed = self.begun
        self._goal = goal


class LateClock(clock.VirtualClock):
    """Wakes its sleepers some turns after their deadline.

    In virtual time nothing can happen in the turns just before a tick. On a real loop a request may be on its
    way through them when the tick begins; with this clock a request that is sent at the deadline is.
    """

    async def sleep_until(self, deadline: float) -> None:
        """Return `TURNS` / 2 turns after `deadline` (s)."""
        await super().sleep_until(deadline)
        await _turns(TURNS // 2)


@asynccontextmanager
async def watching() -> AsyncIterator[tuple[Witness, Client]]:
    """An arm that only clients move, and what happens inside."""
    witness = Witness()
    with ExitStack() as stack:
        stack.enter_context(mock.patch.object(rig, "VirtualClock", LateClock))
        stack.enter_context(mock.patch.object(Controller, "tick", _seen_tick(witness)))
        stack.enter_context(mock.patch.object(Requests, "take", _seen_take(witness)))
        stack.enter_context(mock.patch.object(Device, "write", _seen_write(witness)))
        folder = stack.enter_context(TemporaryDirectory())
        async with running(quiet_config(), Path(folder, "bentod.sock")) as arm:
            yield witness, arm


def _seen_tick(witness: Witness) -> object:
    original = Controller.tick

    async def tick(self: Controller, due: float, gap: bool) -> None:
        witness.begun += 1
        await original(self, due, gap)

    return tick


def _seen_take(witness: Witness) -> object:
    original = Requests.take

    def take(self: Requests, message: Message) -> None:
        witness.request()
        original(self, message)

    return take


def _seen_write(witness: Witness) -> object:
    original = Device.write

    def write(self: Device, address: int, data: bytes) -> Refusal:
        if address == tables.GOAL.address and self.get(tables.ID) == SERVO:
            witness.goal(data)
        return original(self, address, data)

    return write


async def waits(chosen: random.Random, pairs: int, edge: bool) -> Counter[int]:
    """How many requests waited for how many ticks."""
    seen: Counter[int] = Counter()
    async with watching() as (witness, arm):
        for pair in range(pairs):
            way = FAR if pair % 2 else -FAR
            await _phase(arm, chosen, edge)
            await arm.call("move", joint=JOINT, position=way, lease_s=5.0)
            seen[witness.waited] += 1
            await asyncio.sleep(3 * PERIOD)  # so that it moves, and the pause gives it another goal
            await _phase(arm, chosen, edge)
            await arm.call("pause", joints=JOINT)
            seen[witness.waited] += 1
            await arm.call("stop")
            await arm.call("pause", on=False)
    return seen


async def _phase(arm: Client, chosen: random.Random, edge: bool) -> None:
    """Wait for a random moment, or for a random turn of the loop about the beginning of a tick."""
    if edge:
        frame = await state(arm)
        await clock.VirtualClock().sleep_until(number(frame, "time") + PERIOD + PERIOD)
        await _turns(chosen.randrange(TURNS))
    else:
        await asyncio.sleep(chosen.uniform(1, 2) * PERIOD)


async def _turns(count: int) -> None:
    for _ in range(count):
        await asyncio.sleep(0)


def rows() -> Iterator[Row]:
    """A few seconds."""
    for name, pairs, edge in (("at random phases", PAIRS, False), ("at the edge of a tick", EDGES, True)):
        seen = clock.run(waits(random.Random(1), pairs, edge))
        yield at_most(f"from request to the servo's write, {name}, worst", max(seen), "ticks", 1)
        yield Row("  requests (pause, move)", seen.total(), "")


if __name__ == "__main__":
    main("reaction", rows())
