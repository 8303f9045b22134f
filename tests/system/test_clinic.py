"""The config for control by sites does in one round what its comments say."""

import asyncio
from pathlib import Path

from bentod.cli.configs import read
from bentod.client import Client
from bentod.config_tables import Record
from bentod.daemon import Daemon
from bentod.frames import Value
from bentod.supervise import Supervisor
from sim.clock import VirtualClock
from tests.rig import CONFIGS, Table, joint, number, tables

ROUND_S = 14.2


async def one_round(socket: Path) -> tuple[list[Table], list[Value]]:
    """Frames of one round of the simulated wearer, and the sentences of its toggles."""
    config = read(CONFIGS / "clinic.toml").model_copy(update={"record": Record(enabled=False)})
    daemon = Daemon(config, VirtualClock(), Supervisor(), socket)
    task = asyncio.create_task(daemon.run(round(ROUND_S * 30)))
    await asyncio.sleep(0.05)
    frames, told = [], []

    async def listen(arm: Client) -> None:
        async for event in arm.subscribe_events():
            if event["kind"] == "group":
                told.append(event["text"])

    async with Client.connect(socket) as arm, arm.listen("state", 500) as stream:
        events = asyncio.create_task(listen(arm))
        frames = [await anext(stream) for _ in range(round(ROUND_S * 30) - 10)]
        events.cancel()
        await asyncio.wait([events])
    await task
    return frames, told


def way(frames: list[Table], name: str) -> tuple[float, float]:
    """The least and the greatest position of a joint, rad."""
    positions = [number(joint(frame, name), "position") for frame in frames]
    return min(positions), max(positions)


async def test_every_way_to_drive_and_to_toggle_is_seen_in_one_round(tmp_path: Path) -> None:
    frames, told = await one_round(tmp_path / "s")
    assert told == [
        "the wearer switched arm to elbow_flexion",
        "the wearer switched wrist to wrist_flexion",
        "the wearer switched wrist to wrist_rotation",
        "the wearer switched arm to shoulder_rotation",
    ]
    assert way(frames, "shoulder_rotation")[1] > 0.3
    assert way(frames, "elbow_flexion")[0] < -0.2
    assert way(frames, "wrist_rotation")[1] > 0.3
    assert way(frames, "wrist_flexion")[1] > 0.3
    opened = max(number(joint(frame, "gripper"), "position") for frame in frames)
    closed = number(joint(frames[-1], "gripper"), "position")
    assert opened > 0.05
    assert closed < opened - 0.1
    assert [group["active"] for group in tables(frames[-1], "groups")] == [
        "shoulder_rotation",
        "wrist_rotation",
        "gripper",
    ]
