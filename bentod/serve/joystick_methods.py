"""What clients may know of the joystick at the daemon's machine; they read the docstrings."""

from bentod.frames import Value
from bentod.serve.room import Room
from bentod.serve.session import Session


class JoystickMethods:
    """Handlers about the joystick."""

    def __init__(self, room: Room) -> None:
        self._room = room

    async def joystick_get(self, session: Session) -> Value:
        """What the axes and buttons of the joystick do, and how it is; nil if the config has none."""
        ask = self._room.inbox.ask
        return (await ask(lambda desk: desk.joystick.describe() if desk.joystick else None)).result
