"""What a method of the page's own server is, and what it may use."""

from collections.abc import Awaitable, Callable, Mapping
from dataclasses import dataclass
from typing import Protocol, TypeAlias

from bentod.dashboard.arm_link import Knowledge
from bentod.frames import Value


class Stage(Protocol):
    """What all browsers share."""

    told: dict[str, Value]
    """Goes with every frame to all browsers, e.g. the state of a task; keys are the owners' names."""

    watchers: list[Callable[[dict[str, Value]], None]]
    """Called with every frame that arrives, before it is shown. They never wait, and never raise."""

    hearers: list[Callable[[dict[str, Value]], None]]
    """Called with every event, in the same way."""

    knowledge: Knowledge | None
    """What is known of the daemon; None while it is not there."""

    kept: dict[str, object]
    """What own methods keep between calls, by the name of the module that keeps it."""

    async def look(self, method: str, params: dict[str, Value]) -> Value:
        """Ask the daemon on the connection that all share: methods that an observer may call."""
        ...

    def later(self, errand: Callable[[], Awaitable[None]]) -> bool:
        """Have this done soon, each after the one before, by whoever must not wait; False: too many wait."""
        ...


class Visit(Protocol):
    """The browser that asks."""

    role: str
    """"operator" or "observer"."""

    @property
    def stage(self) -> Stage:
        """What it shares with the others."""
        ...

    async def act(self, method: str, params: dict[str, Value]) -> Value:
        """Ask the daemon on the browser's own connection. Raises BentodError: it refuses."""
        ...

    def on_leave(self, farewell: Callable[[], Awaitable[None]]) -> None:
        """Have this done when the browser is gone."""
        ...

    def stats(self) -> Value:
        """What was sent to it."""
        ...


Handler: TypeAlias = Callable[[Visit, dict[str, Value]], Awaitable[Value]]
"""Answers a call; raises BentodError to refuse it."""


@dataclass(frozen=True, slots=True)
class Own:
    """One method of the server's own."""

    handler: Handler
    role: str  # that the browser needs


def own(observer: Mapping[str, Handler], operator: Mapping[str, Handler]) -> dict[str, Own]:
    """Methods by name: for all who look, and for those who may move the arm."""
    looking = {name: Own(handler, "observer") for name, handler in observer.items()}
    return looking | {name: Own(handler, "operator") for name, handler in operator.items()}
