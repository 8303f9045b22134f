"""How the requests of one client are handled: side by side, bounded, errors turned to answers."""

import asyncio
import logging
from collections.abc import Mapping

from bentod.bucket import Bucket
from bentod.errors import BentodError, Refused
from bentod.framing import BadFraming
from bentod.messages import Message, Notification, Request, encode_error, encode_result
from bentod.serve.accounts import Shared
from bentod.serve.peers import Role
from bentod.serve.session import Bounds, Session
from bentod.serve.spec import Method, find

log = logging.getLogger(__name__)


RESERVE = 8
"""Requests to pause that may be in flight besides; those to stop always may."""

FLOOD = 10
"""Times the rate of requests at which a client is read at most: beyond, its messages wait in the kernel."""

DEEPEST = 0.25
"""s that a user's other requests wait at most because of those to stop and to pause."""

VOID = "The arm was stopped, paused or released while this waited for its turn: too many came before it."


class Internal(BentodError):
    """The daemon has a bug; its log has the traceback."""

    code = "internal"


class Requests:
    """Starts a task for each request of one client, up to a number, and no more often than it may."""

    def __init__(
        self,
        methods: Mapping[str, Method],
        session: Session,
        group: asyncio.TaskGroup,
        bounds: Bounds,
        shared: Shared,
    ) -> None:
        now = asyncio.get_running_loop().time
        self._methods = methods
        self._session = session
        self._group = group
        self._most = bounds.in_flight
        self._shared = shared
        self._turns = shared.account(session.peer.user).turns
        self._flood = Bucket(FLOOD * bounds.requests_per_s, FLOOD * bounds.requests_per_s, now)
        self._weight = 1.0
        self._in_flight = 0
        self._tasks: set[asyncio.Task[None]] = set()
        self.stopped = False
        """Whether the client has asked to stop."""

    def weigh(self, weight: float) -> None:
        """The next message to `take` costs as much as so many small requests."""
        self._weight = weight
        self._flood.take(weight)

    def take(self, message: Message) -> None:
        """Start on `message`, or answer why not. What is refused is never carried out later."""
        if not isinstance(message, Request | Notification):
            raise BadFraming("The daemon asks nothing of its clients, so it takes no response.")
        stops = message.method == "stop"
        urgent = stops or _pauses(message)
        reason = "" if stops else self._why_not(urgent)
        if reason:
            self._refuse(message, Refused(reason))
            return
        self.stopped |= stops
        delay = self._charge(urgent)
        self._note_halt(message.method)
        self._in_flight += 1
        # One that comes too soon waits in flight, where it holds up neither the tick nor a stop.
        task = self._group.create_task(self._handle(message, delay, self._shared.halts))
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    def breather(self) -> float:
        """How long (s) to read nothing from this client, because it sends far too much."""
        return self._flood.debt()

    async def finish(self, patience: float) -> None:
        """Return when all requests are done, or cancelled after `patience` (s)."""
        if self._tasks:
            await asyncio.wait(self._tasks, timeout=patience)
        for task in self._tasks:
            task.cancel()

    def _why_not(self, urgent: bool) -> str:
        """Why the request is refused at once; empty if it is not."""
        if self._session.last_resort:
            return f"{self._session.last_resort} This connection may only stop the arm."
        if self._session.is_full and not urgent:
            return "Read your answers first: too many wait for you. Only stop and pause are carried out."
        if self._in_flight >= self._most + RESERVE * urgent:
            return f"{self._most} requests are in flight; wait for an answer first."
        return ""

    def _charge(self, urgent: bool) -> float:
        """What the request takes of its user's turns; how long (s) it has to wait for them, if it waits."""
        if urgent:
            self._turns.take(0.0 if self._turns.debt() > DEEPEST else self._weight)
            return 0.0
        return self._turns.take(self._weight)

    def _refuse(self, message: Request | Notification, error: Refused) -> None:
        if isinstance(message, Request) and not self._session.is_overfull:
            self._session.send(encode_error(message.id, error))

    def _note_halt(self, name: str) -> None:
        if name == "stop" or (name == "pause" and self._session.peer.role is Role.OPERATOR):
            self._shared.halts += 1

    async def _handle(self, message: Request | Notification, delay: float, halts: int) -> None:
        id_ = message.id if isinstance(message, Request) else None
        try:
            result = await self._result(message, delay, halts)
            response = encode_result(id_ or 0, result)
        except BentodError as error:
            response = encode_error(id_ or 0, error)
        except Exception:
            if (more := self._shared.hush.take("failed", message.method)) is not None:
                log.exception("%s of %s failed%s.", message.method, self._session.client, more)
            failure = Internal(f"The daemon failed at {message.method}; its log says why.")
            response = encode_error(id_ or 0, failure)
        finally:
            self._in_flight -= 1
        if id_ is not None:
            self._session.send(response)

    async def _result(self, message: Request | Notification, delay: float, halts: int) -> object:
        if delay > 0:
            await asyncio.sleep(delay)
        method = find(self._methods, message.method)
        self._check_role(method)
        if delay > 0 and method.role is Role.OPERATOR and halts != self._shared.halts:
            raise Refused(VOID)
        return await method(self._session, message.params)

    def _check_role(self, method: Method) -> None:
        """Raises Refused: the client may not call it."""
        peer = self._session.peer
        if peer.role.may(method.role):
            return
        if (more := self._shared.hush.take("refused", peer.user)) is not None:
            log.warning("Refused %s to %s%s.", method.name, self._session, more)
        raise Refused(f"{method.name} needs the role {method.role}. {peer.remedy}")


def _pauses(message: Request | Notification) -> bool:
    """Whether it is a pause; to release is not urgent."""
    match message.params:
        case [_, False] | {"on": False} | [{"on": False}]:
            return False
    return message.method == "pause"
