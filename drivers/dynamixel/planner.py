"""One round of reading on a bus of mixed servos: as few questions as their protocols and models allow.

| servos | a round asks them by |
|---|---|
| MX with firmware 1 | one bulk read of protocol 1.0 |
| AX | one read each |
| MX with firmware 2 | one sync read of protocol 2.0 |

Those that do not all answer the common question when it is first tried are read one by one for good: an
MX-28AT beside an MX-106 failed each of 10 sync reads (ROBOTIS-GIT/dynamixel_hardware_interface#50).
"""

import logging
from collections.abc import Mapping, Sequence

from bentod.contracts import Clock
from drivers.dynamixel.bus import Bus, Reply
from drivers.dynamixel.codec import Version
from drivers.dynamixel.rounds import Roll
from drivers.dynamixel.servo import Servo
from drivers.dynamixel.tables import Layout, Window

log = logging.getLogger(__name__)


class Group:
    """Servos that are read alike.

    Protocols 1.0 and 2.0 have nothing that ties a reply to its question, so a reply that is late could be
    taken for one to the next round. But it has the length of the window that its question asked for. So
    whenever a question was not answered in full, the next one asks for a window of another length.
    """

    def __init__(self, servos: Sequence[Servo], now: float) -> None:
        """`now`: monotonic s."""
        self.servos = tuple(servos)
        self.layout: Layout = servos[0].model.layout
        self.ids = [servo.id for servo in servos]
        self.roll = Roll(self.ids, now, servos[0].model.grouped)
        self._turn = 0

    @property
    def window(self) -> Window:
        """What the next question asks for."""
        return self.layout.windows[self._turn % len(self.layout.windows)]

    def turn(self) -> None:
        """A reply may still be under way."""
        self._turn += 1

    def usual(self, window: Window, reply: Reply) -> Reply:
        """`reply` to a question for `window`, as if to one for the usual window."""
        first = self.layout.windows[0]
        if window is first:
            return reply
        start = first.address - window.address
        return Reply(reply.error, reply.data[start : start + first.size], reply.time)


class Planner:
    """Reads the windows of all servos."""

    def __init__(self, bus: Bus, servos: Sequence[Servo], clock: Clock) -> None:
        self._bus = bus
        self._clock = clock
        self._groups = tuple(Group(servos, clock.now()) for servos in _alike(servos))
        self._whole = True

    async def probe(self, attempts: int) -> None:
        """Find out which groups answer their common question; each has passed its audit just now."""
        for group in self._groups:
            if group.roll.chained and len(group.servos) > 1 and not await self._answers(group, attempts):
                group.roll = Roll(group.ids, self._clock.now(), chained=False)
                log.warning(
                    "%s do not all answer when they are asked together; they are read one by one, "
                    "which takes longer.",
                    ", ".join(map(str, group.servos)),
                )

    def restart(self) -> None:
        """Forget who was silent: all were heard just now."""
        for group in self._groups:
            group.roll = Roll(group.ids, self._clock.now(), group.roll.chained)

    async def read(self, deadline: float) -> Mapping[int, Reply]:
        """The usual windows by servo id, of those that answered.

        As long as everybody answers, everybody is asked before `deadline` (monotonic s). Once somebody did
        not, only what is over by then even if nobody answers; who is left out is asked first next time.
        """
        heard: dict[int, Reply] = {}
        self._whole = first = True
        for group in self._groups:
            group.roll.begin(self._clock.now())
        for whom in (Roll.chain, Roll.straggler):
            for group in self._groups:
                while (chain := whom(group.roll)) and (first or self.in_time(group.layout, chain, deadline)):
                    heard.update(await self._ask(group, chain))
                    first = False
        return heard

    def in_time(self, layout: Layout, ids: Sequence[int], deadline: float) -> bool:
        """Whether servos of this `layout` can still be asked before `deadline` (monotonic s)."""
        now = self._clock.now()
        if self._bus.problem or now >= deadline:
            return False
        longest = self._bus.longest_read(layout.protocol, ids, layout.windows[-1].size)
        return self._whole or now + longest <= deadline

    async def _ask(self, group: Group, chain: Sequence[int]) -> dict[int, Reply]:
        window = group.window
        replies = await self._bus.read(group.layout.protocol, chain, window.address, window.size)
        group.roll.note(chain, replies, self._clock.now())
        if len(replies) < len(chain):
            group.turn()
            self._whole = False
        return {id_: group.usual(window, reply) for id_, reply in replies.items()}

    async def _answers(self, group: Group, attempts: int) -> bool:
        for _ in range(attempts):
            if len(await self._ask(group, group.ids)) == len(group.ids):
                return True
            await self._bus.settle()
        return False


def _alike(servos: Sequence[Servo]) -> list[list[Servo]]:
    groups: dict[tuple[Version, bool], list[Servo]] = {}
    for servo in servos:
        groups.setdefault((servo.model.layout.protocol, servo.model.grouped), []).append(servo)
    return list(groups.values())
