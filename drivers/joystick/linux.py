"""A joystick or gamepad through the Linux kernel's joystick devices, /dev/input/js*; it may come and go."""

import asyncio
import os
from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager

from bentod.contracts import Clock, Pad
from bentod.frames import Value
from drivers.joystick.events import RECORD, Controls
from drivers.joystick.options import LinuxOptions, parse

RETRY_S = 1.0
"""s between two attempts to open the device."""

CHUNK = 64 * RECORD.size
"""Bytes of a read: all that the kernel keeps for a reader (JOYDEV_BUFFER_SIZE of drivers/input/joydev.c)."""

MOST_READS = 16
"""Reads at a time. A thousand events since the last tick are no joystick's."""


class LinuxPad:
    """The device while it is there.

    The kernel tells of changes only. That a pad which says nothing is still plugged in is known by reading:
    a device that is gone answers with an error instead of "nothing new", so every look asks. A wireless pad
    that is out of reach while its receiver stays plugged in cannot be told from one that is held still.
    """

    def __init__(self, device: str, clock: Clock) -> None:
        self._device = device
        self._clock = clock
        self._fd: int | None = None
        self._lost = asyncio.Event()
        self._reason = f"{device} has not been opened yet."
        self._openings = 0
        self._changed = clock.now()
        self._controls = Controls()

    def latest(self) -> Pad:
        """What has been told up to this moment."""
        self._drain()
        if self._fd is None:
            return Pad(reason=self._reason, openings=self._openings)
        told = self._controls
        return Pad(
            connected=True,
            axes=told.axes,
            buttons=told.buttons,
            presses=told.presses,
            openings=self._openings,
            seen=self._clock.now(),
            changed=self._changed,
        )

    async def keep_open(self) -> None:
        """Open the device, and again whenever it was lost."""
        while True:
            try:
                self._take(await _opened(self._device))
                await self._lost.wait()
            except OSError as error:
                self._lose(f"{self._device} cannot be opened: {error.strerror}.")
            await self._clock.sleep_until(self._clock.now() + RETRY_S)

    def close(self) -> None:
        """Give the device back, if it is open."""
        if self._fd is not None:
            asyncio.get_running_loop().remove_reader(self._fd)
            os.close(self._fd)
            self._fd = None

    def _take(self, fd: int) -> None:
        self._fd = fd
        self._lost.clear()
        self._controls = Controls()
        self._changed = self._clock.now()
        self._openings += 1
        asyncio.get_running_loop().add_reader(fd, self._drain)

    def _lose(self, reason: str) -> None:
        self.close()
        self._reason = reason
        self._lost.set()

    def _drain(self) -> None:
        """Read all that there is, which also tells whether the device is."""
        for _ in range(MOST_READS):
            if self._fd is None:
                return
            try:
                data = os.read(self._fd, CHUNK)
            except BlockingIOError:
                return
            except OSError as error:
                return self._lose(f"{self._device} is gone: {error.strerror}.")
            if not data:
                return self._lose(f"{self._device} is gone: it has ended.")
            self._controls.feed(data)
            self._changed = self._clock.now()
        self._lose(f"{self._device} sends more than a joystick can.")


async def _opened(device: str) -> int:
    """The descriptor of the device. Raises OSError: it cannot be opened.

    A thread opens it: for a pad on USB the kernel sleeps 50 ms in that call (usbhid_open of
    drivers/hid/usbhid/hid-core.c), for which no tick may wait.
    """
    opening = asyncio.get_running_loop().run_in_executor(
        None, os.open, device, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC
    )
    try:
        return await asyncio.shield(opening)
    except asyncio.CancelledError:
        opening.add_done_callback(_close_late)
        raise


def _close_late(opening: "asyncio.Future[int]") -> None:
    if not opening.cancelled() and opening.exception() is None:
        os.close(opening.result())


@asynccontextmanager
async def open_joystick(options: Mapping[str, Value], clock: Clock) -> AsyncIterator[LinuxPad]:
    """The joystick device of the options, whenever it is there.

    Raises:
        ConfigError: an option is unknown or out of bounds.
    """
    pad = LinuxPad(parse(LinuxOptions, options).device, clock)
    async with asyncio.TaskGroup() as tasks:
        keeping = tasks.create_task(pad.keep_open(), name="joystick")
        try:
            yield pad
        finally:
            keeping.cancel()
            pad.close()
