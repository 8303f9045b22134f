"""One transaction at a time on a bus of servos: ask, and collect who answered before the deadline."""

import asyncio
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field

from bentod.contracts import Clock
from bentod.errors import BusError
from drivers.dynamixel import protocol1
from drivers.stream import ByteStream

BITS_PER_BYTE = 10
"""8 data bits, a start bit and a stop bit."""

SLOWEST_RETURN = 254 * 2e-6
"""s: the longest Return Delay Time that a servo can be set to."""

LONGEST_REPLY = 32
"""bytes of data: more than is ever asked for."""


@dataclass(frozen=True, slots=True)
class Reply:
    """What one servo answered."""

    error: int  # bits as named in `tables.ERRORS`
    data: bytes
    time: float  # monotonic s, when it arrived


@dataclass(slots=True)
class _Pending:
    """A question under way."""

    request: bytes
    ids: Sequence[int]  # in the order in which they reply
    size: int  # bytes of data that each replies
    done: asyncio.Future[None]
    replies: dict[int, Reply] = field(default_factory=dict)

    def answered_by(self, status: protocol1.Status) -> bool:
        """Whether `status` is a reply to this question, and not its echo or a reply to another."""
        if status.id not in self.ids or len(status.parameters) != self.size:
            return False
        # Half-duplex adapters may return what is sent. The echo of a ping cannot be told from its reply;
        # the first reading after it can.
        return not status.parameters or self.request[4:-1] != bytes((status.error,)) + status.parameters


class Bus:
    """Servos on one line."""

    def __init__(self, stream: ByteStream, clock: Clock, baud: int, reply_margin: float) -> None:
        """`baud`: bit/s; `reply_margin`: s to wait for a reply beyond its computed time on the wire."""
        self._stream = stream
        self._clock = clock
        self._byte_time = BITS_PER_BYTE / baud
        self._margin = reply_margin
        self._return_delay: dict[int, float] = {}
        self._parser = protocol1.Parser(LONGEST_REPLY)
        self._pending: _Pending | None = None
        self._unsettled = False
        self.problem = ""
        """Why nothing can be reached any more, a sentence; empty while the line stands."""
        stream.listen(self._on_bytes, self._on_lost)

    def set_return_delay(self, id_: int, delay: float) -> None:
        """A servo's Return Delay Time (s), as read from it."""
        self._return_delay[id_] = delay

    def longest_read(self, ids: Sequence[int], size: int) -> float:
        """Time (s) that a `read` takes when nobody answers."""
        return self._duration(_reading(ids, 0, size), ids, size)

    async def read(self, ids: Sequence[int], address: int, size: int) -> Mapping[int, Reply]:
        """Who answered with `size` bytes from `address`; several are asked by one bulk read, in order."""
        return await self._ask(_reading(ids, address, size), ids, size)

    async def ping(self, id_: int) -> Reply | None:
        """The servo's answer, None when there was none."""
        return (await self._ask(protocol1.ping(id_), (id_,), 0)).get(id_)

    async def write(self, id_: int, address: int, data: bytes) -> Reply | None:
        """Write to one servo; None when it did not confirm."""
        return (await self._ask(protocol1.write(id_, address, data), (id_,), 0)).get(id_)

    def sync_write(self, address: int, data: Mapping[int, bytes]) -> None:
        """Write to several servos at once, by id. Nobody confirms; on a line that is gone nothing happens."""
        self._send(protocol1.sync_write(address, data))

    async def settle(self) -> None:
        """Wait until a late reply to an earlier question has come and gone."""
        await self._clock.sleep_until(self._clock.now() + self._margin)

    async def _ask(self, packet: bytes, ids: Sequence[int], size: int) -> Mapping[int, Reply]:
        with self._transaction(_Pending(packet, ids, size, _future())) as pending:
            await self._discard_late_bytes()
            deadline = self._clock.now() + self._duration(packet, ids, size)
            self._send(packet)
            try:
                async with asyncio.timeout_at(deadline):
                    await pending.done
            except TimeoutError:
                self._unsettled = True
        return pending.replies

    def _duration(self, request: bytes, ids: Sequence[int], size: int) -> float:
        """Time on the wire of the request and all replies, the servos' return delays, and the margin, s."""
        on_wire = len(request) + len(ids) * (protocol1.OVERHEAD + size)
        delays = sum(self._return_delay.get(id_, SLOWEST_RETURN) for id_ in ids)
        return on_wire * self._byte_time + delays + self._margin

    @contextmanager
    def _transaction(self, pending: _Pending) -> Iterator[_Pending]:
        if self._pending is not None:
            raise RuntimeError("The bus was asked twice at the same time.")
        self._pending = pending
        try:
            yield pending
        finally:
            self._pending = None

    async def _discard_late_bytes(self) -> None:
        """Drop what is left of an earlier question.

        Bytes that wait in the port are delivered, and belong to nobody, within one turn of the loop;
        the first `sleep` ends before that turn looks at the port, the second after.
        """
        if self._unsettled:
            await asyncio.sleep(0)
            await asyncio.sleep(0)
            self._unsettled = False
        self._parser.clear()

    def _send(self, packet: bytes) -> None:
        if self.problem:
            self._finish()
            return
        try:
            self._stream.write(packet)
        except BusError as error:
            self._on_lost(str(error))

    def _on_bytes(self, data: bytes) -> None:
        for status in self._parser.feed(data):
            self._take(status)

    def _take(self, status: protocol1.Status) -> None:
        pending = self._pending
        if pending is None or not pending.answered_by(status):
            return
        pending.replies[status.id] = Reply(status.error, status.parameters, self._clock.now())
        if status.id == pending.ids[-1]:  # nobody replies after the last
            self._finish()

    def _on_lost(self, reason: str) -> None:
        self.problem = self.problem or reason
        self._finish()

    def _finish(self) -> None:
        if self._pending is not None and not self._pending.done.done():
            self._pending.done.set_result(None)


def _reading(ids: Sequence[int], address: int, size: int) -> bytes:
    if len(ids) == 1:  # the manual: a bulk read "cannot be used to read a single module"
        return protocol1.read(ids[0], address, size)
    return protocol1.bulk_read(ids, address, size)


def _future() -> asyncio.Future[None]:
    return asyncio.get_running_loop().create_future()
