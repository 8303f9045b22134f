"""Methods about the session, not the arm: notes, trials, the recording; clients read the docstrings."""

from collections.abc import Sequence
from typing import Annotated

from bentod.desk import Desk
from bentod.errors import Refused
from bentod.frames import Trial, Value
from bentod.serve.params import Free, Text
from bentod.serve.room import Room, Takes
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

    async def mark(
        self, session: Session, mark: Annotated[str, Text("contact, circuit, or what you like", 200)]
    ) -> Value:
        """Note that something happened, as an event: in the trial if one runs, else for itself.

        Returns that trial, or nil.
        """
        trial = (await self._room.inbox.ask(lambda desk: desk.mark(mark, session.client))).result
        return _shown(trial) if trial else None

    async def get_recording(self, session: Session) -> Value:
        """How the recording goes: file, bytes, what was dropped, and why it ended, if it did.

        `started` is in monotonic s, `started_wall` in s since the epoch. When nothing is recorded any more,
        it tells of the last that was.
        """
        return self._takes().describe()

    async def recording_start(
        self, session: Session, note: Annotated[str, Text("kept in the file, e.g. what it is of", 200)] = ""
    ) -> Value:
        """Record into a new file; one that is being recorded ends when the new one is open. No tick is lost.

        Learners go on, and what they know is not in the new file: only a recording that begins with the
        daemon can be learned again as it was.
        """
        takes, who = self._takes(), session.client
        await takes.start(note)
        helped = self._helped()
        await self._room.inbox.ask(lambda desk: _begun(desk, who, note, helped))
        return takes.describe()

    async def recording_stop(self, session: Session) -> Value:
        """End the recording; the answer comes when its file is whole."""
        takes = self._takes()
        if takes.describe()["recording"]:
            ended = f"{session.client} ended the recording"
            data: dict[str, Value] = {"recording": False}
            await self._room.inbox.ask(lambda desk: desk.journal.note("recording", ended, data))
        await takes.stop()
        return takes.describe()

    def _helped(self) -> list[str]:
        """Groups that have an assist."""
        frame = self._room.newest
        return [it.group for it in (frame.assist, *frame.more_assists) if it.group] if frame else []

    def _takes(self) -> Takes:
        if self._room.takes is None:
            raise Refused("nothing is recorded here")
        return self._room.takes


def _begun(desk: Desk, who: str, note: str, helped: Sequence[str]) -> None:
    """Tell of a recording what was changed before it began and its config does not say."""
    said = f": {note}" if note else ""
    desk.journal.note("recording", f"{who} began a recording{said}", {"recording": True, "note": note})
    for group in helped:
        text = f"assist of {group} as the recording begins"
        desk.journal.note("assist", text, desk.mind.describe(group))


def _shown(trial: Trial) -> Value:
    return {"trial": trial.number, "name": trial.name, "condition": trial.condition}
