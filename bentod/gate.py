"""When what clients send is looked at: between ticks, a little in each turn of the loop, in fair turns."""

import asyncio
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from bentod.bucket import Bucket

Work = Callable[[], bool]
"""A small piece of work that does not wait; tells whether there is another one like it. May raise."""

SLICE = 0.001
"""s of work in one turn of the loop, plus what that sets going."""

MOST = 16
"""Pieces of work in one turn of the loop."""

SHARE = 0.4
"""Of the loop's time for all clients together; a process that always runs is not woken on time either."""

AT_ONCE = 0.004
"""s of it that may be used without a rest."""


class Gate:
    """Lets pieces of work through, one of each client after the other, unless it is shut.

    A tick shuts it, and so is delayed by one slice at most. After each tick at least one slice gets through,
    even if the next is overdue: a request to stop is heard whatever else happens.
    """

    def __init__(self) -> None:
        self._queue: deque[tuple[asyncio.Future[None], Work]] = deque()
        self._shut = False
        self._wake: asyncio.Handle | None = None
        self._time: Bucket | None = None

    @contextmanager
    def shut(self) -> Iterator[None]:
        """While entered, nothing gets through."""
        self._shut = True
        try:
            yield
        finally:
            self._shut = False
            self._go_on()

    def submit(self, work: Work) -> asyncio.Future[None]:
        """Have `work` done until it tells that no more is left; the result holds what it raises."""
        done: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._queue.append((done, work))
        self._go_on()
        return done

    def _go_on(self) -> None:
        if self._queue and not self._shut and self._wake is None:
            self._wake = asyncio.get_running_loop().call_soon(self._slice)

    def _slice(self) -> None:
        self._wake = None
        if self._shut:
            return
        loop = asyncio.get_running_loop()
        began = loop.time()
        for _ in range(MOST):
            if not self._queue or loop.time() >= began + SLICE:
                break
            self._piece(*self._queue.popleft())
        # What was set going by now gets its turn first, and is paid for, too.
        self._wake = loop.call_soon(self._pay, began)

    def _piece(self, done: asyncio.Future[None], work: Work) -> None:
        if done.cancelled():
            return
        try:
            more = work()
        except Exception as error:  # noqa: BLE001 -- it is the business of whoever waits for it
            done.set_exception(error)
            return
        if more:
            self._queue.append((done, work))
        else:
            done.set_result(None)

    def _pay(self, began: float) -> None:
        self._wake = None
        loop = asyncio.get_running_loop()
        if self._time is None:
            self._time = Bucket(SHARE, AT_ONCE, loop.time)
        rest = self._time.take(loop.time() - began)
        if rest > 0:
            self._wake = loop.call_later(rest, self._slice)
        else:
            self._go_on()
