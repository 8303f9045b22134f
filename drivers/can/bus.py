"""Real buses, by way of python-can: SocketCAN, adapters, and the buses in software.

Tried on `virtual` and `udp_multicast` only; SocketCAN and adapters never.
"""

import asyncio
import threading
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager, suppress

import can

from bentod.contracts import ArmConfig, Clock
from bentod.errors import BusError
from drivers.can.joints import CanJoints, open_over
from drivers.can.link import Frame
from drivers.can.options import Options, parse_options

FOREIGN = (can.CanError, OSError, ValueError, TypeError, ImportError, RuntimeError)
"""What opening, reading and writing a bus of python-can raise."""

AT_ONCE = 64
"""Frames taken from the bus before others get a turn: more than an arm sends in 10 ms."""

PAUSE = 0.1
"""s before a bus that failed is listened to again."""

POLL = 0.05
"""s that a thread waits for a frame before it looks whether to end."""


class BusLink:
    """A `CanLink` over a bus of python-can, on the running loop.

    Not python-can's own Notifier: that one lets an error of the bus end its thread, or pass as an
    unhandled exception of the loop, and it takes one frame a turn.
    """

    def __init__(self, bus: can.BusABC, name: str) -> None:
        """`bus` is closed with the link; `name` is for sentences."""
        self._bus = bus
        self._name = name
        self._loop = asyncio.get_running_loop()
        self._on_frame: Callable[[Frame], None] = _ignore_frame
        self._on_trouble: Callable[[str], None] = _ignore_trouble
        self._ending = threading.Event()
        self._again: asyncio.TimerHandle | None = None
        self._thread: threading.Thread | None = None
        self._fd = _fileno(bus)
        if self._fd >= 0:
            self._loop.add_reader(self._fd, self._readable)
        else:
            self._thread = threading.Thread(target=self._receive, name=f"CAN {name}", daemon=True)
            self._thread.start()

    def listen(self, on_frame: Callable[[Frame], None], on_trouble: Callable[[str], None]) -> None:
        """See `CanLink`."""
        self._on_frame, self._on_trouble = on_frame, on_trouble

    def send(self, frame: Frame) -> None:
        """See `CanLink`; takes 10 to 40 µs and never waits."""
        message = can.Message(
            arbitration_id=frame.id,
            data=None if frame.remote else frame.data,
            is_extended_id=False,
            is_remote_frame=frame.remote,
        )
        try:
            self._bus.send(message, timeout=0)
        except FOREIGN as error:
            raise BusError(f"The CAN bus {self._name} takes no frames: {error}.") from error

    async def close(self) -> None:
        """Give the bus back."""
        self._ending.set()
        if self._again is not None:
            self._again.cancel()
        if self._fd >= 0:
            self._loop.remove_reader(self._fd)
        if self._thread is not None:
            await asyncio.to_thread(self._thread.join)
        with suppress(*FOREIGN):
            self._bus.shutdown()

    def _readable(self) -> None:
        try:
            for _ in range(AT_ONCE):
                message = self._bus.recv(0)
                if message is None:
                    break
                self._deliver(message)
        except FOREIGN as error:
            self._trouble(error)
            self._loop.remove_reader(self._fd)  # a bus that is gone stays readable, and would fill the loop
            self._again = self._loop.call_later(PAUSE, self._loop.add_reader, self._fd, self._readable)

    def _receive(self) -> None:
        """The thread of a bus that the loop cannot wait for."""
        while not self._ending.is_set():
            try:
                message = self._bus.recv(POLL)
                if message is not None:
                    self._loop.call_soon_threadsafe(self._deliver, message)
            except FOREIGN as error:
                self._loop.call_soon_threadsafe(self._trouble, error)
                self._ending.wait(PAUSE)

    def _deliver(self, message: can.Message) -> None:
        if message.is_error_frame or message.is_extended_id or message.is_fd or self._ending.is_set():
            return
        self._on_frame(Frame(message.arbitration_id, bytes(message.data), message.is_remote_frame))

    def _trouble(self, error: Exception) -> None:
        self._on_trouble(f"The CAN bus {self._name} cannot be read: {error}.")


@asynccontextmanager
async def open_link(options: Options) -> AsyncIterator[BusLink]:
    """The bus that the options name.

    Raises:
        BusError: it cannot be opened.
    """
    name = f"{options.interface} {options.channel}"
    try:
        bus = _open(options)
    except FOREIGN as error:
        raise BusError(f"The CAN bus {name} cannot be opened: {error}.") from error
    link = BusLink(bus, name)
    try:
        yield link
    finally:
        await asyncio.shield(link.close())


@asynccontextmanager
async def open_joints(config: ArmConfig, clock: Clock) -> AsyncIterator[CanJoints]:
    """Joints on the bus that the options name.

    Raises:
        ConfigError, BusError: as `open_over`; also when the bus cannot be opened.
    """
    async with open_link(parse_options(config.options)) as link, open_over(link, config, clock) as joints:
        yield joints


def _open(options: Options) -> can.BusABC:
    if options.interface == "udp_multicast":
        # A simulated arm must not listen to whoever else is on the network: hop limit 0.
        return can.Bus(
            channel=options.channel, interface=options.interface, port=options.udp_port, hop_limit=0
        )
    if options.interface == "virtual":
        return can.Bus(channel=options.channel, interface=options.interface)
    return can.Bus(channel=options.channel, interface=options.interface, bitrate=options.bitrate)


def _fileno(bus: can.BusABC) -> int:
    try:
        return bus.fileno()
    except NotImplementedError:
        return -1


def _ignore_frame(frame: Frame) -> None:
    """Nobody listens yet."""


def _ignore_trouble(reason: str) -> None:
    """Nobody listens yet."""
