"""Who holds the loop while a tick is overdue: a timer goes off then, and finds the code at work."""

import asyncio
import gc
import signal
import time
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from types import FrameType, TracebackType
from typing import Self

IDLE = ""
"""The place of a loop in which nothing runs: it waits, or the machine does not let it run."""

GARBAGE = "a garbage collection"

AGAIN = 0.5
"""Share of the time since the deadline after which the next alarm follows. Each alarm takes a byte of the
pipe through which the loop hears of all signals, and the loop empties it only when nothing holds it. It has
room for some 270; alarms that came at a steady rate would fill it, and a SIGTERM after that would be lost. So
there are at most 30 in the first minute, and 50 in a day."""

_RUN = asyncio.Handle._run.__code__
_OURS = frozenset({"bentod", "drivers", "sim"})
_ROOT = Path(__file__).parents[1]


class Lookout:
    """Sees nothing. What a tick needs of one."""

    def watch(self, due: float, now: float, after: float) -> None:
        """From `after` (s) past `due` on, see who holds the loop. Both times are monotonic s."""

    def seen(self) -> Mapping[str, float]:
        """Which places held the loop since `due`, and for how long (s); empty if it was on time. Ask once."""
        return {}


class AlarmLookout(Lookout):
    """Interrupts whatever runs while a tick is overdue, and notes its place in the code.

    A signal reaches even a loop that is stuck, in Python or in most waits of the system. As long as ticks
    are on time the alarm is put off again and again, and costs one system call a tick. It needs SIGALRM and
    the main thread; both are as they were after the exit. Other signals and system calls are not disturbed:
    Python repeats a call that was interrupted, the loop ignores a signal that nobody gave it, and each alarm
    lets more time pass before the next (`AGAIN`).
    """

    def __init__(self) -> None:
        self._held: dict[str, float] = {}
        self._due = self._since = 0.0
        self._after = 0.0  # s; 0: no more alarms

    def watch(self, due: float, now: float, after: float) -> None:
        """Put the alarm off until `after` past `due`; from then on it goes off again, ever more rarely."""
        self._held, self._due, self._since, self._after = {}, due, due, after
        signal.setitimer(signal.ITIMER_REAL, max(due + after - now, 1e-6))

    def seen(self) -> Mapping[str, float]:
        """Places as "file:line function", `IDLE` or `GARBAGE`."""
        held, self._held = self._held, {}  # the next alarm may come at any moment, and would change it
        return held

    def __enter__(self) -> Self:
        """Raises ValueError: this is not the main thread."""
        self._handler = signal.signal(signal.SIGALRM, self._overdue)
        self._timer = signal.setitimer(signal.ITIMER_REAL, 0)
        gc.callbacks.append(_garbage_collected)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        gc.callbacks.remove(_garbage_collected)
        self._after = 0.0  # first: an alarm that is on its way must not set the timer again
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, self._handler)
        signal.setitimer(signal.ITIMER_REAL, *self._timer)

    def _overdue(self, number: int, frame: FrameType | None) -> None:
        now = time.monotonic()
        if not self._after or now < self._due:  # it was on its way when the tick ended
            return
        with suppress(Exception):  # the code that was interrupted, perhaps close to a limit, is not to suffer
            self._note(place(frame), now)
        # Last: so no alarm interrupts another one, but on a machine that stands still.
        signal.setitimer(signal.ITIMER_REAL, max(self._after, AGAIN * (now - self._due)))

    def _note(self, held: str, now: float) -> None:
        self._held[held] = self._held.get(held, 0.0) + now - self._since
        self._since = now


def place(frame: FrameType | None) -> str:
    """Who runs in an interrupted loop: the innermost code of ours, else the callback that the loop called."""
    inside: list[FrameType] = []
    while frame is not None and frame.f_code is not _RUN:
        inside.append(frame)
        frame = frame.f_back
    if any(found.f_code is _garbage_collected.__code__ for found in inside[:1]):
        return GARBAGE
    if frame is None:
        return IDLE
    found = next(filter(_is_ours, inside), (inside or [frame])[-1])
    return f"{_short(found.f_code.co_filename)}:{found.f_lineno} {found.f_code.co_qualname}()"


def _is_ours(frame: FrameType) -> bool:
    module = str(frame.f_globals.get("__name__", ""))
    if module == __name__ or frame.f_code.co_filename.startswith("<"):  # an alarm in an alarm; a dataclass
        return False
    return module.partition(".")[0] in _OURS


def _short(file: str) -> str:
    path = Path(file)
    return str(path.relative_to(_ROOT)) if path.is_relative_to(_ROOT) else "/".join(path.parts[-2:])


def _garbage_collected(phase: str, info: Mapping[str, int]) -> None:
    """Where an alarm lands that goes off during a collection: Python code runs again only here."""
