"""How the requests of one client are handled: side by side, bounded, errors turned to answers."""

import asyncio
import logging
from collections.abc import Mapping

from bentod.errors import BentodError, Refused
from bentod.messages import BadFraming, Message, Notification, Request, encode_error, encode_result
from bentod.serve.session import Session
from bentod.serve.spec import Method, find

log = logging.getLogger(__name__)


URGENT = ("stop", "pause")
"""Methods that a client may call although it has too many requests in flight."""

RESERVE = 8
"""So many more of them."""


class Internal(BentodError):
    """The daemon has a bug; its log has the traceback."""

    code = "internal"


class Requests:
    """Starts a task for each request of one client, up to a number."""

    def __init__(
        self, methods: Mapping[str, Method], session: Session, group: asyncio.TaskGroup, most: int
    ) -> None:
        self._methods = methods
        self._session = session
        self._group = group
        self._most = most
        self._in_flight = 0
        self._tasks: set[asyncio.Task[None]] = set()

    def take(self, message: Message) -> None:
        """Start on `message`, or answer that there are too many at once."""
        if not isinstance(message, Request | Notification):
            raise BadFraming("The daemon asks nothing of its clients, so it takes no response.")
        if self._in_flight < self._most + RESERVE * (message.method in URGENT):
            self._in_flight += 1
            task = self._group.create_task(self._handle(message))
            self._tasks.add(task)
            task.add_done_callback(self._tasks.discard)
        elif isinstance(message, Request):
            refusal = Refused(f"{self._most} requests are in flight; wait for an answer first.")
            self._session.send(encode_error(message.id, refusal))

    async def finish(self, patience: float) -> None:
        """Return when all requests are done, or cancelled after `patience` (s)."""
        if self._tasks:
            await asyncio.wait(self._tasks, timeout=patience)
        for task in self._tasks:
            task.cancel()

    async def _handle(self, message: Request | Notification) -> None:
        id_ = message.id if isinstance(message, Request) else None
        try:
            result = await find(self._methods, message.method)(self._session, message.params)
            response = encode_result(id_ or 0, result)
        except BentodError as error:
            response = encode_error(id_ or 0, error)
        except Exception:
            log.exception("%s of %s failed.", message.method, self._session.client)
            failure = Internal(f"The daemon failed at {message.method}; its log says why.")
            response = encode_error(id_ or 0, failure)
        finally:
            self._in_flight -= 1
        if id_ is not None:
            self._session.send(response)
