"""Motion from a page: a lease that is renewed while a control is held by somebody who sees the arm."""

import asyncio
from collections.abc import Awaitable, Callable, Mapping
from dataclasses import dataclass

from bentod.errors import BadRequest, BentodError
from bentod.frames import Value

LEASES: Mapping[str, float] = {"move": 0.12, "group_command": 0.12, "go_home": 0.15}
"""s that each renewal is good for, by method. Pages renew 20 times a second: with the tick and a renewal
that was just sent, a joint is told to stop within 200 ms of the last one."""

STALE = 0.25
"""s: who has seen no newer frame than this old moves nothing, be it that requests still arrive."""

MOST = 32
"""Controls of one page that may be held at once."""

_LATE = 0.1
"""s that a renewal may wait for the answer to the one before; what is older was meant for then."""

Ask = Callable[[str, dict[str, Value]], Awaitable[Value]]
"""Asks the daemon: a method and its parameters."""


@dataclass(frozen=True, slots=True)
class _Wish:
    method: str
    params: dict[str, Value]
    at: float  # monotonic s
    last: bool = False  # lets go: good at any time


class Holds:
    """The controls that one page holds. At most one request a control is under way; the newest waits."""

    def __init__(
        self,
        ask: Ask,
        refused: Callable[[str, str], None],
        tasks: asyncio.TaskGroup,
        now: Callable[[], float],
    ) -> None:
        """`refused`: told a control's key and why; `now`: monotonic s."""
        self._ask = ask
        self._refused = refused
        self._tasks = tasks
        self._now = now
        self._held: dict[str, _Wish] = {}
        self._waiting: dict[str, _Wish] = {}
        self._busy: set[str] = set()
        self._goals: dict[str, Value] = {}  # by control, the goal that it began

    def renew(self, key: str, method: str, params: Mapping[str, Value]) -> None:
        """The control `key` is held: ask for `method`, one of `LEASES`, for as long as its lease.

        Raises:
            BadRequest: more controls are held than a person has.
        """
        if key not in self._held and len(self._held) >= MOST:
            raise BadRequest(f"More than {MOST} controls are held at once.")
        wish = _Wish(method, {**params, "lease_s": LEASES[method]}, self._now())
        self._held[key] = wish
        self._post(key, wish)

    def release(self, key: str) -> None:
        """The control is let go, or its page does not see the arm any more: what it moved stops."""
        held = self._held.pop(key, None)
        self._goals.pop(key, None)
        if held:
            self._post(key, _ending(held, self._now()))

    def _post(self, key: str, wish: _Wish) -> None:
        self._waiting[key] = wish
        if key not in self._busy:
            self._busy.add(key)
            self._tasks.create_task(self._send(key), name=f"hold {key}")

    async def _send(self, key: str) -> None:
        try:
            while wish := self._waiting.pop(key, None):
                if wish.last or self._now() - wish.at <= _LATE:
                    await self._one(key, wish)
        finally:
            self._busy.discard(key)

    async def _one(self, key: str, wish: _Wish) -> None:
        goal = {"goal": self._goals[key]} if key in self._goals else {}  # renewed, and never begun anew
        try:
            answer = await self._ask(wish.method, {**wish.params, **goal})
        except BentodError as error:
            if not wish.last:  # nothing was moving that could be let go
                self._held.pop(key, None)
                self._goals.pop(key, None)
                self._refused(key, str(error))
        else:
            if isinstance(answer, dict) and "goal" in answer and key in self._held:
                self._goals[key] = answer["goal"]


def _ending(held: _Wish, now: float) -> _Wish:
    """What ends a wish at once, without waiting for its lease."""
    if held.method == "go_home":
        return _Wish("go_home_cancel", {}, now, last=True)
    still = "effort" if held.method == "group_command" else "velocity"
    kept = {key: value for key, value in held.params.items() if key in ("joint", "group")}
    return _Wish(held.method, {**kept, still: 0.0, "lease_s": 0.05}, now, last=True)
