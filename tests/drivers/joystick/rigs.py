"""Pads for tests: each is pushed, pulled out and plugged in by hand, whoever reads it."""

import asyncio
import ctypes
import os
import re
import struct
from collections.abc import AsyncIterator, Callable, Iterable, Mapping
from contextlib import AbstractAsyncContextManager, asynccontextmanager, suppress
from pathlib import Path
from typing import Protocol, TypeAlias

from bentod.contracts import JoystickSource, OpenJoystick, Pad
from bentod.frames import Value
from drivers.joystick import linux, sdl
from sim import joystick
from sim.clock import VirtualClock
from sim.joystick import SimPad

AXES, BUTTONS = 3, 6


class Rig(Protocol):
    """Somebody's hands on a pad of three axes and six buttons."""

    def push(self, axis: int, value: float) -> None: ...

    def press(self, *buttons: int) -> None:
        """Hold exactly these."""

    def unplug(self) -> None: ...

    def plug(self) -> None: ...


Opened: TypeAlias = tuple[JoystickSource, Rig]


async def until(source: JoystickSource, condition: Callable[[Pad], bool]) -> Pad:
    """The first look that meets `condition`; fails after 10 s."""
    async with asyncio.timeout(10):
        while not condition(pad := source.latest()):  # noqa: ASYNC110 -- a look is all that there is
            await asyncio.sleep(0.001)
    return pad


class Kernel:
    """What the kernel's joystick device gives, through a named pipe."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._fd = -1
        self._held: set[int] = set()
        self._axes = [0.0] * AXES

    def plug(self) -> None:
        os.mkfifo(self._path)
        self._fd = os.open(self._path, os.O_RDWR | os.O_NONBLOCK)
        self._write((0x82, axis, round(32767 * value)) for axis, value in enumerate(self._axes))
        self._write((0x81, button, button in self._held) for button in range(BUTTONS))

    def push(self, axis: int, value: float) -> None:
        self._axes[axis] = value
        self._write([(0x02, axis, round(32767 * value))])

    def press(self, *buttons: int) -> None:
        changed = self._held ^ {*buttons}
        self._held = {*buttons}
        self._write((0x01, button, button in self._held) for button in sorted(changed))

    def unplug(self) -> None:
        self._path.unlink()
        os.close(self._fd)
        self._fd = -1

    def close(self) -> None:
        if self._fd >= 0:
            os.close(self._fd)

    def _write(self, records: Iterable[tuple[int, int, int]]) -> None:
        if self._fd >= 0:
            for kind, number, value in records:
                os.write(self._fd, struct.pack("<IhBB", 1000, value, kind, number))


@asynccontextmanager
async def open_linux(folder: Path) -> AsyncIterator[Opened]:
    """The driver of the kernel's device, with a pad plugged in."""
    rig = Kernel(folder / "js0")
    rig.plug()
    try:
        async with linux.open_joystick({"device": str(folder / "js0")}, VirtualClock()) as source:
            yield source, rig
    finally:
        rig.close()


@asynccontextmanager
async def open_sim(folder: Path) -> AsyncIterator[Opened]:
    """The simulated pad, which is its own rig."""
    options: Mapping[str, Value] = {"axes": AXES, "buttons": BUTTONS}
    open_it: OpenJoystick = joystick.open_joystick
    async with open_it(options, VirtualClock()) as source:
        assert isinstance(source, SimPad)
        yield source, source


def _library() -> ctypes.CDLL:
    """The SDL that pygame has loaded."""
    maps = Path("/proc/self/maps").read_text()
    found = re.search(r"\S*/libSDL2-\S*", maps)
    assert found, "pygame has loaded no SDL"
    library = ctypes.CDLL(found[0])
    library.SDL_JoystickOpen.restype = ctypes.c_void_p
    library.SDL_JoystickSetVirtualAxis.argtypes = [ctypes.c_void_p, ctypes.c_int, ctypes.c_int16]
    library.SDL_JoystickSetVirtualButton.argtypes = [ctypes.c_void_p, ctypes.c_int, ctypes.c_uint8]
    library.SDL_JoystickClose.argtypes = [ctypes.c_void_p]
    return library


class Virtual:
    """SDL's own virtual joystick."""

    def __init__(self) -> None:
        self._sdl = _library()
        self._index = -1
        self._stick = 0
        self._held: set[int] = set()

    async def first(self) -> None:
        """Plug it in once the thread has started SDL."""
        async with asyncio.timeout(10):
            while not self._sdl.SDL_WasInit(0x200):  # noqa: ASYNC110 -- a thread does that
                await asyncio.sleep(0.001)
        self.plug()

    def plug(self) -> None:
        self._index = self._sdl.SDL_JoystickAttachVirtual(1, AXES, BUTTONS, 0)
        assert self._index >= 0
        self._stick = self._sdl.SDL_JoystickOpen(self._index)
        for button in self._held:
            self._sdl.SDL_JoystickSetVirtualButton(self._stick, button, 1)

    def push(self, axis: int, value: float) -> None:
        self._sdl.SDL_JoystickSetVirtualAxis(self._stick, axis, round(32767 * value))

    def press(self, *buttons: int) -> None:
        for button in self._held ^ {*buttons}:
            if self._stick:
                self._sdl.SDL_JoystickSetVirtualButton(self._stick, button, button in buttons)
        self._held = {*buttons}

    def unplug(self) -> None:
        self._sdl.SDL_JoystickClose(self._stick)
        self._sdl.SDL_JoystickDetachVirtual(self._index)
        self._stick = 0


@asynccontextmanager
async def open_sdl(folder: Path) -> AsyncIterator[Opened]:
    """The driver through SDL, with a virtual pad plugged in."""
    async with sdl.open_joystick({}, VirtualClock()) as source:
        rig = Virtual()
        await rig.first()
        try:
            yield source, rig
        finally:
            with suppress(AttributeError):
                rig.unplug()


RIGS: Mapping[str, Callable[[Path], AbstractAsyncContextManager[Opened]]] = {
    "linux": open_linux,
    "sdl": open_sdl,
    "sim": open_sim,
}
