"""Where a tick's time goes, whether some is left for learning, and what is said when ticks are missed."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, TypeAlias

from bentod.contracts import Clock
from bentod.culprit import GARBAGE, IDLE, Lookout
from bentod.frames import Costs, Value

Phase: TypeAlias = Literal["read", "think", "write", "publish"]

OVERDUE = 0.75
"""Share of the period after which a tick that is not done is looked into."""

QUIET = 10.0
"""s from one sentence about missed ticks to the next."""


@dataclass(frozen=True, slots=True)
class Late:
    """Ticks that were missed, and why."""

    missed: int
    text: str
    data: Mapping[str, Value]


class Pace:
    """The stopwatch of one tick after another. `budget`: s of a tick after which it learns no more."""

    def __init__(self, clock: Clock, period: float, budget: float, lookout: Lookout) -> None:
        self._clock = clock
        self._period = period
        self._budget = budget
        self._lookout = lookout
        self._complaints = Complaints()
        self._due = self._since = 0.0
        self._phase: Phase = "publish"
        self._spent: dict[Phase, float] = {"read": 0.0, "think": 0.0, "write": 0.0, "publish": 0.0}
        self._published = 0.0
        self.lateness = 0.0
        """s from the deadline of the tick under way to its start."""

    def begin(self, due: float) -> None:
        """A tick begins, due at `due` (monotonic s); it thinks until it enters another phase."""
        self._due, self._since, self._phase = due, self._clock.now(), "think"
        self.lateness = self._since - due
        self._spent = dict.fromkeys(self._spent, 0.0)

    def enter(self, phase: Phase) -> None:
        """The phase under way ends, another begins, or goes on."""
        now = self._clock.now()
        self._spent[self._phase] += now - self._since
        self._since, self._phase = now, phase

    def has_time(self) -> bool:
        """Whether the tick under way, its lateness included, is still within the budget."""
        return self._clock.now() < self._due + self._budget

    @property
    def costs(self) -> Costs:
        """Of the phases of this tick that are over, and of the last tick's publishing."""
        return Costs(self._spent["read"], self._spent["think"], self._spent["write"], self._published)

    def end(self, following: float, missed: int) -> Late | None:
        """A tick is over, the next is due at `following`, those between are `missed`; what is to be said."""
        self.enter("publish")
        self._published = self._spent["publish"]
        if missed:
            self._complaints.add(self._late(missed))
        self._lookout.watch(following, self._since, OVERDUE * self._period)
        return self._complaints.due(self._since)

    def _late(self, missed: int) -> Late:
        longest = max(self._spent, key=lambda phase: self._spent[phase])
        began_late = self.lateness > self._spent[longest]
        what = "began late, by" if began_late else f"took long to {longest},"
        took = self.lateness if began_late else self._spent[longest]
        held = self._lookout.seen()
        culprit = max(held, key=lambda place: held[place]) if held else None
        text = f"a tick {what} {took * 1e3:.1f} ms{_blame(held, culprit)}"
        spent: dict[str, Value] = dict(self._spent.items())
        return Late(missed, text, {"lateness": self.lateness, "costs": spent, "culprit": culprit or ""})


class Complaints:
    """Tells at once that ticks were missed, then for a while nothing, then how many more there were."""

    def __init__(self) -> None:
        self._worst: Late | None = None
        self._missed = 0
        self._quiet_until = float("-inf")

    def add(self, late: Late) -> None:
        """Ticks were missed."""
        self._missed += late.missed
        if self._worst is None or late.missed > self._worst.missed:
            self._worst = late

    def due(self, now: float) -> Late | None:
        """What is to be said at `now` (monotonic s), if anything is."""
        if self._worst is None or now < self._quiet_until:
            return None
        missed, worst = self._missed, self._worst
        self._quiet_until = now + QUIET
        self._worst, self._missed = None, 0
        ticks = "1 tick was" if missed == 1 else f"{missed} ticks were"
        most = "" if missed == worst.missed else f", at most {worst.missed} in a row"
        return Late(missed, f"{ticks} missed{most}: {worst.text}", {"missed": missed, **worst.data})


def _blame(held: Mapping[str, float], culprit: str | None) -> str:
    """The end of a sentence: who held the loop (s, by place)."""
    if culprit is None:
        return ""
    if culprit == IDLE:
        return "; nothing held the loop: it waited, or the machine did not let it run"
    who = "garbage was being collected" if culprit == GARBAGE else f"{culprit} held the loop"
    return f"; {who} for about {held[culprit] * 1e3:.0f} ms"
