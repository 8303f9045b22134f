"""Builds everything from the config, runs it, and takes it apart in the order that is safe."""

import asyncio
import logging
import os
import signal
import socket as sockets
from collections.abc import Callable, Iterator, Sequence
from contextlib import AsyncExitStack, contextmanager
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from bentod import registry
from bentod.clock import suspended
from bentod.config import Config
from bentod.contracts import ArmConfig, Clock, EmgConfig, FaultInjector, Joints, JoystickSource
from bentod.emg.feed import Feed
from bentod.emg.live.recogniser import Recogniser
from bentod.emg.reopening import reopening
from bentod.endpoint import default_socket_path
from bentod.ensemble import Member, gather
from bentod.furnish import about, furnished, mind_of
from bentod.inbox import Inbox
from bentod.learned import in_effect, learned
from bentod.lessons import lessons
from bentod.mind import Mind
from bentod.publisher import Publisher
from bentod.realtime import Upkeep
from bentod.record.disk import Folder
from bentod.record.provenance import as_toml, folder, limits, template
from bentod.record.session import Header
from bentod.record.takes import Takes
from bentod.serve.methods import arm_methods
from bentod.serve.room import Room
from bentod.serve.server import Server
from bentod.serve.session import Bounds
from bentod.serve.unix_door import UnixDoor
from bentod.start import Start
from bentod.supervise import Supervisor
from bentod.tick import Controller

_log = logging.getLogger(__name__)


_SIGNALS = (signal.SIGTERM, signal.SIGINT, signal.SIGHUP)


