"""A recording behind a socket of its own: the API of the arm that it is of, and the keys of a player."""

import logging
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Annotated, TypeVar

from bentod.config import Config
from bentod.contracts import Clock
from bentod.desk import Desk
from bentod.errors import BentodError, ConfigError, Refused
from bentod.frames import EmgBlock, Event, Frame, Value
from bentod.furnish import about, furnished, mind_of
from bentod.inbox import Answer, Inbox
from bentod.mind import Mind
from bentod.replay.player import FASTEST, Player, Source, Span
from bentod.serve.methods import arm_methods, lister
from bentod.serve.params import Flag, Number
from bentod.serve.peers import Role
from bentod.serve.room import Room
from bentod.serve.server import Server
from bentod.serve.session import Session
from bentod.serve.spec import Handler, Method, table

T = TypeVar("T")

_log = logging.getLogger(__name__)


class _Quiet(Inbox):
    """Answers from the recording at once. There is no arm that anything could be left for."""

    def __init__(self, desk: Desk) -> None:
        super().__init__()
        self._desk = desk
        self.newest: Frame | None = None

    async def ask(self, request: Callable[[Desk], T]) -> Answer[T]:
        if self.newest is None:
            raise Refused("nothing has been played yet")
        for group in self.newest.groups:
            self._desk.groups.activate(group.name, group.active).together = group.together
        return Answer(request(self._desk), self.newest)

    def post(self, request: Callable[[Desk], T]) -> None:
        """What nobody waits for is of no use here."""


class Stage:
    """Plays a recording to clients who cannot tell it from the arm, but that nothing they ask moves it."""

    def __init__(self, tape: Source, span: Span, config: Config, clock: Clock, socket: Path) -> None:
        """`config`: the recording's own."""
        joints = len(config.joints)
        self._inbox = _Quiet(furnished(config, [False] * joints, None, standing_by(config)))
        self._room = Room(self._inbox, about(config))
        self.player = Player(tape, span, clock, self._publish)
        methods = {name: self._shown(method) for name, method in arm_methods(self._room).items()}
        methods |= table(observer=(self.replay_get, lister(methods)), operator=self._keys())
        self.server = Server(methods, socket)

    async def replay_get(self, session: Session) -> Value:
        """Where the replay is: position and duration (s), speed, whether it is paused and begins again."""
        player = self.player
        return {
            "position_s": player.position,
            "duration_s": player.duration,
            "speed": None if player.speed == FASTEST else player.speed,
            "paused": player.paused,
            "loop": player.loop,
        }

    async def replay_pause(
        self, session: Session, on: Annotated[bool, Flag("false goes on")] = True
    ) -> Value:
        """Let the replay stand still, or go on."""
        self.player.pause(on)
        return None

    async def replay_seek(
        self, session: Session, position_s: Annotated[float, Number("s", 0, 1e9, "since the beginning")]
    ) -> Value:
        """Go on from another place; its first frame is shown even while paused."""
        self.player.seek(position_s)
        return None

    async def replay_speed(
        self, session: Session, speed: Annotated[float, Number("", 0.01, 1000, "times real time")]
    ) -> Value:
        """Play faster or slower."""
        self.player.set_speed(speed)
        return None

    async def replay_loop(
        self, session: Session, on: Annotated[bool, Flag("false ends at the end")] = True
    ) -> Value:
        """Begin again at the end, or not."""
        self.player.loop = on
        return None

    def _keys(self) -> tuple[Handler, ...]:
        return (self.replay_pause, self.replay_seek, self.replay_speed, self.replay_loop)

    def _shown(self, method: Method) -> Method:
        """The arm's method as it is here: looking goes on, `stop` pauses, and nothing else does anything."""
        if method.name == "stop":
            return replace(method, handler=self._stop)
        if method.role is Role.OBSERVER:
            return method
        return replace(method, handler=_refuse)

    async def _stop(self, session: Session) -> Value:
        self.player.pause(True)
        return None

    def _publish(self, entry: object) -> None:
        if isinstance(entry, Frame):
            self._inbox.newest = self._room.newest = entry
            self.server.publish_state(entry)
        elif isinstance(entry, Event):
            self.server.publish_event(entry)
        elif isinstance(entry, EmgBlock):
            self.server.publish_emg(entry)


def standing_by(config: Config) -> Mind:
    """As it was live, or without learners if the snapshot of an adviser is gone: here they only stand by."""
    try:
        return mind_of(config)
    except ConfigError as error:
        if not (config.learn and config.learn.advisers):
            raise
        _log.warning("What was learned cannot be asked for: %s", error)
        return mind_of(config.model_copy(update={"learn": None, "assist": None, "assists": ()}))


async def _refuse(session: Session, *values: Value) -> Value:
    raise Refused("this is a recording: nothing that is asked moves or changes anything")


def explained(error: BentodError, config_name: str) -> str:
    """Why a recording's config cannot be used by this version."""
    return f"The config in the recording ({config_name or 'unnamed'}) does not suit this bentod: {error}"
