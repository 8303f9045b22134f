"""Frames of the simulated arm at work, as seven joints on a real machine would make them."""

import asyncio
import math
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cache
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from unittest import mock

from bentod.daemon import Daemon
from bentod.frames import Costs, Frame, JointFrame, JointSpec
from bentod.serve.server import Server
from bentod.supervise import Supervisor
from sim.clock import VirtualClock, run
from tests.rig import sim_config

_TICKS = 3000
_SKIPPED = 300  # until the wearer is at work and something has been learned

_POSITION = 2 * math.pi / 4096  # rad, of a servo


@cache
def arm_frames() -> tuple[Frame, ...]:
    """Ninety seconds of the shipped simulation, predictions and assist included.

    It has five joints: the first two are there twice. Its clock is virtual, so what a machine adds (lateness,
    costs, the end of the round) is added here.
    """
    random = Random(1)
    return tuple(_seven(frame, random) for frame in _simulated()[_SKIPPED:])


def specs() -> tuple[JointSpec, ...]:
    """The seven joints."""
    return tuple(JointSpec(joint.name, -1.6, 1.6, 1.0, 0.0, {}) for joint in arm_frames()[0].joints)


def endless(started: float, scales: int = 2) -> Iterator[Frame]:
    """The same again and again, numbered and timed as one session that starts at `started` (monotonic s).

    `scales`: on how many timescales each joint is predicted.
    """
    frames = [_predicted(frame, scales) for frame in arm_frames()]
    for tick in range(1 << 40):
        frame = frames[tick % len(frames)]
        due = started + tick / 30
        read_at = due + frame.read_at - frame.time
        yield replace(frame, tick=tick, time=due, read_at=read_at, wall=frame.wall - frame.time + due)


def _predicted(frame: Frame, scales: int) -> Frame:
    joints = (replace(j, predictions=dict(list(j.predictions.items())[2 - scales :])) for j in frame.joints)
    return replace(frame, joints=tuple(joints))


def _simulated() -> Sequence[Frame]:
    frames: list[Frame] = []

    def keep(server: Server, frame: Frame) -> None:
        frames.append(frame)

    async def live() -> None:
        with TemporaryDirectory() as folder, suppress(asyncio.CancelledError):
            daemon = Daemon(sim_config(), VirtualClock(), Supervisor(), Path(folder) / "socket")
            await daemon.run(_TICKS)

    with mock.patch.object(Server, "publish_state", keep):
        run(live())
    return frames


def _seven(frame: Frame, random: Random) -> Frame:
    def some(most: float) -> float:
        return random.uniform(most / 2, most)

    return replace(
        frame,
        joints=frame.joints + tuple(_another(joint, random) for joint in frame.joints[:2]),
        lateness=some(1e-4),
        costs=Costs(some(2e-3), some(5e-4), some(3e-4), some(1e-4)),
        read_at=frame.time + some(4e-3),
        wall=frame.wall + some(1e-4),
        meta={"participant": "p07", "condition": "dpcc"},
    )


def _another(joint: JointFrame, random: Random) -> JointFrame:
    """A joint of its own that does nearly the same."""
    shift = 3 * _POSITION
    predictions = {scale: value + random.uniform(-0.01, 0.01) for scale, value in joint.predictions.items()}
    return replace(joint, name=f"{joint.name}_2", position=joint.position + shift, predictions=predictions)
