"""A whole daemon in virtual time, its clients, its servos, and somebody who watches all of them."""

import asyncio
import logging
from collections.abc import AsyncIterator, Callable, Iterator, Sequence
from contextlib import ExitStack, asynccontextmanager, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from unittest import mock

import sim.bento
import sim.emg
import sim.joints
from bentod.client import Client
from bentod.config import Config
from sim import clock
from sim.arm import Arm
from sim.emg import Synthetic
from sim.servo import Servo, Setting
from tests.invariants.steps import CLIENTS, Api, Call, Garble, Let, Muscles, Recover, Step, Vanish, api_of
from tests.invariants.talk import Speaker
from tests.invariants.watch import Watch
from tests.rig import Table, running

ROOM = 1.0
"""rad from a joint's limit to its hard stop: nothing but the daemon keeps a joint within its limits."""

WHOLE = ("noise", "power", "cable")
"""Faults of the whole arm; all others but a reboot, which is over at once, and the watchdog are of joints."""


@dataclass(slots=True)
class Parts:
    """What the daemon built, as it comes by."""

    arm: Arm | None = None
    emg: Synthetic | None = None
    watch: Watch | None = None


@dataclass(slots=True)
class World:
    """Carries steps out."""

    socket: Path
    watch: Watch
    emg: Synthetic | None
    speakers: dict[int, Speaker] = field(default_factory=dict)
    names: int = 0

    async def do(self, step: Step) -> None:
        """One step."""
        match step:
            case Call():
                await self._call(step)
            case Vanish(client):
                self._leave(client, lambda speaker: speaker.vanish())
            case Garble(client, data):
                await self._speaker(client)
                self._leave(client, lambda speaker: speaker.garble(data))
            case Muscles(fault, on):
                self._break_muscles(fault, on)
            case Recover():
                await self._recover()
            case Let(seconds):
                await asyncio.sleep(seconds)

    async def _call(self, call: Call) -> None:
        speaker = await self._speaker(call.client)
        if call.method in ("torque", "clear_fault"):
            self.watch.switched = asyncio.get_running_loop().time()
        asked = speaker.ask(call)
        if call.wait:
            await asyncio.wait([asked.done])

    async def _speaker(self, client: int) -> Speaker:
        if client not in self.speakers:
            self.names += 1
            watch = self.watch
            speaker = Speaker(f"c{client}.{self.names}", watch.answered, watch.complain)
            loop = asyncio.get_running_loop()
            await loop.create_unix_connection(lambda: speaker, str(self.socket))
            self.speakers[client] = speaker
            watch.speakers.append(speaker)
        return self.speakers[client]

    def _leave(self, client: int, way: Callable[[Speaker], None]) -> None:
        speaker = self.speakers.pop(client, None)
        if speaker:
            self.watch.vanished(speaker, asyncio.get_running_loop().time())
            way(speaker)

    def leave_all(self) -> None:
        """Everybody goes."""
        for client in range(CLIENTS):
            self._leave(client, lambda speaker: speaker.vanish())

    def _break_muscles(self, fault: str, on: bool) -> None:
        if self.emg is None:
            return
        setattr(self.emg, fault, on or (fault == "end" and self.emg.end))
        broken = self.emg.stall or self.emg.nan or self.emg.end
        since = self.watch.emg_broken
        now = asyncio.get_running_loop().time()
        self.watch.emg_broken = min(since, now) if broken else float("inf")

    async def _recover(self) -> None:
        arm = self.watch.arm
        for fault in (*WHOLE, *sorted({*arm.faults()} - {*WHOLE, "watchdog"})):
            arm.inject(fault, None, False)
        await asyncio.sleep(1.5)
        await self._call(Call(0, "clear_fault", {}, wait=True))
        await self._call(Call(0, "torque", {"on": True}, wait=True))
        await self._call(Call(0, "pause", {"on": False}, wait=True))


