"""The wire between host and servos, in process: bytes take their time, and get lost if told to."""

import asyncio
import random
from collections.abc import Callable

from bentod.errors import BusError
from sim.arm import GONE, Arm
from sim.dynamixel.bus import Bus

PATIENCE = 0.1
"""s of silence after which a servo drops a packet that was begun."""


class Line:
    """A ByteStream over a simulated bus, on the running loop; advances the arm whenever it is used.

    Faults are attributes: chances (0..1) for every packet in either direction, or s.
    """

    def __init__(self, bus: Bus, arm: Arm, seed: str = "", latency: float = 0.001) -> None:
        self.bus = bus
        self.latency = latency
        """s that the USB adapter adds to every reply."""
        self.drop = 0.0
        self.corrupt = 0.0
        self.truncate = 0.0
        self.duplicate = 0.0
        self.delay = 0.0
        """s by which every reply is late."""
        self.echo = False
        """Whether the adapter returns what it sends, as half-duplex adapters without a switch do."""
        self._arm = arm
        self._loop = asyncio.get_running_loop()
        self._random = random.Random(seed)
        self._on_bytes: Callable[[bytes], None] = _ignore
        self._on_lost: Callable[[str], None] | None = None
        self._underway: set[asyncio.TimerHandle] = set()
        self._free = 0.0
        self._closed = False
        arm.watch_cable(self._cable)

    def listen(self, on_bytes: Callable[[bytes], None], on_lost: Callable[[str], None]) -> None:
        """See `drivers.stream.ByteStream`; listening again after the cable is back makes it usable again."""
        self._on_bytes = on_bytes
        self._on_lost = on_lost
        if not self._arm.plugged:
            self._cable(False)

    def write(self, data: bytes) -> None:
        """Put `data` on the wire after what is already on it."""
        if self._closed or not self._arm.plugged:
            raise BusError(GONE)
        if not data:
            return
        now = self._loop.time()
        self._arm.advance(now)
        if now - self._free > PATIENCE:
            self.bus.forget()
        # A UART makes its writer wait; here a flood would otherwise book the wire for minutes ahead.
        start = max(now, min(self._free, now + PATIENCE))
        self._free = start + self.bus.wire_time(len(data))
        if self.echo:
            self._send(self._free, data)
        for request in self._disturb(data):
            for delay, reply in self.bus.feed(request):
                self._free = max(self._free, start + delay)
                self._return(start + delay, reply)

    def close(self) -> None:
        """Forget what is underway."""
        self._closed = True
        self._arm.unwatch_cable(self._cable)
        self._cancel()

    def _return(self, at: float, reply: bytes) -> None:
        for chunk in self._disturb(reply):
            self._send(at + self.latency + self.delay + self._arm.latency, chunk)

    def _send(self, at: float, chunk: bytes) -> None:
        def arrive() -> None:
            self._underway.discard(timer)
            self._on_bytes(chunk)

        timer = self._loop.call_at(at, arrive)
        self._underway.add(timer)

    def _disturb(self, data: bytes) -> list[bytes]:
        """`data` as it comes out at the other end: nothing, once or twice, whole or not."""
        noise = self._arm.noise
        if self._happens(max(self.drop, noise)):
            return []
        if self._happens(max(self.corrupt, noise)):
            data = self._flipped(data)
        if self._happens(self.truncate):
            data = data[: self._random.randrange(len(data))]
        return [data, data] if self._happens(self.duplicate) else [data]

    def _happens(self, chance: float) -> bool:
        return chance > 0 and self._random.random() < chance

    def _flipped(self, data: bytes) -> bytes:
        """`data` (not empty) with one bit of one byte changed."""
        damaged = bytearray(data)
        damaged[self._random.randrange(len(data))] ^= 1 << self._random.randrange(8)
        return bytes(damaged)

    def _cable(self, plugged: bool) -> None:
        """Tell the listener once that the line is gone."""
        if plugged or self._closed:
            return
        self._cancel()
        if self._on_lost is not None:
            self._loop.call_soon(self._on_lost, GONE)
            self._on_lost = None

    def _cancel(self) -> None:
        for timer in self._underway:
            timer.cancel()
        self._underway.clear()


def _ignore(data: bytes) -> None:
    """Nobody listens yet."""