@dataclass(slots=True)
class Daemon:
    """One arm, from the config to the last tick."""

    config: Config
    clock: Clock
    supervisor: Supervisor
    socket: Path
    passed: sockets.socket | None = None
    """What a supervisor listens on at that path already."""
    upkeep: Upkeep = field(default_factory=Upkeep)
    """What goes on around the ticks."""
    config_file: str = ""
    """The config's name, for the recording."""

    async def run(self, ticks: int = 0) -> str:
        """Serve until a signal comes, or for a number of ticks; returns how the arm was left, in a sentence.

        Raises:
            ConfigError: a driver or source cannot be loaded, or there can be no socket at the path.
            BusError: the arm is not the one in the config, or cannot be reached.
            InputFileError: the EMG source cannot be opened.
            Refused: another daemon serves this socket.
        """
        async with AsyncExitStack() as stack:
            # The socket comes first: a second daemon is refused before it touches the arm.
            inbox = Inbox()
            room = Room(inbox, about(self.config))
            server = await stack.enter_async_context(self._server(room))
            room.sessions = lambda: server.sessions
            mind = mind_of(self.config)
            carried, chore = stack.enter_context(learned(self.config, mind, self.config_file, self.clock))
            joints = await self._open_joints(stack)
            room.injector = joints if isinstance(joints, FaultInjector) else None
            feed = await self._open_feed(stack)
            desk = furnished(self.config, joints.torque(), feed, mind, await self._open_joystick(stack))
            room.lessons = lessons(self.config, desk.muscles, self.config_file)
            takes = room.takes = stack.enter_context(self._takes(mind))
            if self.config.record.enabled:
                takes.begin(carried)
            publisher = Publisher(room, server, self.supervisor, self.clock, takes)
            room.commanded = publisher.commanded
            if feed:
                feed.heard = publisher.heard
            rate, tell = self.config.rate_hz, publisher.publish
            controller = Controller(joints, desk, inbox, self.clock, rate, tell, self.upkeep, suspended)
            controller.chores.append(chore)
            _log.info("serving %s on %s", self.config.arm, self.socket)
            stack.enter_context(_signals_call(controller.end))
            stack.enter_context(self.upkeep.collector)
            torque = await self._live(controller, inbox, feed, desk.muscles.recognition, ticks)
            left = self._left(torque)
            _log.log(logging.WARNING if any(torque) else logging.INFO, "%s", left)
            return left

    async def _live(
        self,
        controller: Controller,
        inbox: Inbox,
        feed: Feed | None,
        recogniser: Recogniser | None,
        ticks: int,
    ) -> tuple[bool, ...]:
        """Run the tick beside the tasks that feed it, then settle the arm whatever happened."""
        async with asyncio.TaskGroup() as tasks:
            helpers = [tasks.create_task(self._start(inbox), name="start")]
            if feed:
                helpers.append(tasks.create_task(feed.pump(), name="emg"))
            if recogniser:
                helpers.append(tasks.create_task(recogniser.run(), name="recognition"))
            try:
                await controller.run(ticks)
            finally:
                self.supervisor.stopping()
                inbox.close("the daemon is ending")  # from here on nobody moves or arms anything
                torque = await controller.settle(limp=self.config.safety.exit == "limp")
                for helper in helpers:
                    helper.cancel()
        return torque

    def _left(self, torque: Sequence[bool]) -> str:
        """How the arm was left, honestly: what was asked for may not have been confirmed."""
        holding = [joint.name for joint, on in zip(self.config.joints, torque, strict=True) if on]
        if not holding:
            return "The arm was left limp."
        if self.config.safety.exit == "hold":
            return f"The arm was left with torque on, as the config asks: {', '.join(holding)}."
        return f"Torque may still be on, because nothing confirmed that it is off: {', '.join(holding)}."

    async def _start(self, inbox: Inbox) -> None:
        await Start(inbox, self.clock).run(self.config.safety.start)
        self.supervisor.ready()

    def _server(self, room: Room) -> Server:
        access = self.config.access
        bounds = Bounds(per_user=access.connections_per_user, requests_per_s=access.requests_per_s)
        unix = UnixDoor(access)
        return Server(
            arm_methods(room),
            self.socket,
            bounds,
            passed=self.passed,
            unix=unix,
            tcp=self.config.tcp,
            gate=self.upkeep.gate,
        )

    async def _open_joints(self, stack: AsyncExitStack) -> Joints:
        specs = tuple(joint.spec() for joint in self.config.joints)
        members = []
        for share in self.config.shares():
            own = tuple(specs[index] for index in share.joints)
            config = ArmConfig(own, 1 / self.config.rate_hz, share.driver.options)
            opened = registry.open_joints(share.driver.name)(config, self.clock)
            joints = await stack.enter_async_context(opened)
            members.append(Member(share.key or "driver", joints, share.joints))
        return gather(members)

    async def _open_feed(self, stack: AsyncExitStack) -> Feed | None:
        emg = self.config.emg
        if emg is None:
            return None
        used = emg.recognition.channels if emg.recognition else ()
        channels = 1 + max(*(site.channel for site in emg.sites), *used, 0)
        config = EmgConfig(emg.rate_hz, channels, emg.source.options)
        opens = partial(registry.open_emg(emg.source.name), config, self.clock)
        source = await stack.enter_async_context(reopening(opens, self.clock))
        feed = Feed(source, emg.stall_s)
        source.lost, source.back, feed.prompt = feed.lost, feed.back, source.prompt
        return feed

    async def _open_joystick(self, stack: AsyncExitStack) -> JoystickSource | None:
        if self.config.joystick is None:
            return None
        chosen = self.config.joystick.source
        opened = registry.open_joystick(chosen.name)(chosen.options, self.clock)
        return await stack.enter_async_context(opened)

    def _takes(self, mind: Mind) -> Takes:
        def common() -> Header:
            return template(self.config, as_toml(in_effect(self.config, mind)), self.config_file)

        table = self.config.record
        return Takes(common, Folder(folder(table)), limits(table), self.clock)


@contextmanager
def _signals_call(end: Callable[[], None]) -> Iterator[None]:
    """While entered, signals that ask the process to end call `end` instead."""
    loop = asyncio.get_running_loop()
    for number in _SIGNALS:
        loop.add_signal_handler(number, end)
    try:
        yield
    finally:
        for number in _SIGNALS:
            loop.remove_signal_handler(number)


def socket_path(config: Config, chosen: Path | None = None) -> Path:
    """Where clients find the daemon: as chosen, as the config says, or at the usual place."""
    return chosen or config.socket or default_socket_path()


def environment_supervisor() -> Supervisor:
    """The supervisor that started this process, if one did."""
    return Supervisor.from_environment(os.environ)
