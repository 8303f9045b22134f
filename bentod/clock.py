"""Real time: the kernel wakes whoever waits for a deadline, closer to it than an event loop's own timers."""

import asyncio
import ctypes
import math
import os
import sys
import time
from types import TracebackType
from typing import Self

DEEP = 0.010
"""A sleep longer than this (s) may put the processor so deeply to sleep that waking it takes a while."""

EARLY = (0.002, 0.0003)
"""So it is woken this early (s) from such a sleep, and dozes on: at 30 Hz the median lateness falls from
250 to 45 µs, for half a percent of a core."""

_CLOCK_MONOTONIC = 1
_TFD_TIMER_ABSTIME = 1


class SystemClock:
    """The clock of the machine. Sleepers may be many at once; each has a kernel timer of its own.

    The selector rounds its time-outs up to a millisecond, so an event loop's timers are never on time;
    a timerfd is an input like any other, to the nanosecond. Without one (`precise` off, or not Linux)
    the loop's own timers serve.
    """

    def __init__(self, *, precise: bool = True) -> None:
        self._idle: list[int] = []
        self._pooling = precise
        self.precise = precise and _timers_work()

    def now(self) -> float:
        """Monotonic seconds, as the event loop counts them."""
        return time.monotonic()

    def wall(self) -> float:
        """Seconds since the epoch."""
        return time.time()

    async def sleep_until(self, deadline: float) -> None:
        """Return once `now()` has reached `deadline` (s); others get a turn even when it has passed."""
        if deadline <= self.now():
            await asyncio.sleep(0)
            return
        timer = self._take()
        try:
            for stop in self._stops(deadline):
                while self.now() < stop:
                    await (_loop_wakes(stop) if timer is None else _kernel_wakes(timer, stop))
        finally:
            self._give(timer)

    def close(self) -> None:
        """Give the timers back; one that is in use goes when its sleeper is done."""
        self._pooling = False
        while self._idle:
            os.close(self._idle.pop())

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _stops(self, deadline: float) -> tuple[float, ...]:
        if self.precise and deadline - self.now() > DEEP:
            return (*(deadline - early for early in EARLY), deadline)
        return (deadline,)

    def _take(self) -> int | None:
        if self._idle:
            return self._idle.pop()
        try:
            return _create_timer() if self.precise else None
        except OSError:  # out of file descriptors: late is better than never
            return None

    def _give(self, timer: int | None) -> None:
        if timer is None:
            return
        if self._pooling:
            self._idle.append(timer)
        else:
            os.close(timer)


async def _kernel_wakes(timer: int, deadline: float) -> None:
    # Setting a timer also forgets an expiry that a cancelled sleeper left unread, so nothing is ever read.
    loop = asyncio.get_running_loop()
    reached = loop.create_future()
    _set_timer(timer, math.ceil(deadline * 1e9))
    loop.add_reader(timer, _resolve, reached)
    try:
        await reached
    finally:
        loop.remove_reader(timer)


async def _loop_wakes(deadline: float) -> None:
    loop = asyncio.get_running_loop()
    reached = loop.create_future()
    handle = loop.call_at(deadline, _resolve, reached)
    try:
        await reached
    finally:
        handle.cancel()


def _resolve(reached: asyncio.Future[None]) -> None:
    if not reached.done():
        reached.set_result(None)


if sys.version_info >= (3, 13) and sys.platform == "linux":

    def _create_timer() -> int:
        return os.timerfd_create(time.CLOCK_MONOTONIC, flags=os.TFD_NONBLOCK | os.TFD_CLOEXEC)

    def _set_timer(timer: int, deadline: int) -> None:
        os.timerfd_settime_ns(timer, flags=os.TFD_TIMER_ABSTIME, initial=deadline)

else:

    class _Timespec(ctypes.Structure):
        _fields_ = (("tv_sec", ctypes.c_long), ("tv_nsec", ctypes.c_long))

    class _Itimerspec(ctypes.Structure):
        _fields_ = (("it_interval", _Timespec), ("it_value", _Timespec))

    _libc = ctypes.CDLL(None, use_errno=True)

    def _create_timer() -> int:
        # glibc defines TFD_NONBLOCK and TFD_CLOEXEC as the O_ flags of the same names.
        return _checked(_libc.timerfd_create(_CLOCK_MONOTONIC, os.O_NONBLOCK | os.O_CLOEXEC))

    def _set_timer(timer: int, deadline: int) -> None:
        value = _Itimerspec(_Timespec(0, 0), _Timespec(*divmod(deadline, 1_000_000_000)))
        _checked(_libc.timerfd_settime(timer, _TFD_TIMER_ABSTIME, ctypes.byref(value), None))

    def _checked(result: int) -> int:
        if result < 0:
            code = ctypes.get_errno()
            raise OSError(code, os.strerror(code))
        return result


def _timers_work() -> bool:
    # On 32-bit Linux a C library may count seconds in more than a long; nobody runs bentod there.
    if sys.platform != "linux" or ctypes.sizeof(ctypes.c_long) != 8:
        return False
    try:
        os.close(_create_timer())
    except (AttributeError, OSError):
        return False
    return True