@asynccontextmanager
async def world(config: Config, socket: Path, api: Api) -> AsyncIterator[World]:
    """The daemon under way, released, and watched."""
    with _parts() as parts, _loud() as errors:
        async with running(config, socket) as witness, witness.listen("state", 500) as frames:
            assert parts.arm
            watch = parts.watch = Watch(api, parts.arm)
            for seen in watch.seen.values():
                seen.on = True
            task = asyncio.create_task(_follow(frames, watch, errors))
            here = World(socket, watch, parts.emg)
            try:
                yield here
            finally:
                here.leave_all()
                task.cancel()
                await asyncio.wait([task])


async def _follow(frames: AsyncIterator[Table], watch: Watch, errors: list[str]) -> None:
    loop = asyncio.get_running_loop()
    try:
        async for frame in frames:
            watch.frame(frame, loop.time())
            while errors:
                watch.complain(f"an error was logged: {errors.pop()}")
    except Exception as error:  # noqa: BLE001 -- whatever it was, the test is to tell
        watch.complain(f"the daemon or its watcher died: {type(error).__name__}: {error}")


@contextmanager
def _parts() -> Iterator[Parts]:
    """Catches the simulated arm and muscles when they are built, and what the servos are told."""
    parts = Parts()
    build, tell, reboot, inject = sim.bento.build_arm, Servo.tell, Servo.reboot, Arm.inject

    def built(*args: object) -> Arm:
        parts.arm = build(*args)  # type: ignore[arg-type]
        return parts.arm

    def opened(*args: object) -> Synthetic:
        parts.emg = Synthetic(*args)  # type: ignore[arg-type]
        return parts.emg

    def told(servo: Servo, setting: Setting) -> None:
        if parts.watch:
            parts.watch.told(servo, setting, asyncio.get_running_loop().time())
        tell(servo, setting)

    def rebooted(servo: Servo) -> None:
        if parts.watch:
            parts.watch.rebooted(servo)
        reboot(servo)

    def injected(arm: Arm, fault: str, joint: int | None, on: bool) -> None:
        arm.advance(asyncio.get_running_loop().time())
        inject(arm, fault, joint, on)
        if parts.watch:
            joints: Sequence[int] = range(len(arm.servos)) if joint is None else (joint,)
            parts.watch.injected(fault, joints, on, asyncio.get_running_loop().time())

    with ExitStack() as stack:
        stack.enter_context(mock.patch.object(sim.joints, "build_arm", built))
        stack.enter_context(mock.patch.object(sim.bento, "STOP_MARGIN", ROOM))
        stack.enter_context(mock.patch.object(sim.emg, "Synthetic", opened))
        stack.enter_context(mock.patch.object(Servo, "tell", told))
        stack.enter_context(mock.patch.object(Servo, "reboot", rebooted))
        stack.enter_context(mock.patch.object(Arm, "inject", injected))
        yield parts


class _Ear(logging.Handler):
    def __init__(self, heard: list[str]) -> None:
        super().__init__(logging.ERROR)
        self._heard = heard

    def emit(self, record: logging.LogRecord) -> None:
        text = record.getMessage()
        self._heard.append(f"{text} {record.exc_info[1]!r}" if record.exc_info else text)


@contextmanager
def _loud() -> Iterator[list[str]]:
    """Errors that are logged while entered."""
    heard: list[str] = []
    ear = _Ear(heard)
    root = logging.getLogger()
    root.addHandler(ear)
    try:
        yield heard
    finally:
        root.removeHandler(ear)


def learn_api(config: Config, socket: Path) -> Api:
    """What a daemon with this config says of itself."""

    async def ask() -> Api:
        async with running(config, socket) as arm:
            return await describe(arm)

    return clock.run(ask())


async def describe(arm: Client) -> Api:
    """The same over a connection."""
    return api_of(await arm.call("list_methods"), await arm.call("get_info"), await arm.call("emg_get"))


def play(config: Config, socket: Path, api: Api, steps: Sequence[Step]) -> Watch:
    """All steps, one after the other, until something does not hold."""

    async def acts() -> Watch:
        async with world(config, socket, api) as here:
            for step in steps:
                await here.do(step)
                if here.watch.broken:
                    return here.watch
            await here.do(Let(3.5))
        return here.watch

    return clock.run(acts())
