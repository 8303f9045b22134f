"""A client that keeps books: what it asked, and how often each question was answered."""

import asyncio
import itertools
from collections.abc import Callable
from dataclasses import dataclass, field

from bentod.endpoint import GENEROUS
from bentod.errors import BentodError
from bentod.frames import Value
from bentod.messages import Decoder, Response, encode_request
from tests.invariants.steps import Call


@dataclass(slots=True, eq=False)
class Asked:
    """One question."""

    call: Call
    sent: float  # s
    names: frozenset[str]  # that the client went by so far
    done: asyncio.Future[Response]


OnAnswer = Callable[["Speaker", Asked, Response], None]


@dataclass(slots=True, eq=False)
class Speaker(asyncio.Protocol):
    """One connection. Told to leave it leaves at once, whatever is open."""

    name: str
    on_answer: OnAnswer
    broken: Callable[[str], None]
    gone: bool = False  # it left, or gave the daemon a reason to hang up
    names: set[str] = field(default_factory=set)
    open: dict[int, Asked] = field(default_factory=dict)
    _ids: "itertools.count[int]" = field(default_factory=itertools.count)
    _decoder: Decoder = field(default_factory=lambda: Decoder(GENEROUS))
    _transport: asyncio.Transport | None = None

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        assert isinstance(transport, asyncio.Transport)
        self._transport = transport
        self.ask(Call(0, "hello", [self.name]))

    def ask(self, call: Call) -> Asked:
        """Send a request; its answer is booked when it comes."""
        loop = asyncio.get_running_loop()
        assert self._transport
        if call.method == "hello":
            self.names |= _texts(call.params)
        id_ = next(self._ids)
        asked = self.open[id_] = Asked(call, loop.time(), frozenset(self.names), loop.create_future())
        self._transport.write(encode_request(id_, call.method, call.params))
        return asked

    def garble(self, data: bytes) -> None:
        """Send bytes that may be no message, or half of one, and be gone."""
        if self._transport:
            self._transport.write(data)
        self.vanish()

    def vanish(self) -> None:
        """Be gone without a word."""
        self.gone = True
        if self._transport:
            self._transport.abort()

    def data_received(self, data: bytes) -> None:
        self._decoder.feed(data)
        try:
            for message in self._decoder:
                if isinstance(message, Response):
                    self._book(message)
        except BentodError as error:
            self.broken(f"{self.name} was sent what is no message: {error}")

    def connection_lost(self, exc: Exception | None) -> None:
        self._transport = None
        for asked in self.open.values():
            asked.done.cancel()
        if not self.gone:
            self.gone = True
            self.broken(f"the daemon hung up on {self.name}")

    def _book(self, response: Response) -> None:
        asked = self.open.pop(response.id, None)
        if asked is None:
            if not self.gone:  # garbled bytes may have been a request after all
                self.broken(f"{self.name} got an answer to {response.id}, which was not open: {response}")
            return
        asked.done.set_result(response)
        self.on_answer(self, asked, response)


def _texts(params: Value) -> set[str]:
    if isinstance(params, str):
        return {params}
    values = params.values() if isinstance(params, dict) else params if isinstance(params, list) else ()
    return {text for value in values for text in _texts(value)}
