"""A reader of a servo bus as a process, so that its CPU is its own: `ours`, `sdk` or `nobody`."""

import asyncio
import json
import sys
import time
from collections.abc import Awaitable, Callable
from dataclasses import asdict, dataclass
from typing import Any

import dynamixel_sdk as sdk

from bentod.clock import SystemClock
from bentod.contracts import ArmConfig
from bentod.frames import Freshness, Stop, Value
from bentod.lateness.histogram import percentile
from drivers.dynamixel.joints import open_joints
from sim.bento import bento_joints

BESIDE_HZ = 200
"""Of the tick that runs in the same loop and shows what the reader does to it."""

Round = Callable[[], Awaitable[bool]]
"""One reading and one writing of all servos; whether all of them answered."""


@dataclass(frozen=True, slots=True)
class Result:
    """What a reader did in its time."""

    rounds: int
    lost: int  # rounds in which a servo did not answer
    missed: int  # rounds that were not begun because one before took too long
    seconds: float
    cpu: float  # s
    late_p99: float  # s, of the tick beside it


async def measure(round_: Round, rate_hz: float, seconds: float) -> Result:
    """Rounds at `rate_hz`, or as fast as they go (0), beside a tick at `BESIDE_HZ`."""
    async with SystemClock() as clock:
        late: list[float] = []
        beside = asyncio.create_task(_tick(clock, late))
        began, cpu = clock.now(), time.process_time()
        rounds = lost = missed = 0
        due = began
        while clock.now() < began + seconds:
            lost += not await round_()
            rounds += 1
            if rate_hz:
                due += 1 / rate_hz
                while due < clock.now():
                    due += 1 / rate_hz
                    missed += 1
                await clock.sleep_until(due)
        took, spent = clock.now() - began, time.process_time() - cpu
        beside.cancel()
    return Result(rounds, lost, missed, took, spent, percentile(late, 0.99))


async def ours(port: str, rate_hz: float, seconds: float) -> Result:
    """The driver as the daemon uses it: read, then a goal for every joint."""
    specs = bento_joints()
    options: dict[str, Value] = {"port": port, "dead_man_s": 0.0}
    config = ArmConfig(specs, 1 / (rate_hz or 30), options)
    async with open_joints(config, SystemClock()) as joints:
        await joints.set_torque([True] * len(specs))
        stops = [Stop()] * len(specs)

        async def round_() -> bool:
            state = await joints.read()
            await joints.write(stops)
            return all(joint.freshness is Freshness.FRESH for joint in state.joints)

        return await measure(round_, rate_hz, seconds)


async def theirs(port: str, rate_hz: float, seconds: float) -> Result:
    """The official SDK's bulk read and sync write, in a thread, as an asyncio program must."""
    line: Any = sdk.PortHandler(port)
    packets: Any = sdk.PacketHandler(1.0)
    assert line.openPort()
    assert line.setBaudRate(1_000_000)
    ids = [1, 2, 3, 4, 5]
    read: Any = sdk.GroupBulkRead(line, packets)
    write: Any = sdk.GroupSyncWrite(line, packets, 30, 4)
    for id_ in ids:
        read.addParam(id_, 34, 10)
        write.addParam(id_, [0, 8, 67, 0])

    def round_() -> bool:
        # GroupBulkRead.txPacket of SDK 3.8.2 and later calls bulkReadTx with one argument too many.
        read.makeParam()
        packets.bulkReadTx(line, read.param, len(ids) * 3)
        heard = read.rxPacket() == sdk.COMM_SUCCESS
        write.txPacket()
        return bool(heard)

    loop = asyncio.get_running_loop()
    try:
        return await measure(lambda: loop.run_in_executor(None, round_), rate_hz, seconds)
    finally:
        line.closePort()


async def nobody(port: str, rate_hz: float, seconds: float) -> Result:
    """The same without a bus: what the pacing and the tick beside it cost by themselves."""

    async def round_() -> bool:
        return True

    return await measure(round_, rate_hz, seconds)


async def _tick(clock: SystemClock, late: list[float]) -> None:
    due = clock.now()
    while True:
        due += 1 / BESIDE_HZ
        await clock.sleep_until(due)
        late.append(max(0.0, clock.now() - due))


if __name__ == "__main__":
    reader = {"ours": ours, "sdk": theirs, "nobody": nobody}[sys.argv[1]]
    result = asyncio.run(reader(sys.argv[2], float(sys.argv[3]), float(sys.argv[4])))
    sys.stdout.write(json.dumps(asdict(result)) + "\n")
