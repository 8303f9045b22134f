"""Where ticks, muscle signals and commands go: subscribers, the recording, the log, the supervisor."""

import logging
from collections.abc import Sequence

from bentod.contracts import Clock
from bentod.frames import ClientCommand, EmgBlock, Event, Frame, Value
from bentod.record.takes import Takes
from bentod.serve.room import Room
from bentod.serve.server import Server
from bentod.supervise import Supervisor

_log = logging.getLogger(__name__)

_LEVELS = {
    "fault": logging.WARNING,
    "servo": logging.WARNING,
    "late": logging.WARNING,
    "diverged": logging.WARNING,
    "recording": logging.WARNING,
    "group": logging.DEBUG,
    "goal": logging.DEBUG,
}
"""Of events; what happens every few seconds while the arm is used is for subscribers, not for the log."""


class Publisher:
    """Nothing here waits."""

    def __init__(
        self, room: Room, server: Server, supervisor: Supervisor, clock: Clock, takes: Takes
    ) -> None:
        self._room = room
        self._server = server
        self._supervisor = supervisor
        self._clock = clock
        self._takes = takes
        self._status = ""

    def publish(self, frame: Frame, events: Sequence[Event], whole: bool) -> None:
        """Called by the tick, and only by it; a tick that is `whole` feeds the watchdog."""
        self._room.newest = frame
        self._server.publish_state(frame)
        self._record(frame)
        for event in (*events, *self._of_recording(frame.time)):
            self._server.publish_event(event)
            self._record(event)
            _log.log(_level(event), "%s", event.text)
        if whole:
            self._supervisor.tick(self._clock.now())
        status = f"fault: {frame.fault}" if frame.fault else frame.mode.value
        if status != self._status:
            self._supervisor.status(status)
            self._status = status

    def heard(self, block: EmgBlock) -> None:
        """Called with every block of muscle signals, as it arrives."""
        self._record(block)
        self._server.publish_emg(block)

    def commanded(self, client: str, method: str, params: Value, error: str) -> None:
        """Called with what a client asked of the arm, once it is answered."""
        tick = self._room.newest.tick if self._room.newest else 0
        self._record(ClientCommand(self._clock.now(), tick, client, method, params, error))

    def _record(self, entry: Frame | EmgBlock | Event | ClientCommand) -> None:
        self._takes.put(entry)

    def _of_recording(self, time: float) -> list[Event]:
        """What the recording has to say (time: monotonic s)."""
        return [Event(time, "recording", sentence, {}) for sentence in self._takes.take_events()]


def _level(event: Event) -> int:
    """A recording that was asked for or ended is no news of its own; one that fails is."""
    asked = event.kind == "recording" and "recording" in event.data
    return logging.INFO if asked else _LEVELS.get(event.kind, logging.INFO)
