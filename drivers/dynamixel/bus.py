"""One transaction at a time on a bus of servos: ask, and collect who answered before the deadline."""

import asyncio
import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field

from bentod.contracts import Clock
from bentod.errors import BusError
from drivers.dynamixel import protocol2
from drivers.dynamixel.codec import CODECS, Codec, Version
from drivers.dynamixel.packets import Status
from drivers.stream import ByteStream

BITS_PER_BYTE = 10
"""8 data bits, a start bit and a stop bit."""

SLOWEST_RETURN = 254 * 2e-6
"""s: the longest Return Delay Time that a servo can be set to."""

LONGEST_REPLY = 64
"""bytes of data: more than is ever asked for."""


@dataclass(frozen=True, slots=True)
class Reply:
    """What one servo answered."""

    error: int  # the error byte, as the servo's protocol defines it
    data: bytes
    time: float  # monotonic s, when it arrived


@dataclass(slots=True)
class _Pending:
    """A question under way."""

    codec: Codec
    request: bytes
    ids: Sequence[int]  # in the order in which they reply
    size: int  # bytes of data that each replies
    done: asyncio.Future[None]
    sent: bool = False
    replies: dict[int, Reply] = field(default_factory=dict)

    def answered_by(self, status: Status) -> bool:
        """Whether `status` is a reply to this question, and not its echo or a reply to another."""
        return (
            self.sent
            and status.id in self.ids
            and len(status.parameters) == self.size
            and self.codec.is_reply(status, self.request)
        )


class Bus:
    """Servos on one line, of either protocol."""

    def __init__(self, stream: ByteStream, clock: Clock, baud: int, reply_margin: float) -> None:
        """`baud`: bit/s; `reply_margin`: s to wait for a reply beyond its computed time on the wire."""
        self._clock = clock
        self._byte_time = BITS_PER_BYTE / baud
        self._margin = reply_margin
        self._return_delay: dict[int, float] = {}
        self._parsers = {version: codec.parser(LONGEST_REPLY) for version, codec in CODECS.items()}
        self._parser = self._parsers[1]
        self._pending: _Pending | None = None
        self._unsettled = False
        self.problem = ""
        """Why nothing can be reached any more, a sentence; empty while the line stands."""
        self.last_sent = -math.inf
        """Monotonic s of the last instruction that was sent."""
        self.attach(stream)

    def attach(self, stream: ByteStream) -> None:
        """Use another line from now on, in place of one that is gone; the caller has closed that one."""

        def lost(reason: str) -> None:
            if self._stream is stream:
                self._on_lost(reason)

        self._stream = stream
        self.problem = ""
        stream.listen(self._on_bytes, lost)

    def set_return_delay(self, id_: int, delay: float) -> None:
        """A servo's Return Delay Time (s), as read from it."""
        self._return_delay[id_] = delay

    def longest_read(self, version: Version, ids: Sequence[int], size: int) -> float:
        """Time (s) that a `read` takes when nobody answers."""
        codec = CODECS[version]
        return self._duration(codec, _reading(codec, ids, 0, size), ids, size)

    async def read(
        self, version: Version, ids: Sequence[int], address: int, size: int
    ) -> Mapping[int, Reply]:
        """Who answered with `size` bytes from `address`; several are asked by one instruction, in order."""
        codec = CODECS[version]
        return await self._ask(version, _reading(codec, ids, address, size), ids, size)

    async def ping(self, version: Version, id_: int) -> Reply | None:
        """The servo's answer, None when there was none."""
        codec = CODECS[version]
        return (await self._ask(version, codec.ping(id_), (id_,), codec.ping_size)).get(id_)

    async def write(self, version: Version, id_: int, address: int, data: bytes) -> Reply | None:
        """Write to one servo; None when it did not confirm."""
        return (await self._ask(version, CODECS[version].write(id_, address, data), (id_,), 0)).get(id_)

    async def reboot(self, id_: int) -> Reply | None:
        """Have a servo of protocol 2.0 start anew; None when it did not confirm."""
        return (await self._ask(2, protocol2.reboot(id_), (id_,), 0)).get(id_)

    def sync_write(self, version: Version, address: int, data: Mapping[int, bytes]) -> None:
        """Write to several servos at once, by id. Nobody confirms; on a line that is gone nothing happens."""
        self._send(CODECS[version].sync_write(address, data))

    async def settle(self) -> None:
        """Wait until a late reply to an earlier question has come and gone."""
        await self._clock.sleep_until(self._clock.now() + self._margin)

    async def _ask(
        self, version: Version, packet: bytes, ids: Sequence[int], size: int
    ) -> Mapping[int, Reply]:
        codec = CODECS[version]
        with self._transaction(_Pending(codec, packet, ids, size, _future())) as pending:
            await self._discard_late_bytes(version)
            deadline = self._clock.now() + self._duration(codec, packet, ids, size)
            pending.sent = True
            self._send(packet)
            try:
                async with asyncio.timeout_at(deadline):
                    await pending.done
            except BaseException as error:  # who asked gave up: the answer may come all the same
                self._unsettled = True
                if not isinstance(error, TimeoutError):
                    raise
        return pending.replies

    def _duration(self, codec: Codec, request: bytes, ids: Sequence[int], size: int) -> float:
        """Time on the wire of the request and all replies, the servos' return delays, and the margin, s."""
        on_wire = len(request) + len(ids) * (codec.overhead + size)
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

    async def _discard_late_bytes(self, version: Version) -> None:
        """Drop what is left of an earlier question.

        Bytes that wait in the port are delivered, and belong to nobody, within one turn of the loop;
        the first `sleep` ends before that turn looks at the port, the second after.
        """
        if self._unsettled:
            await asyncio.sleep(0)
            await asyncio.sleep(0)
            self._unsettled = False
        self._parser = self._parsers[version]
        self._parser.clear()

    def _send(self, packet: bytes) -> None:
        if self.problem:
            self._finish()
            return
        self.last_sent = self._clock.now()
        try:
            self._stream.write(packet)
        except BusError as error:
            self._on_lost(str(error))

    def _on_bytes(self, data: bytes) -> None:
        for status in self._parser.feed(data):
            self._take(status)

    def _take(self, status: Status) -> None:
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


def _reading(codec: Codec, ids: Sequence[int], address: int, size: int) -> bytes:
    if len(ids) == 1:  # the manual: a bulk read "cannot be used to read a single module"
        return codec.read(ids[0], address, size)
    return codec.group_read(ids, address, size)


def _future() -> asyncio.Future[None]:
    return asyncio.get_running_loop().create_future()
