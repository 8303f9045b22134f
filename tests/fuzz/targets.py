"""What the guided search runs again and again: bytes in, an exception when something gives way."""

import asyncio
import tempfile
from contextlib import AsyncExitStack
from pathlib import Path
from random import Random

from bentod.framing import BadFraming
from bentod.messages import Decoder, Message, encode_request
from sim.clock import VirtualLoop
from tests.fuzz.grammar import Grammar, pieces
from tests.fuzz.siege import Broken, Siege, besieged
from tests.rig import PLAIN, quiet_config, running

LIFE = 400
"""Inputs after which a daemon is replaced, so that what broke it can be found again."""

REST = 50
"""Inputs after which the arm is mended and everything is looked at."""


def framing(data: bytes) -> None:
    """A stream is read alike however it is cut, or refused alike.

    Raises:
        Broken: it is not.
    """
    random = Random(len(data))
    whole = decoded([data])
    for cut in (pieces(data, random), [data[at : at + 1] for at in range(len(data))]):
        found = decoded(cut)
        if repr(found) != repr(whole):  # as text, because NaN is not NaN
            raise Broken(f"{data!r} is {whole} in one piece and {found} in {len(cut)}")


def decoded(chunks: list[bytes]) -> tuple[list[Message], bool]:
    """The messages in a stream, and whether it was refused then."""
    decoder = Decoder()
    messages: list[Message] = []
    try:
        for chunk in chunks:
            decoder.feed(chunk)
            for message in decoder:
                messages.append(message)
    except BadFraming:
        return messages, True
    return messages, False


class Fortress:
    """Daemons in virtual time, one after the other, that take every input."""

    def __init__(self) -> None:
        self.history: list[bytes] = []
        """What the present daemon was sent."""
        self._runner = asyncio.Runner(loop_factory=VirtualLoop)
        self._stack = AsyncExitStack()
        self._siege: Siege | None = None

    @property
    def grammar(self) -> Grammar:
        """Of the daemon."""
        return self._open().grammar

    def take(self, data: bytes) -> None:
        """Send `data`; its first byte says how it is cut.

        Raises:
            Broken: the daemon did not hold.
        """
        if len(self.history) >= LIFE:
            self.close()
        siege = self._open()
        self.history.append(data)
        self._runner.run(siege.bytes(pieces(data[1:], Random(data[0]), 4)) if data else siege.bytes([]))
        if len(self.history) % REST == 0:
            self._runner.run(siege.verify())
            self._runner.run(siege.recover())

    def close(self) -> None:
        """Let the present daemon end."""
        self._runner.run(self._stack.aclose())
        self._siege = None
        self.history.clear()

    def _open(self) -> Siege:
        if self._siege is None:
            self._siege = self._runner.run(self._start())
        return self._siege

    async def _start(self) -> Siege:
        path = Path(self._stack.enter_context(tempfile.TemporaryDirectory()), "bentod.sock")
        arm = await self._stack.enter_async_context(running(quiet_config(PLAIN), path))
        return await self._stack.enter_async_context(besieged(path, arm))


def seeds(grammar: Grammar) -> list[bytes]:
    """Every method a few times, called as it should be, and some streams that are not."""
    random = Random(1)
    names = [str(method["name"]) for method in grammar.methods]
    calls = [grammar.call(random, name, 0.0) for name in names for _ in range(4)]
    whole = [b"\0" + encode_request(1, method, params) for method, params in calls]
    return whole + [b"\1" + grammar.stream(random) for _ in range(100)]
