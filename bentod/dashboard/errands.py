"""What the page's server has to ask of the daemon by itself: one thing after the other."""

import asyncio
import logging
from collections.abc import Awaitable, Callable

from bentod.errors import BentodError

_log = logging.getLogger(__name__)

Errand = Callable[[], Awaitable[None]]

WAITING = 256
"""Errands that may wait; no more are taken then."""


class Errands:
    """Whoever may not wait leaves here what is to be done."""

    def __init__(self) -> None:
        self._waiting: asyncio.Queue[Errand] = asyncio.Queue(WAITING)

    def later(self, errand: Errand) -> bool:
        """Have this done when those before it are; False: too many wait, and it will not be done."""
        try:
            self._waiting.put_nowait(errand)
        except asyncio.QueueFull:
            return False
        return True

    async def run(self) -> None:
        """Do what is asked for, for as long as this runs. An errand that the daemon refuses is logged."""
        while True:
            errand = await self._waiting.get()
            try:
                await errand()
            except BentodError as error:
                _log.warning("%s", error)
