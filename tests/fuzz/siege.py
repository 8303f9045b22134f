"""A whole daemon in virtual time, attackers at its socket, and a watch that nothing gives way."""

import asyncio
import logging
from collections import Counter
from collections.abc import AsyncIterator, Iterable, Sequence
from contextlib import AsyncExitStack, asynccontextmanager, suppress
from pathlib import Path

from bentod.client import Client
from bentod.endpoint import GENEROUS, Disconnected, RpcError
from bentod.frames import Value
from bentod.messages import Decoder, Message, Notification, Response, encode_request
from tests.fuzz.grammar import Call, Grammar
from tests.rig import Table, number, table, tables

PATIENCE = 20.0
"""s of virtual time for an answer, though it takes a tick."""

LYING = {"encoder_glitch"}
"""Faults that make a joint report a position that it does not have, of which the watch would complain."""

MARGIN = 0.06
"""Rad beyond a limit that a servo with torque may overshoot or sag."""


class Broken(AssertionError):
    """Something gave way; the text says what."""


class _Ears(logging.Handler):
    """Remembers what the daemon complains of."""

    def __init__(self) -> None:
        super().__init__(logging.ERROR)
        self.heard: list[str] = []

    def emit(self, record: logging.LogRecord) -> None:
        trace = logging.Formatter().formatException(record.exc_info) if record.exc_info else ""
        self.heard.append(f"{record.getMessage()}\n{trace}")


class Watch:
    """Sees every frame, and what is wrong with it."""

    def __init__(self, info: Table) -> None:
        self.frames = 0
        self.wrong: list[str] = []
        self.punctual = True
        """Whether every tick must be in time, and every frame seen; in real time machines have a say."""
        self._limits = {str(j["name"]): j for j in tables(info, "joints")}
        self._tick = -1.0
        self._missed = 0.0
        self._clearing = False

    def look(self, frame: Table) -> None:
        """Take in the next frame."""
        tick = number(frame, "tick")
        if self.punctual and self._tick >= 0 and tick != self._tick + 1:
            self.wrong.append(f"tick {tick:g} came after {self._tick:g}")
        missed = number(frame, "missed")
        if self.punctual and missed > self._missed and not self._clearing:
            self.wrong.append(f"{missed - self._missed:g} ticks were missed before tick {tick:g}")
        # To clear its errors a servo must be let go and waited for; the arm is in fault meanwhile.
        self._missed, self._clearing = missed, any(joint["errors"] for joint in tables(frame, "joints"))
        if "internal error" in str(frame["fault"]):
            self.wrong.append(str(frame["fault"]))
        self._tick = tick
        self.frames += 1
        for joint in tables(frame, "joints"):
            self._look_at(joint, self._limits[str(joint["name"])])

    def _look_at(self, joint: Table, limits: Table) -> None:
        name = str(joint["name"])
        low, high, fastest = (number(limits, key) for key in ("min_rad", "max_rad", "max_velocity_rad_s"))
        position = number(joint, "position")
        if joint["torque"] and not low - MARGIN <= position <= high + MARGIN:
            self.wrong.append(f"{name} is at {position} rad")
        sent = table(joint["sent"] or {})
        fits = abs(number({"velocity": 0.0, **sent}, "velocity")) <= fastest * 1.001
        if not fits or not low - 1e-6 <= number({"position": low, **sent}, "position") <= high + 1e-6:
            self.wrong.append(f"{name} was sent {sent}")


