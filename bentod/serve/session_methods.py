"""Methods about the session, not the arm: notes, trials, the recording; clients read the docstrings."""

from typing import Annotated

from bentod.errors import Refused
from bentod.frames import Trial, Value
from bentod.serve.params import Free, Text
from bentod.serve.room import Room
from bentod.serve.session import Session


class SessionMethods:
    """Handlers of what an experimenter notes."""

    def __init__(self, room: Room) -> None:
        self._room = room

    async def set_meta(
        self, session: Session, meta: Annotated[Value, Free("anything, e.g. participant and session")]
    ) -> Value:
        """Put a note into every frame from now on."""
        await self._room.inbox.ask(lambda desk: desk.set_meta(meta))
        return None

    async def trial_start(
        self,
        session: Session,
        name: Annotated[str, Text("e.g. of the task", 64)],
        condition: Annotated[str, Text("e.g. dpcc or toggling", 64)] = "",
    ) -> Value:
        """Begin a trial; every frame names it until it is stopped. Returns its number."""
        answer = await self._room.inbox.ask(lambda desk: desk.trials.start(name, condition))
        return _shown(answer.result)

    async def trial_stop(self, session: Session) -> Value:
        """End the trial that is running."""
        return _shown((await self._room.inbox.ask(lambda desk: desk.trials.stop())).result)

    async def trial_mark(
        self, session: Session, mark: Annotated[str, Text("circuit, contact, or what you like", 64)]
    ) -> Value:
        """Note something that happened in the trial, as an event."""
        return _shown((await self._room.inbox.ask(lambda desk: desk.mark_trial(mark))).result)

    async def get_recording(self, session: Session) -> Value:
        """How the recording goes: file, bytes, what was dropped, and why it ended, if it did."""
        if self._room.recording is None:
            raise Refused("nothing is recorded: record.enabled is false")
        return self._room.recording()


def _shown(trial: Trial) -> Value:
    return {"trial": trial.number, "name": trial.name, "condition": trial.condition}
