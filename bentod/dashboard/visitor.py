"""One browser: who it is, what it asks, what it holds, and how many frames it has taken in."""

import asyncio
from collections.abc import Awaitable, Callable
from dataclasses import dataclass

from bentod.dashboard.actor import Actor, Connect
from bentod.dashboard.arm_link import Knowledge
from bentod.dashboard.audience import Audience, websocket_frame
from bentod.dashboard.holds import LEASES, STALE, Holds
from bentod.dashboard.messages import Call, Hold, Message, Release, Seen, Token, pack
from bentod.dashboard.own import Own, Stage
from bentod.errors import BadRequest, BentodError, Refused, nearest
from bentod.frames import Value

AT_ONCE = 32
"""Calls of one browser that may be open, as for any client of the daemon."""

LATE = 1.0
"""s: what is asked for once counts for so long after the newest frame that whoever asks has seen."""

_NOT_FOR_PAGES = frozenset({"hello", "challenge", "authenticate", "subscribe", "unsubscribe"})
"""What the page's server does for them."""


@dataclass(frozen=True, slots=True)
class House:
    """What every visitor uses."""

    stage: Stage
    audience: Audience
    connect: Connect
    own: dict[str, Own]


class Visitor:
    """A browser that has shown a token. `write`: passes bytes to its socket and never waits."""

    def __init__(
        self,
        house: House,
        role: str,
        name: str,
        write: Callable[[bytes], None],
        tasks: asyncio.TaskGroup,
    ) -> None:
        self.role = role
        self._house = house
        self._write = write
        self._tasks = tasks
        self._actor = Actor(house.connect, name)
        self._holds = Holds(self._act, self._dropped, tasks, asyncio.get_running_loop().time)
        self._stops = 0
        self._farewells: list[Callable[[], Awaitable[None]]] = []
        self._open = 0
        self._sent = self._seen = 0
        self._numbers: list[int] = []  # of frames on their way
        self._skipped = 0

    # What own methods use.

    @property
    def stage(self) -> Stage:
        """What it shares with the others."""
        return self._house.stage

    async def act(self, method: str, params: dict[str, Value]) -> Value:
        """Ask the daemon on the browser's own connection. Raises BentodError: it refuses."""
        return await self._actor.call(method, params)

    def on_leave(self, farewell: Callable[[], Awaitable[None]]) -> None:
        """Have this done when the browser is gone."""
        self._farewells.append(farewell)

    def stats(self) -> Value:
        """What was sent to it, and to how many others."""
        return {"browsers": len(self._house.audience.listeners), "sent": self._sent, "skipped": self._skipped}

    # What the audience uses.

    @property
    def ahead(self) -> int:
        """Frames on their way."""
        return len(self._numbers)

    def send(self, frame: bytes) -> None:
        """Pass on a WebSocket frame. Never waits."""
        self._write(frame)

    def sent(self, number: int) -> None:
        """The frame of that number is on its way."""
        self._sent += 1
        self._numbers.append(number)

    def skipped(self) -> None:
        """Another frame was not sent, because the browser is slow."""
        self._skipped += 1

    # What the browser does.

    def tell(self, *words: object) -> None:
        """Send a message to this browser alone."""
        self._write(websocket_frame(pack(*words)))

    def welcome(self, build: str, knowledge: Knowledge | None) -> None:
        """Tell who the browser is taken for, and what there is."""
        known = knowledge or Knowledge(None, [], "")
        told = {"role": self._granted(known), "build": build, "info": known.info, "methods": known.methods}
        told["own"] = [name for name, own in self._house.own.items() if own.role in (self.role, "observer")]
        self.tell("welcome", told)

    def take(self, message: Message) -> None:
        """Take in what the browser says. Raises BadRequest: it says what it may not."""
        match message:
            case Seen(frame):
                self._saw(frame)
            case Hold(key, method, params, seen):
                self._hold(key, method, params, seen)
            case Release(key):
                self._holds.release(key)
            case Call():
                self._call(message)
            case Token():
                raise BadRequest("The browser has shown its token already.")

    async def leave(self) -> None:
        """The browser is gone, and whatever it held."""
        await self._actor.close()
        for farewell in self._farewells:
            await farewell()

    def _granted(self, known: Knowledge) -> str:
        return "operator" if self.role == known.role == "operator" else "observer"

    def _saw(self, frame: int) -> None:
        self._seen = max(self._seen, frame)
        self._numbers = [number for number in self._numbers if number > frame]

    def _hold(self, key: str, method: str, params: dict[str, Value], seen: int) -> None:
        self._saw(seen)
        late = self._house.audience.age(seen)
        if method not in LEASES:
            raise BadRequest(f"{method} is no motion that can be held.")
        if self.role != "operator":
            self._dropped(key, "You may look, and stop the arm, but not move it.")
        elif late > STALE:
            self._holds.release(key)
            self._dropped(key, f"The page sees the arm too late (allowed are {STALE:g} s): nothing is moved.")
        else:
            self._holds.renew(key, method, params)

    def _dropped(self, key: str, why: str) -> None:
        self.tell("dropped", key, why)

    def _call(self, call: Call) -> None:
        self._stops += call.method == "stop"
        if self._open >= AT_ONCE and not _halts(call.method, call.params):
            self.tell("refused", call.number, f"{AT_ONCE} calls of this page are open already.")
            return
        self._open += 1
        self._tasks.create_task(self._answer(call), name=f"call {call.method}")

    async def _answer(self, call: Call) -> None:
        try:
            self.tell("answer", call.number, await self._asked(call))
        except BentodError as error:
            self.tell("refused", call.number, str(error))
        finally:
            self._open -= 1

    async def _asked(self, call: Call) -> Value:
        if call.method == "stop":
            return await self._stop()
        own = self._house.own.get(call.method)
        if own:
            self._must_be(own.role)
            self._must_see(call, own.role)
            return await own.handler(self, call.params)
        knowledge = self._house.stage.knowledge
        roles = knowledge.roles() if knowledge else {}
        if call.method in _NOT_FOR_PAGES or (knowledge and call.method not in roles):
            raise BadRequest(f"There is no method {call.method}{nearest(call.method, roles)}", "method")
        if call.method in LEASES:
            raise BadRequest(f"{call.method} moves the arm: it must be held.", "method")
        role = roles.get(call.method, "operator")
        self._must_be(role)
        self._must_see(call, role)
        asked = self._house.stage.look if role == "observer" else self._act
        return await asked(call.method, call.params)

    async def _act(self, method: str, params: dict[str, Value]) -> Value:
        """Ask the daemon on the browser's own connection, unless STOP is pressed before there is one."""
        stops = self._stops
        return await self._actor.call(method, params, lambda: _halts(method, params) or stops == self._stops)

    async def _stop(self) -> Value:
        """Stop at once, on the way that is open; and after what is on its way on the browser's own."""
        ways = [self._house.stage.look("stop", {})]
        if self._actor.connected:
            ways.append(self._actor.call("stop", {}))
        answers = await asyncio.gather(*ways, return_exceptions=True)
        if all(isinstance(answer, BaseException) for answer in answers):
            raise next(answer for answer in answers if isinstance(answer, BaseException))
        return None

    def _must_see(self, call: Call, role: str) -> None:
        """What arrives late was meant for then; pauses are as good as ever, and recordings stand still."""
        any_time = role == "observer" or call.method.startswith("replay_") or _halts(call.method, call.params)
        if not any_time and self._house.audience.age(call.seen) > LATE:
            raise Refused(
                f"this was asked for by a page that saw the arm more than {LATE:g} s ago: ask again"
            )

    def _must_be(self, role: str) -> None:
        if role == "operator" and self.role != "operator":
            raise Refused("You may look, and stop the arm, but not change anything.")


def _halts(method: str, params: dict[str, Value]) -> bool:
    """Whether it only ends motion: that counts however much is open, however late, whoever pressed STOP."""
    return method == "stop" or (method == "pause" and params.get("on", True) is True)
