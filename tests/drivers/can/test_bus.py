"""The driver over python-can's buses in software, with simulated axes at the other end, in real time.

A real SocketCAN bus or adapter was never at hand.
"""

import asyncio
import math
import random
from collections.abc import AsyncIterator
from contextlib import AsyncExitStack, asynccontextmanager
from dataclasses import replace

import can
import pytest

from bentod.contracts import ArmConfig
from bentod.errors import BusError
from bentod.frames import Command, Freshness, Stop, Value, Velocity
from drivers.can.bus import open_joints, open_link
from drivers.can.joints import CanJoints
from drivers.can.link import Frame
from drivers.can.options import Options
from sim.bento import bento_joints
from sim.can.joints import build_axes
from sim.can.network import Network
from sim.can.options import parse_options
from sim.clock import VirtualClock
from tests.drivers.can.multicast import GROUP, free_port, multicast

pytestmark = pytest.mark.real_time

PERIOD = 1 / 50
JOINT = replace(bento_joints()[2], hardware={"node": 3, "gear_ratio": 8.0})


@pytest.fixture(params=["virtual", "udp_multicast"])
def table(request: pytest.FixtureRequest) -> dict[str, Value]:
    """Options of a bus that nobody else is on."""
    if request.param == "virtual":
        return {"interface": "virtual", "channel": f"test-{random.randrange(1 << 30)}"}
    if why := multicast():
        pytest.skip(f"no multicast on this machine: {why}")
    return {"interface": "udp_multicast", "channel": GROUP, "udp_port": free_port()}


@asynccontextmanager
async def axes(table: dict[str, Value]) -> AsyncIterator[Network]:
    """The far end of the bus."""
    config = ArmConfig((JOINT,), PERIOD, table)
    options = parse_options(config)
    async with open_link(options) as link:
        network = Network(build_axes(config, options), 0, link.send)
        link.listen(network.hear, _fail)
        try:
            yield network
        finally:
            network.close()


@asynccontextmanager
async def arm(table: dict[str, Value]) -> AsyncIterator[tuple[CanJoints, Network]]:
    async with AsyncExitStack() as stack:
        network = await stack.enter_async_context(axes(table))
        config = ArmConfig((JOINT,), PERIOD, table)
        yield await stack.enter_async_context(open_joints(config, VirtualClock())), network


async def run(joints: CanJoints, ticks: int, command: Command | None) -> list[float]:
    """Positions, rad."""
    track = []
    for _ in range(ticks):
        track.append((await joints.read()).joints[0].position)
        await joints.write([command])
        await asyncio.sleep(PERIOD)
    return track


async def test_a_joint_moves_and_stops_over_the_bus(table: dict[str, Value]) -> None:
    async with arm(table) as (joints, _):
        await joints.set_torque([True])
        assert joints.torque() == (True,)
        track = await run(joints, 25, Velocity(0.5))
        assert track[-1] - track[0] > 0.1
        track = await run(joints, 25, Stop())
        assert max(track[-5:]) - min(track[-5:]) < math.radians(0.2)
        state = (await joints.read()).joints[0]
        assert state.voltage == 12.0
        assert state.stop is not None
        await joints.set_torque([False])
        assert joints.torque() == (False,)


async def test_a_controller_that_falls_silent_is_lost_and_found(table: dict[str, Value]) -> None:
    async with arm(table) as (joints, network):
        network.inject("silent", None, True)
        await run(joints, 40, None)
        state = await joints.read()
        assert state.joints[0].freshness is Freshness.LOST
        assert "No controller was heard" in state.problem
        network.inject("silent", None, False)
        await run(joints, 20, None)
        assert (await joints.read()).problem == ""


async def test_strangers_on_the_bus_disturb_nobody(table: dict[str, Value]) -> None:
    async with arm(table) as (joints, _), open_link(Options.model_validate(table)) as stranger:
        chance = random.Random(1)
        for _ in range(300):
            node, command = chance.choice([n for n in range(64) if n != 3]), chance.randrange(32)
            stranger.send(Frame(node << 5 | command, chance.randbytes(chance.randrange(9))))
            stranger.send(Frame(3 << 5 | 9, remote=True))
        await run(joints, 10, None)
        assert abs((await joints.read()).joints[0].position) < 0.01


async def test_nobody_on_the_bus_is_told_within_the_time_to_open(table: dict[str, Value]) -> None:
    config = ArmConfig((JOINT,), PERIOD, {**table, "open_s": 0.2})
    with pytest.raises(BusError, match=r"wrist_rotation \(node 3\) sent no heartbeat"):
        async with open_joints(config, VirtualClock()):
            pass


async def test_a_bus_that_fails_is_a_sentence_and_is_listened_to_again(table: dict[str, Value]) -> None:
    told: list[str] = []
    heard: list[Frame] = []
    options = Options.model_validate(table)
    async with open_link(options) as link, open_link(options) as other:
        link.listen(heard.append, told.append)
        bus = link._bus
        good, bus.recv = bus.recv, _broken  # type: ignore[method-assign]
        other.send(Frame(1))
        await asyncio.sleep(0.1)
        bus.recv = good  # type: ignore[method-assign]
        await asyncio.sleep(0.3)
        other.send(Frame(2))
        await asyncio.sleep(0.2)
    assert told[0].endswith("cannot be read: The interface is down.")
    assert Frame(2) in heard


@pytest.mark.parametrize(
    ("interface", "channel"), [("socketcan", "nowhere0"), ("nonsense", "x"), ("udp_multicast", "127.0.0.1")]
)
async def test_a_bus_that_cannot_be_opened_says_so(interface: str, channel: str) -> None:
    with pytest.raises(BusError, match=f"The CAN bus {interface} {channel} cannot be opened"):
        async with open_link(Options(interface=interface, channel=channel)):
            pass


def _broken(timeout: float | None = None) -> can.Message | None:
    raise can.CanOperationError("The interface is down")


def _fail(reason: str) -> None:
    raise AssertionError(reason)
