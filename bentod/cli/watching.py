"""Between the daemon, a screen and a pair of hands: draws what comes, and asks what keys ask."""

import asyncio
import time
from collections import deque
from collections.abc import Callable, Sequence
from typing import NoReturn

from bentod.cli.keys_verbs import HELP, HOME_LEASE, Ask, Hands
from bentod.cli.screen import Screen
from bentod.cli.view import Aside, screen
from bentod.cli.view_joints import Range
from bentod.cli.view_style import BOLD, DIM, OFF
from bentod.cli.view_values import Table, fields
from bentod.client import Client
from bentod.endpoint import RpcError
from bentod.errors import BentodError
from bentod.frames import Value

RATE_HZ = 10
"""Frames drawn a second: more only flickers."""

_POLL = 2.0
"""s between two questions how the recording goes."""

_STALE = 0.5
"""s without a frame after which nobody sees the arm any more: a homing is then not renewed."""

_FAREWELL = 0.2
"""s for answers to what was asked last."""

_LASTS = 8.0
"""s that a sentence stays."""

_ABOUT = "  Ctrl-C ends.   From another terminal: bentod ctl pause | torque off | go-home | --help"
_KEYS = "  Space STOP  p pause  h home  ← → move  Tab joint  g group  ? all keys  q leave"
_LOOKS = "  Space STOP: you may look, and stop the arm   g group  ? all keys  q leave"


class Watching:
    """What is seen, and what is done about it."""

    def __init__(self, screen: Screen, hands: Hands, page: Callable[[], str] = lambda: "") -> None:
        """`page`: where the daemon's page is, if this user serves one."""
        self.screen = screen
        self.hands = hands
        self._find_page = page
        self._page = ""
        self.drawn = False
        """Whether a frame was ever drawn."""
        self._arm: Client | None = None
        self._events: deque[str] = deque(maxlen=40)
        self._ranges: dict[str, Range] = {}
        self._recording: Table = {}
        self._seen = 0.0  # monotonic s of the newest frame
        self._said = ("", 0.0)  # the newest sentence, and since when (monotonic s)
        self._busy: set[str] = set()  # methods of which at most one is under way
        self._asking: set[asyncio.Task[None]] = set()
        self._quit = asyncio.Event()

    async def follow(self, arm: Client) -> None:
        """Show a daemon until it is gone, or the hands quit. Raises BentodError, in groups: it is gone."""
        hello = fields(await arm.call("hello", name="terminal"))
        self._ranges = _ranges(await arm.call("get_info"))
        self.hands.operator = hello.get("role") == "operator"
        self.hands.said, self._arm = "", arm
        try:
            async with asyncio.TaskGroup() as tasks:
                parts = (self._draw(arm), self._listen(arm), self._ask_of_recording(arm), self._renew())
                running = [tasks.create_task(part) for part in parts]
                await self._quit.wait()
                for task in running:
                    task.cancel()
        finally:
            self._arm = None
            if self._asking:
                await asyncio.wait(self._asking, timeout=_FAREWELL)

    def press(self, keys: Sequence[str]) -> None:
        """Do what keys ask for."""
        for key in keys:
            for ask in self.hands.press(key, time.monotonic()):
                self._ask(ask)
        if self.hands.quits:
            self._quit.set()

    def lost(self, why: str) -> None:
        """There is no daemon; say so."""
        self.hands.lose(why)
        self._recording = {}
        if self.drawn:
            told = f"  {BOLD}NO DAEMON{OFF}   nothing is known of the arm; this waits for another"
            self.screen.draw([told, f"  {why}", "", f"{DIM}  q leaves{OFF}"])

    async def quits_within(self, seconds: float) -> None:
        """Wait that long (s), or until the hands quit."""
        try:
            async with asyncio.timeout(seconds):
                await self._quit.wait()
        except TimeoutError:
            return

    def _ask(self, ask: Ask) -> None:
        """Ask, and wait for nothing. A motion that is not answered yet is not asked again.

        So of arrows that were held up on their way and come all at once, only one moves the arm.
        """
        if self._arm is None:
            self.hands.refused(ask, "there is no daemon")
            return
        if ask.method in ("group_command", "go_home") and ask.method in self._busy:
            return
        self._busy.add(ask.method)
        task = asyncio.create_task(self._carry_out(self._arm, ask))
        self._asking.add(task)
        task.add_done_callback(self._asking.discard)

    async def _carry_out(self, arm: Client, ask: Ask) -> None:
        try:
            answer = await arm.call(ask.method, **ask.params)
        except BentodError as error:
            self.hands.refused(ask, str(error))
        else:
            self.hands.answered(ask, answer)
            if ask.method.startswith("recording"):
                self._recording = fields(answer)
        finally:
            self._busy.discard(ask.method)

    async def _draw(self, arm: Client) -> NoReturn:
        async for frame in arm.subscribe_state(RATE_HZ):
            self._seen = time.monotonic()
            self.hands.see(frame)
            size = self.screen.size()
            group = self.hands.group if self.screen.keys else ""
            aside = Aside(self._recording, group, self._page, self._foot())
            shown = _help(size.lines) if self.hands.help else None
            events = list(self._events)
            self.screen.draw(shown or screen(frame, self._ranges, events, aside, size.columns, size.lines))
            self.drawn = True
        raise AssertionError("a subscription ends with an error only")

    async def _listen(self, arm: Client) -> None:
        async for event in arm.subscribe_events():
            self._events.append(f"{time.strftime('%H:%M:%S')}  {event['text']!s}")

    async def _ask_of_recording(self, arm: Client) -> None:
        while True:
            try:
                self._recording = fields(await arm.call("get_recording"))
            except RpcError:
                self._recording = {}
            self._page = self._find_page()
            self.hands.recording = self._recording.get("recording") is True
            await asyncio.sleep(_POLL)

    async def _renew(self) -> None:
        """Ask again for what is to go on, as long as whoever wants it sees the arm."""
        while True:
            await asyncio.sleep(HOME_LEASE / 5)
            if time.monotonic() - self._seen < _STALE:
                for ask in self.hands.renewals():
                    self._ask(ask)

    def _foot(self) -> list[str]:
        """The last lines: what was said, and which keys there are."""
        if not self.screen.keys:
            return ["", _ABOUT]
        said, now = self.hands.said, time.monotonic()
        if said != self._said[0]:
            self._said = (said, now)
        shown = said if now - self._said[1] < _LASTS else ""
        return [f"  {BOLD}{shown}{OFF}", f"{DIM}{_KEYS if self.hands.operator else _LOOKS}{OFF}"]


def _help(height: int) -> list[str]:
    rows = [f"  {BOLD}{key:<14}{OFF} {what}" for key, what in HELP]
    return ["", *rows][:height]


def _ranges(info: Value) -> dict[str, Range]:
    joints = fields(info).get("joints")
    found: dict[str, Range] = {}
    for joint in joints if isinstance(joints, list) else []:
        match joint:
            case {"name": str(name), "min_rad": float(low), "max_rad": float(high)}:
                found[name] = Range(low, high)
    return found
