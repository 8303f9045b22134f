"""A joystick or gamepad through SDL, by way of pygame-ce, in a thread of its own: SDL's calls may block."""

import asyncio
import importlib
import logging
import os
import threading
import time
from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager
from dataclasses import replace
from types import ModuleType

from bentod.contracts import Clock, Pad
from bentod.errors import ConfigError
from bentod.frames import Value
from drivers.joystick.options import SdlOptions, parse
from drivers.joystick.sdl_device import Device, attached

_log = logging.getLogger(__name__)

POLL_S = 0.005
"""s between two looks of the thread."""

RETRY_S = 1.0
"""s between two attempts to find the pad, besides those when SDL says that one has come."""

CLOSE_S = 1.0
"""s that the end waits for the thread."""

SETTINGS = {
    "SDL_VIDEODRIVER": "dummy",  # events need SDL's video part, but no screen
    "SDL_AUDIODRIVER": "dummy",
    "SDL_JOYSTICK_ALLOW_BACKGROUND_EVENTS": "1",  # there is no window that could be in front
    "SDL_NO_SIGNAL_HANDLERS": "1",  # signals that end the daemon are its own
    "PYGAME_HIDE_SUPPORT_PROMPT": "1",
}


class SdlPad:
    """The pad as the thread saw it last. A thread that hangs shows: `seen` is when it last looked."""

    def __init__(self, pygame: ModuleType, wanted: int | str, clock: Clock) -> None:
        self._pygame = pygame
        self._wanted = wanted
        self._clock = clock
        self._ending = threading.Event()
        self._newest = Pad(reason="SDL has not looked for the joystick yet.")
        self._thread = threading.Thread(target=self._run, name="joystick", daemon=True)

    def latest(self) -> Pad:
        """What the thread saw last, by the daemon's clock."""
        newest = self._newest  # replaced as a whole by the thread
        shift = self._clock.now() - time.monotonic()
        return replace(newest, seen=newest.seen + shift, changed=newest.changed + shift)

    def start(self) -> None:
        """Let the thread begin."""
        self._thread.start()

    async def close(self) -> None:
        """Let it end, and wait a moment for that."""
        self._ending.set()
        await asyncio.to_thread(self._thread.join, CLOSE_S)

    def _run(self) -> None:
        pygame = self._pygame
        try:
            pygame.display.init()
            pygame.joystick.init()
            self._watch()
        except Exception as error:  # noqa: BLE001 -- without it the pad is gone, and that is told
            _log.exception("SDL broke")
            reason = f"SDL broke: {type(error).__name__}: {error}."
            self._newest = Pad(reason=reason, openings=self._newest.openings)
        finally:
            pygame.quit()

    def _watch(self) -> None:
        device: Device | None = None
        tried = -RETRY_S
        while not self._ending.wait(POLL_S):
            now = time.monotonic()
            events = self._pygame.event.get()
            if device is None and (now - tried >= RETRY_S or events):
                device, tried = self._find(now), now
            elif device is not None and device.take(events, now):
                self._newest = replace(device.pad, seen=now)
            elif device is not None:
                reason = f"The joystick '{device.name}' was unplugged."
                self._newest = Pad(reason=reason, openings=device.pad.openings)
                device = None

    def _find(self, now: float) -> Device | None:
        openings = self._newest.openings
        device, reason = attached(self._pygame, self._wanted, openings + 1, now)
        self._newest = replace(device.pad, seen=now) if device else Pad(reason=reason, openings=openings)
        return device


def _load() -> ModuleType:
    for name, value in SETTINGS.items():
        os.environ.setdefault(name, value)
    try:
        return importlib.import_module("pygame")
    except ImportError as error:
        raise ConfigError(
            f"The joystick source 'sdl' needs pygame-ce: pip install 'bentod[joy]' brings it ({error})."
        ) from error


@asynccontextmanager
async def open_joystick(options: Mapping[str, Value], clock: Clock) -> AsyncIterator[SdlPad]:
    """The pad of the options, whenever it is there.

    Raises:
        ConfigError: an option is unknown or out of bounds, or pygame-ce is not installed.
    """
    wanted = parse(SdlOptions, options).pad
    pad = SdlPad(_load(), wanted, clock)
    pad.start()
    try:
        yield pad
    finally:
        await pad.close()
