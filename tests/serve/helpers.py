"""What the tests of the socket share: a small table of methods, frames, and a client without any comfort."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Annotated, Literal

from bentod.errors import Refused
from bentod.frames import AssistFrame, Costs, EmgFrame, Event, Frame, Mode, Value
from bentod.framing import Limits
from bentod.messages import Decoder, Message, encode_request
from bentod.serve.params import Number, Text
from bentod.serve.server import Server
from bentod.serve.session import Bounds, Session
from bentod.serve.spec import Handler, table


async def double(
    session: Session, number: Annotated[float, Number("rad", -10, 10, "what to double")]
) -> Value:
    """Twice a number."""
    return 2 * number


async def refuse(session: Session) -> Value:
    """Never do it."""
    raise Refused("The arm is paused.", "joint")


async def break_down(session: Session) -> Value:
    """Show a bug."""
    raise ZeroDivisionError("oops")


async def wait(session: Session, seconds: Annotated[float, Number("s", 0, 100, "how long")]) -> Value:
    """Answer later."""
    await asyncio.sleep(seconds)
    return seconds


async def subscribe(
    session: Session,
    topic: Annotated[str, Text("what", choices=("state", "events"))],
    rate_hz: Annotated[float, Number("Hz", 0.1, 500, "how often")] = 30.0,
) -> Value:
    """Send notifications."""
    session.subscribe(_topic(topic), rate_hz)
    return None


async def unsubscribe(session: Session, topic: Annotated[str, Text("what")]) -> Value:
    """Send no more."""
    session.unsubscribe(_topic(topic))
    return None


def _topic(name: str) -> Literal["state", "events"]:
    return "state" if name == "state" else "events"


TOYS: tuple[Handler, ...] = (double, refuse, break_down, wait, subscribe, unsubscribe)


def frame(tick: int, meta: Value = None) -> Frame:
    """A frame of an arm without joints, at 30 Hz."""
    return Frame(
        tick=tick,
        time=tick / 30,
        wall=0.0,
        lateness=0.0,
        missed=0,
        costs=Costs(0.0, 0.0, 0.0, 0.0),
        shed=0,
        rate_hz=30.0,
        mode=Mode.ACTIVE,
        fault="",
        joints=(),
        emg=EmgFrame(True, False, "", 0, 0.0, 0, {}, 0),
        groups=(),
        assist=AssistFrame("off", False, ""),
        goal=None,
        meta=meta,
    )


def event(number: int) -> Event:
    """A numbered event."""
    return Event(0.0, "group", "The wrist is active.", {"number": number})


class Plug:
    """A raw connection that speaks whole messages, or any bytes."""

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self.writer = writer
        self._reader = reader
        self._decoder = Decoder(Limits(size=2**22, items=2**16))

    def ask(self, id_: int, method: str, *params: Value) -> None:
        self.writer.write(encode_request(id_, method, list(params)))

    @property
    def has_ended(self) -> bool:
        """Whether the server has closed the connection."""
        return self._reader.at_eof() or self._reader.exception() is not None

    async def next(self) -> Message | None:
        """The next message; None at the end of the connection."""
        while (message := next(self._decoder, None)) is None:
            data = await self._reader.read(4096)
            if not data:
                return None
            self._decoder.feed(data)
        return message


@asynccontextmanager
async def plugged(path: Path) -> AsyncIterator[Plug]:
    reader, writer = await asyncio.open_unix_connection(path)
    try:
        yield Plug(reader, writer)
    finally:
        writer.transport.abort()
        await asyncio.sleep(0)


def serving(path: Path, *handlers: Handler, bounds: Bounds | None = None) -> Server:
    """A server of the toys and of `handlers`."""
    return Server(table(observer=TOYS + handlers), path, bounds)
