"""Faults of clients, of the daemon's process and of what it computes."""

import asyncio
import socket
from unittest import mock

import numpy as np
from numpy.typing import NDArray

from bentod.client import Client
from bentod.contracts import Features, Vector
from bentod.endpoint import RpcError
from bentod.learn.group import Group
from bentod.learn.horde import Horde
from bentod.messages import encode_request
from bentod.mind import Mind
from sim.clock import EPOCH, VirtualClock
from tests.system.campaign.bus_faults import DEAF, HEARD, LET_GO
from tests.system.campaign.case import Case
from tests.system.campaign.outcome import ANSWER, LEASE, TICK, Bound
from tests.system.campaign.rig import BY_ITSELF, DRIVEN, JOINTS, RELEASED, Rig

BLOCKED = 0.2
"""s for which one callback keeps the event loop."""

STOPPED = 2.0
"""s"""

GONE = Bound(TICK + ANSWER, "tick 33 + answer 320")

HELD_UP = Bound(BLOCKED + HEARD + ANSWER, "blocked 200 + tick 33 + lease 200 + answer 320")

BROKEN = Bound(TICK + ANSWER, "tick 33 + answer 320")


async def vanishes(rig: Rig) -> None:
    assert rig.operator
    await rig.operator.vanish()


async def hangs(rig: Rig) -> float:
    return rig.let_go()


async def fights(rig: Rig) -> None:
    """Another client wants the joint the other way, as often as it can."""

    async def insist() -> None:
        rival = await rig.lifted.enter_async_context(Client.connect(rig.socket))
        while rig.operator and rig.operator.last > rig.now - LEASE / 2:
            wanted = -rig.operator.velocities[JOINTS[DRIVEN[0]]]
            try:
                await rival.call("move", joint=JOINTS[DRIVEN[0]], velocity=wanted, lease_s=0.05)
            except RpcError as error:
                rig.said.texts.append(str(error))

    task = asyncio.create_task(insist())
    rig.lifted.callback(task.cancel)


async def reads_nothing(rig: Rig) -> None:
    """A client that wants every frame and never reads one."""
    stuck = rig.lifted.enter_context(socket.socket(socket.AF_UNIX))
    stuck.connect(str(rig.socket))
    stuck.sendall(encode_request(1, "subscribe", {"topic": "state", "rate_hz": 500.0}))


async def blocked(rig: Rig) -> float:
    """The operator's last word is said just before."""
    last = rig.let_go()
    rig.loop.block(BLOCKED)
    return last


async def stopped(rig: Rig) -> float:
    """The operator lets go; a request that it sent before waits in the socket until the daemon goes on."""
    old = rig.lifted.enter_context(socket.socket(socket.AF_UNIX))
    old.connect(str(rig.socket))
    await asyncio.sleep(0.05)
    rig.let_go()
    named = {"joint": JOINTS[DRIVEN[0]], "velocity": 0.7}
    old.sendall(encode_request(1, "move", named))
    rig.loop.block(STOPPED)
    return rig.now - STOPPED


async def wall_clock_jumps(rig: Rig) -> None:
    """Five hours back."""

    def wall(clock: VirtualClock) -> float:
        return EPOCH + clock.now() - 5 * 3600

    rig.lifted.enter_context(mock.patch.object(VirtualClock, "wall", wall))


async def learner_raises(rig: Rig) -> None:
    def step(*_: object) -> None:
        raise ArithmeticError("singular")

    rig.lifted.enter_context(mock.patch.object(Horde, "step", step))


async def learner_diverges(rig: Rig) -> None:
    """The weights of all learners grow in each step, until they are no numbers any more."""
    step = Group.step

    def grow(
        group: Group, features: Features, cumulants: NDArray[np.float64], gamma: float, lam: float
    ) -> Vector:
        with np.errstate(over="ignore", invalid="ignore"):
            group._lazy.weights[:] *= -1e60
        return step(group, features, cumulants, gamma, lam)

    rig.lifted.enter_context(mock.patch.object(Group, "step", grow))


async def tick_breaks(rig: Rig) -> None:
    """Memory runs out in the middle of a tick."""

    def assist(*_: object) -> None:
        raise MemoryError

    rig.lifted.enter_context(mock.patch.object(Mind, "assist", assist))


CASES = (
    Case("client vanishes", GONE, vanishes),
    Case("client hangs", LET_GO, hangs),
    Case("a second client wants the joint", LET_GO, fights, told="holds it", lasts=1.0),
    Case("a subscriber reads nothing", LET_GO, reads_nothing, lasts=1.0),
    Case("event loop blocked for 200 ms", HELD_UP, blocked, told="missed|late"),
    Case("daemon held up for 2 s", DEAF, stopped, told="missed|held up|late", recovery=(BY_ITSELF, RELEASED)),
    Case("wall clock 5 h back", LET_GO, wall_clock_jumps, lasts=1.0),
    Case("learner raises", LET_GO, learner_raises, told="singular|broke", lasts=1.0, assisted=True),
    Case("learner diverges to infinity", LET_GO, learner_diverges, told="anew", lasts=1.0, assisted=True),
    Case("memory runs out in a tick", BROKEN, tick_breaks, told="MemoryError", recovery=(RELEASED,)),
)
