"""What all browsers share: the daemon behind them, what goes with every frame, and who is there."""

import asyncio
from collections.abc import Awaitable, Callable

from bentod.dashboard.actor import Connect
from bentod.dashboard.arm_link import ArmLink, Knowledge, joined
from bentod.dashboard.audience import Audience
from bentod.dashboard.errands import Errands
from bentod.dashboard.messages import pack
from bentod.dashboard.own_methods import OWN
from bentod.dashboard.visitor import House, Visitor
from bentod.frames import Value

BEAT = 1.0
"""s between two signs of life to every page."""

_ALIVE = pack("alive")


class Site:
    """One daemon as the page shows it."""

    def __init__(self, connect: Connect, build: str) -> None:
        """`build`: a word that changes with the page."""
        self.told: dict[str, Value] = {}
        self.watchers: list[Callable[[dict[str, Value]], None]] = []
        self.hearers: list[Callable[[dict[str, Value]], None]] = []
        self.knowledge: Knowledge | None = None
        self.kept: dict[str, object] = {}
        self._build = build
        self._audience = Audience(asyncio.get_running_loop().time)
        self._link = ArmLink(connect, self)
        self._errands = Errands()
        self._house = House(self, self._audience, connect, OWN)
        self._why = "The daemon has not been reached yet."
        self._visits = 0

    async def run(self) -> None:
        """Stay connected to the daemon for as long as this runs."""
        async with asyncio.TaskGroup() as tasks:
            tasks.create_task(self._link.run())
            tasks.create_task(self._errands.run())
            tasks.create_task(self._beat())

    async def _beat(self) -> None:
        """Pages know that the server lives, be there a daemon or not."""
        while True:
            await asyncio.sleep(BEAT)
            self._audience.tell(_ALIVE)

    async def look(self, method: str, params: dict[str, Value]) -> Value:
        """Ask the daemon on the connection that all share: methods that an observer may call."""
        return await self._link.call(method, params)

    def later(self, errand: Callable[[], Awaitable[None]]) -> bool:
        """Have this done soon, each after the one before, by whoever must not wait; False: too many wait."""
        return self._errands.later(errand)

    def visitor(self, role: str, write: Callable[[bytes], None], tasks: asyncio.TaskGroup) -> Visitor:
        """A browser that has shown the token of a role. `write`: passes bytes to its socket."""
        self._visits += 1
        return Visitor(self._house, role, f"page {self._visits}", write, tasks)

    def enter(self, visitor: Visitor) -> None:
        """From now on the browser gets frames."""
        visitor.welcome(self._build, self.knowledge)
        if self.knowledge is None:
            visitor.tell("link", False, self._why)
        self._audience.listeners.add(visitor)

    def leave(self, visitor: Visitor) -> None:
        """The browser gets no more."""
        self._audience.listeners.discard(visitor)

    # What the daemon says.

    def arrived(self, knowledge: Knowledge) -> None:
        """The daemon is there, for the first time or again."""
        self.knowledge = knowledge
        for visitor in self._visitors():
            visitor.welcome(self._build, knowledge)

    def frame(self, frame: dict[str, Value], emg: list[Value]) -> None:
        """Show a frame to all."""
        for watcher in self.watchers:
            watcher(frame)
        number = self._audience.next_number()
        if self._audience.listeners:
            self._audience.show(number, pack("frame", number, frame, joined(emg), self.told))

    def event(self, event: dict[str, Value]) -> None:
        """Tell all what happened."""
        for hearer in self.hearers:
            hearer(event)
        self._audience.tell(pack("event", event))

    def left(self, why: str) -> None:
        """The daemon is gone."""
        self.knowledge, self._why = None, why
        self._audience.tell(pack("link", False, why))

    def _visitors(self) -> list[Visitor]:
        return [listener for listener in self._audience.listeners if isinstance(listener, Visitor)]
