"""Clients as they come and go, some of them badly behaved, and one who breaks the arm and mends it."""

import asyncio
import random
from collections.abc import Callable, Coroutine, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TypeAlias

from bentod.client import Client
from bentod.endpoint import Disconnected, RpcError
from bentod.frames import Value
from bentod.messages import encode_request

Visit: TypeAlias = Callable[[Path, random.Random], Coroutine[object, object, None]]

FAULTS = ("cable", "power", "noise", "silent", "reboot", "overload", "encoder_glitch", "slow")
OF_THE_ARM = ("cable", "power", "noise")
JOINTS = ("shoulder_rotation", "elbow_flexion", "wrist_rotation", "wrist_flexion", "gripper")

RUBBISH = (
    b"\xc1",
    b"\x93\x00\x01",
    b"hello\n",
    encode_request(1, "x" * 500, []),
    b"\xdd\xff\xff\xff\xff",
    b"",
)


async def subscriber(path: Path, chosen: random.Random) -> None:
    """Watches for a while and goes."""
    async with Client.connect(path) as arm, asyncio.timeout(chosen.uniform(0.1, 1.5)):
        async for _ in arm.subscribe_state(rate_hz=chosen.choice((5, 30, 500))):
            pass


async def deaf(path: Path, chosen: random.Random) -> None:
    """Subscribes and never reads."""
    _, writer = await asyncio.open_unix_connection(str(path), limit=16)
    writer.write(encode_request(1, "subscribe", {"topic": "state", "rate_hz": 500}))
    await asyncio.sleep(chosen.uniform(0.5, 3.0))
    writer.transport.abort()


async def rude(path: Path, chosen: random.Random) -> None:
    """Sends rubbish, or half a message, and goes."""
    _, writer = await asyncio.open_unix_connection(str(path))
    writer.write(chosen.choice(RUBBISH))
    await asyncio.sleep(chosen.uniform(0.0, 0.2))
    writer.transport.abort()


async def mover(path: Path, chosen: random.Random) -> None:
    """Asks much, some of it wrong, and vanishes in the middle of a motion."""
    async with Client.connect(path) as arm:
        await arm.call("hello", f"mover {chosen.randrange(1000)}")
        for _ in range(chosen.randrange(1, 30)):
            velocity = chosen.uniform(-1.2, 1.2)
            await _try(arm, "move", {"joint": chosen.choice(JOINTS), "velocity": velocity, "lease_s": 0.3})
            await _try(arm, chosen.choice(("get_state", "get_info", "group_list", "nonsense")), {})
            await _try(arm, "set_meta", {"meta": "x" * chosen.randrange(300)})
            await asyncio.sleep(chosen.uniform(0.0, 0.1))


async def breaker(path: Path, chosen: random.Random) -> None:
    """Breaks something, mends it, and makes the arm ready again."""
    fault = chosen.choice(FAULTS)
    joint = None if fault in OF_THE_ARM else chosen.choice(JOINTS)
    async with Client.connect(path) as arm:
        await _try(arm, "inject", {"fault": fault, "joint": joint})
        await asyncio.sleep(chosen.uniform(0.2, 1.5))
        await _try(arm, "inject", {"fault": fault, "joint": joint, "on": False})
        await asyncio.sleep(1.0)
        await restore(arm)


async def restore(arm: Client) -> None:
    """The arm is armed and released again, if it can be."""
    await _try(arm, "clear_fault", {})
    await _try(arm, "torque", {"on": True})
    await _try(arm, "pause", {"on": False})


async def _try(arm: Client, method: str, params: dict[str, Value]) -> None:
    with suppress(RpcError):
        await arm.call(method, **params)


VISITS: Sequence[Visit] = (subscriber, subscriber, subscriber, mover, mover, rude, deaf, breaker)
"""One visitor of each at a time."""


async def churn(path: Path, seconds: float, seed: int) -> int:
    """All of them, again and again for `seconds`; how many visits there were. Afterwards nobody is left."""
    counts = await asyncio.gather(
        *(
            _again(visit, path, seconds, random.Random(f"{seed}/{place}"))
            for place, visit in enumerate(VISITS)
        )
    )
    return sum(counts)


async def _again(visit: Visit, path: Path, seconds: float, chosen: random.Random) -> int:
    loop = asyncio.get_running_loop()
    end, count = loop.time() + seconds, 0
    while loop.time() < end:
        with suppress(Disconnected, TimeoutError, ConnectionError):
            await visit(path, chosen)
        count += 1
    return count
