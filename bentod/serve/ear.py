"""What a client says, byte by byte, until it is messages."""

import asyncio

from bentod.framing import BadFraming
from bentod.gate import Gate
from bentod.messages import Decoder
from bentod.serve.line import CHUNK, Line
from bentod.serve.requests import Requests


class Ear:
    """Bytes to messages. One that has begun must end in time, however slowly its bytes drip in.

    It never waits for its own client to read: who has stopped reading may still ask to stop.
    """

    def __init__(self, line: Line, decoder: Decoder, patience: float, gate: Gate) -> None:
        self._line = line
        self._ahead = line.ahead
        self._decoder = decoder
        self._patience = patience
        self._gate = gate
        self._deadline: float | None = None
        self._more = False

    async def hear(self) -> bool:
        """Take in what comes next; false when the client has left.

        Raises:
            BadFraming: a message did not end in time.
        """
        data, self._ahead = self._ahead, b""
        try:
            async with asyncio.timeout_at(self._deadline):
                data = data or await self._line.reader.read(CHUNK)
        except TimeoutError:
            raise BadFraming(f"A message has begun and did not end within {self._patience:g} s.") from None
        self._decoder.feed(data)
        return bool(data)

    async def pass_on(self, requests: Requests) -> None:
        """Hand over every message that is complete. Raises BadFraming: the rest can be none."""
        self._more = True
        while self._more:
            if (wait := requests.breather()) > 0:
                await asyncio.sleep(wait)
            await self._gate.submit(lambda: self._one(requests))
        if not self._decoder.pending:
            self._deadline = None
        elif self._deadline is None:
            self._deadline = asyncio.get_running_loop().time() + self._patience

    def _one(self, requests: Requests) -> bool:
        """Decode one message and hand it over; whether there may be another one, and it may come now."""
        message = next(self._decoder, None)
        self._more = message is not None
        if message is None:
            return False
        self._deadline = None
        requests.weigh(self._decoder.weight)
        requests.take(message)
        return not requests.breather()