class Siege:
    """What attackers may do, and what must hold afterwards."""

    def __init__(self, path: Path, arm: Client, info: Table, methods: Sequence[Table]) -> None:
        self.path = path
        self.watch = Watch(info)
        self.ears = _Ears()
        self.info = info
        self.grammar = Grammar(methods, _names(info))
        self._arm = arm

    async def calls(self, bursts: Iterable[tuple[Sequence[Call], float]]) -> None:
        """Send bursts of calls, each followed by a pause (s), and demand one answer to each call.

        Raises:
            Broken: a call was answered with an internal error, twice, or not at all.
        """
        async with plugged(self.path) as plug:
            first = 0
            for calls, pause in bursts:
                for id_, (method, params) in enumerate(calls, first):
                    plug.writer.write(encode_request(id_, method, params))
                await self._answers(plug, {first + at: call for at, call in enumerate(calls)})
                first += len(calls)
                await asyncio.sleep(pause)

    async def _answers(self, plug: "_Plug", asked: dict[int, Call]) -> None:
        open_calls = dict(asked)
        while open_calls:
            try:
                async with asyncio.timeout(PATIENCE):
                    message = await plug.next()
            except TimeoutError:
                raise Broken(f"never answered: {open_calls}") from None
            if message is None:
                raise Broken(f"the connection was closed instead of answering {open_calls}")
            if isinstance(message, Response):
                call = open_calls.pop(message.id, None)
                if call is None:
                    raise Broken(
                        f"answered twice, or without being asked: {message} to {asked.get(message.id)}"
                    )
                if isinstance(message.error, dict) and message.error["code"] == "internal":
                    raise Broken(f"{call}: {message.error}")

    async def bytes(self, chunks: Iterable[bytes]) -> list[Message]:
        """Send anything, hang up one's own half, and read to the end; what was answered.

        Raises:
            Broken: the daemon does not hang up, or answers more than it was asked.
        """
        asked = 0
        async with plugged(self.path) as plug:
            with suppress(ConnectionError):
                for chunk in chunks:
                    asked += len(chunk)
                    plug.writer.write(chunk)
                    await plug.writer.drain()
                plug.writer.write_eof()
            try:
                async with asyncio.timeout(PATIENCE):
                    messages = [message async for message in plug.messages()]
            except TimeoutError:
                raise Broken("the daemon does not let go of a client that has left") from None
        counts = Counter(message.id for message in messages if isinstance(message, Response))
        if 4 * counts.total() > asked:  # no request has fewer bytes
            raise Broken(f"{counts.total()} answers to {asked} bytes")
        return messages

    async def recover(self) -> None:
        """Mend all that was broken, and release the arm."""
        joints = [None, *(str(joint["name"]) for joint in tables(self.info, "joints"))]
        for fault in _texts(self.info["faults"]):
            mend = (self._arm.call("inject", fault=fault, joint=joint, on=False) for joint in joints)
            await asyncio.gather(*mend, return_exceptions=True)  # some are of one joint, others of the arm
        await asyncio.sleep(0.5)
        with suppress(RpcError):
            await self._arm.call("clear_fault")
        for method, on in (("torque", True), ("pause", False)):
            with suppress(RpcError):  # a joint may be hot or moving still
                await self._arm.call(method, on=on)

    async def verify(self) -> None:
        """The daemon still serves others, and nothing of the attackers is left behind.

        Raises:
            Broken: it does not, or something gave way meanwhile.
        """
        try:
            async with asyncio.timeout(PATIENCE):
                await self._arm.call("stop")
        except (RpcError, Disconnected, TimeoutError) as error:
            raise Broken(f"another client's stop failed: {error!r}") from error
        await asyncio.sleep(2.0)
        left = [task.get_name() for task in asyncio.all_tasks() if task.get_name().startswith("client ")]
        if len(left) > 2:  # the watch and the one that recovers
            raise Broken(f"connections are left behind: {left}")
        if self.watch.wrong or self.ears.heard:
            raise Broken("\n".join([*self.watch.wrong[:5], *self.ears.heard[:3]]))


class _Plug:
    """A connection without any comfort."""

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self.writer = writer
        self._reader = reader
        self._decoder = Decoder(GENEROUS)

    async def next(self) -> Message | None:
        """The next message; None at the end of the connection."""
        while (message := next(self._decoder, None)) is None:
            try:
                data = await self._reader.read(65_536)
            except ConnectionError:
                return None
            if not data:
                return None
            self._decoder.feed(data)
        return message

    async def messages(self) -> AsyncIterator[Message]:
        while (message := await self.next()) is not None:
            yield message


@asynccontextmanager
async def plugged(path: Path) -> AsyncIterator[_Plug]:
    reader, writer = await asyncio.open_unix_connection(path)
    try:
        yield _Plug(reader, writer)
    finally:
        writer.transport.abort()
        await asyncio.sleep(0)


@asynccontextmanager
async def besieged(path: Path, arm: Client) -> AsyncIterator[Siege]:
    """The daemon of `arm`, watched from now on."""
    info = table(await arm.call("get_info"))
    methods = await arm.call("list_methods")
    assert isinstance(methods, list)
    siege = Siege(path, arm, info, [table(method) for method in methods])
    async with AsyncExitStack() as stack:
        logging.getLogger().addHandler(siege.ears)
        stack.callback(logging.getLogger().removeHandler, siege.ears)
        plug = await stack.enter_async_context(plugged(path))
        plug.writer.write(encode_request(0, "subscribe", {"topic": "state", "rate_hz": 500}))
        watching = asyncio.create_task(_see(plug, siege.watch))
        stack.callback(watching.cancel)
        yield siege


async def _see(plug: _Plug, watch: Watch) -> None:
    async for message in plug.messages():
        if isinstance(message, Notification) and message.method == "state":
            watch.look(tables({"frames": message.params}, "frames")[0])
    watch.wrong.append("the watch was hung up on")


def _names(info: Table) -> list[str]:
    joints = [str(joint["name"]) for joint in tables(info, "joints")]
    return [
        *joints,
        *table(info["groups"]),
        *(fault for fault in _texts(info["faults"]) if fault not in LYING),
    ]


def _texts(value: Value) -> list[str]:
    return [str(item) for item in value] if isinstance(value, list) else []
