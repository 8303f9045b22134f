"""The connection that all browsers share: what the daemon publishes, and what only looks."""

import asyncio
import logging
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from bentod.client import Client
from bentod.dashboard.actor import Connect
from bentod.endpoint import Disconnected, RpcError
from bentod.errors import BentodError
from bentod.frames import Value

_log = logging.getLogger(__name__)

RATE_HZ = 30.0
"""Frames a second that are asked for: more than a browser draws are of no use."""

_AGAIN_S = (0.2, 2.0)
"""s until the next attempt to connect: at first, and at most."""

_KEPT_BLOCKS = 64
"""Blocks of muscle signals that wait for the next frame; older ones are dropped."""


@dataclass(frozen=True, slots=True)
class Knowledge:
    """What does not change while the daemon runs."""

    info: Value  # answer of get_info
    methods: Value  # answer of list_methods
    role: str  # that the daemon grants this process

    def roles(self) -> Mapping[str, str]:
        """The role that each method needs, by name."""
        entries = self.methods if isinstance(self.methods, list) else []
        return {str(e["name"]): str(e["role"]) for e in entries if isinstance(e, dict)}


class Public(Protocol):
    """Who is told what the daemon says."""

    def arrived(self, knowledge: Knowledge) -> None:
        """The daemon is there, for the first time or again."""
        ...

    def frame(self, frame: dict[str, Value], emg: list[Value]) -> None:
        """A frame, and the blocks of muscle signals, as they came, since the one before."""
        ...

    def event(self, event: dict[str, Value]) -> None:
        """Something happened."""
        ...

    def left(self, why: str) -> None:
        """The daemon is gone."""
        ...


class ArmLink:
    """Connects, and connects again, until it is cancelled."""

    def __init__(self, connect: Connect, public: Public) -> None:
        self._connect = connect
        self._public = public
        self._arm: Client | None = None
        self._emg: list[Value] = []

    async def call(self, method: str, params: dict[str, Value]) -> Value:
        """Ask the daemon. Raises BentodError: it refuses, or is not there."""
        if self._arm is None:
            raise Disconnected("The daemon is not there.")
        return await self._arm.call(method, **params)

    async def run(self) -> None:
        """Stay connected for as long as this runs."""
        wait, most = _AGAIN_S
        while True:
            try:
                async with self._connect() as arm:
                    wait = _AGAIN_S[0]
                    await self._listen(arm)
            except* BentodError as lost:
                self._gone(str(lost.exceptions[0]))
            await asyncio.sleep(wait)
            wait = min(2 * wait, most)

    def _gone(self, why: str) -> None:
        if self._arm:
            _log.warning("the daemon is gone: %s", why)
        self._arm = None
        self._public.left(why)

    async def _listen(self, arm: Client) -> None:
        greeting = await arm.call("hello", name="dashboard")
        role = str(greeting["role"]) if isinstance(greeting, dict) else ""
        knowledge = Knowledge(await arm.call("get_info"), await arm.call("list_methods"), role)
        self._arm = arm
        _log.info("connected to the daemon as %s", role)
        self._public.arrived(knowledge)
        await self._first(arm)
        async with asyncio.TaskGroup() as tasks:
            tasks.create_task(self._frames(arm))
            tasks.create_task(self._events(arm))
            tasks.create_task(self._muscles(arm))

    async def _first(self, arm: Client) -> None:
        """Show what there is: a replay that stands still sends no frame by itself."""
        with suppress(RpcError):
            frame = await arm.call("get_state")
            if isinstance(frame, dict):
                self._public.frame(frame, [])

    async def _frames(self, arm: Client) -> None:
        async with arm.listen("state", RATE_HZ) as frames:
            async for frame in frames:
                emg, self._emg = self._emg, []
                self._public.frame(frame, emg)

    async def _events(self, arm: Client) -> None:
        async with arm.listen("events") as events:
            async for event in events:
                self._public.event(event)

    async def _muscles(self, arm: Client) -> None:
        async with arm.listen("emg") as blocks:
            async for block in blocks:
                self._emg.append(block)
                del self._emg[:-_KEPT_BLOCKS]


def joined(blocks: list[Value]) -> list[Value]:
    """Blocks of muscle signals with those that follow one another without a gap made one.

    Each becomes [first_index, time, dropped, channels, samples]: the samples as bytes of float32, little
    endian, in V, one sample of all channels after the other.
    """
    found: list[tuple[int, float, int, list[Value]]] = []
    for block in blocks:
        match block:
            case {
                "first_index": int(first),
                "time": float(time),
                "dropped": int(dropped),
                "samples": [*rows],
            }:
                follows = found and not dropped and found[-1][0] + len(found[-1][3]) == first
                if follows:
                    found[-1][3].extend(rows)
                else:
                    found.append((first, time, dropped, rows))
    return [_packed(first, time, dropped, rows) for first, time, dropped, rows in found if rows]


def _packed(first: int, time: float, dropped: int, rows: list[Value]) -> Value:
    samples = np.asarray(rows, dtype="<f4")
    return [first, time, dropped, samples.shape[1], samples.tobytes()]
