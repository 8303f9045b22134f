"""Requests that clients left since the last tick: served at the seam, answered after the write."""

import asyncio
from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar

from bentod.desk import Desk
from bentod.errors import BentodError, Refused
from bentod.frames import Frame

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Answer(Generic[T]):
    """What came of a request: its result, and the frame of the tick that carried it out."""

    result: T
    frame: Frame


class _Pending(Generic[T]):
    """One request on its way through a tick."""

    def __init__(self, request: Callable[[Desk], T]) -> None:
        self.future: asyncio.Future[Answer[T]] = asyncio.get_running_loop().create_future()
        self._request = request
        self._result: list[T] = []

    def serve(self, desk: Desk) -> None:
        """Carry the request out; a refusal is answered at once and stops nothing else."""
        if self.future.cancelled():
            return
        try:
            self._result.append(self._request(desk))
        except BentodError as error:
            self.future.set_exception(error)
        except Exception as error:  # noqa: BLE001 -- one client's request must not break the tick of all
            self.future.set_exception(error)

    def answer(self, frame: Frame) -> None:
        """Answer with what came of it."""
        if self._result and not self.future.done():
            self.future.set_result(Answer(self._result[0], frame))

    def refuse(self, reason: str) -> None:
        """Answer that nothing will come of it."""
        if not self.future.done():
            self.future.set_exception(Refused(reason))


class _Stop:
    """A stop on its way, one for all who have asked for it since the last seam.

    Nothing refuses it: a tick that breaks, and a daemon that ends, stop every joint as well.
    """

    def __init__(self, who: str) -> None:
        self.done = asyncio.Event()
        self._who = who

    def serve(self, desk: Desk) -> None:
        """Stop every joint."""
        desk.stop(self._who)

    def answer(self, frame: Frame) -> None:
        """The servos have been written."""
        self.done.set()

    def refuse(self, reason: str) -> None:
        """Every joint is stopped for another reason."""
        self.done.set()


class Seam:
    """The requests of one tick."""

    def __init__(self, pending: "list[_Pending[object] | _Stop]") -> None:
        self._pending = pending

    def serve(self, desk: Desk) -> None:
        """Carry all of them out, in the order they came; a stop comes last, and so has the last word."""
        for pending in self._pending:
            pending.serve(desk)

    def answer(self, frame: Frame) -> None:
        """Answer those that were not refused, once the servos have been written."""
        for pending in self._pending:
            pending.answer(frame)

    def refuse(self, reason: str) -> None:
        """Answer all that are still open with a refusal."""
        for pending in self._pending:
            pending.refuse(reason)


class Inbox:
    """Where handlers leave requests and the tick finds them."""

    def __init__(self) -> None:
        self._pending: list[_Pending[object]] = []
        self._stop: _Stop | None = None
        self._closed = ""

    async def ask(self, request: Callable[[Desk], T]) -> Answer[T]:
        """Have `request` carried out before the next tick's write and wait for what came of it.

        Raises:
            BentodError: what `request` raised, or Refused because the daemon is ending.
        """
        return await self._leave(request).future

    async def stop(self, who: str) -> None:
        """Have every joint stopped before the next tick's write, and wait for that. Never refused."""
        if self._closed:  # the daemon stops the arm anyway, and for good
            return
        if self._stop is None:
            self._stop = _Stop(who)
        await self._stop.done.wait()

    def post(self, request: Callable[[Desk], T]) -> None:
        """The same without waiting: for what must happen although nobody is left to hear of it."""
        pending = self._leave(request)
        pending.future.add_done_callback(lambda future: future.cancelled() or future.exception())

    def take(self) -> Seam:
        """Everything that was left since the last call."""
        seam = Seam([*self._pending, *([self._stop] if self._stop else [])])
        self._pending, self._stop = [], None
        return seam

    def close(self, reason: str) -> None:
        """Refuse what is open and all that comes."""
        self._closed = reason
        self.take().refuse(reason)

    def _leave(self, request: Callable[[Desk], T]) -> _Pending[T]:
        pending = _Pending(request)
        if self._closed:
            pending.refuse(self._closed)
        else:
            self._pending.append(pending)  # type: ignore[arg-type]  # only its own caller sees the result
        return pending
