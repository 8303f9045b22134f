"""Methods about general value functions: what is asked, added and forgotten; clients read the docstrings."""

from typing import Annotated

from bentod.frames import Value
from bentod.serve.params import Free, Text
from bentod.serve.room import Room
from bentod.serve.session import Session

Gvfs = Annotated[str | list[str], Text("name of a GVF, or a list of them", 128)]


class LearningMethods:
    """Handlers of what can be asked about the future."""

    def __init__(self, room: Room) -> None:
        self._room = room

    async def gvf_list(self, session: Session) -> Value:
        """Every GVF: its question, newest prediction, confidence, surprise and error against the return."""
        return (await self._room.inbox.ask(lambda desk: desk.describe_gvfs())).result

    async def gvf_add(
        self,
        session: Session,
        gvf: Annotated[Value, Free("what [[learn.gvfs]] may hold, e.g. name, cumulant, timescale", 8192)],
    ) -> Value:
        """Learn one more GVF, or a family, from the next tick on; returns the names."""
        answer = await self._room.inbox.ask(lambda desk: desk.add_gvf(gvf))
        return list[Value](answer.result)

    async def gvf_remove(self, session: Session, name: Gvfs) -> Value:
        """Forget GVFs: their questions and all that was learned about them."""
        await self._room.inbox.ask(lambda desk: desk.remove_gvfs(_names(name)))
        return None

    async def gvf_reset(self, session: Session, name: Gvfs) -> Value:
        """Let GVFs begin anew, as if nothing had been learned."""
        await self._room.inbox.ask(lambda desk: desk.reset_gvfs(_names(name)))
        return None


def _names(name: str | list[str]) -> tuple[str, ...]:
    return (name,) if isinstance(name, str) else tuple(name)
