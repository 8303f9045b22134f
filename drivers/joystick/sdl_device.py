"""One pad that SDL has opened: its events to axes and buttons."""

from collections.abc import Iterable
from dataclasses import replace
from types import ModuleType
from typing import Protocol, cast

from bentod.contracts import Pad


class Stick(Protocol):
    """What we use of pygame's joystick. Numbers of axes, buttons and hats are from 0."""

    def get_name(self) -> str:
        """As the device calls itself."""
        ...

    def get_instance_id(self) -> int:
        """By which events tell devices apart."""
        ...

    def get_numaxes(self) -> int:
        """How many axes."""
        ...

    def get_numbuttons(self) -> int:
        """How many buttons."""
        ...

    def get_numhats(self) -> int:
        """How many hats: small sticks that know nine places."""
        ...

    def get_axis(self, number: int) -> float:
        """-1..1; 0 until it first moves, wherever it is."""
        ...

    def get_button(self, number: int) -> bool:
        """Whether it is down."""
        ...

    def get_hat(self, number: int) -> tuple[int, int]:
        """To the right and up, each -1, 0 or 1."""
        ...


class Event(Protocol):
    """What we use of pygame's events."""

    type: int
    instance_id: int
    button: int


class Device:
    """A pad while it is plugged in. Hats come after the axes, two numbers each, up being negative."""

    def __init__(self, pygame: ModuleType, stick: Stick, openings: int, now: float) -> None:
        self.name = stick.get_name()
        self._stick = stick
        self._pressed = int(pygame.JOYBUTTONDOWN)
        self._removed = int(pygame.JOYDEVICEREMOVED)
        told = (pygame.JOYAXISMOTION, pygame.JOYBUTTONDOWN, pygame.JOYBUTTONUP, pygame.JOYHATMOTION)
        self._told = frozenset(map(int, told))
        presses = (0,) * stick.get_numbuttons()
        self.pad = Pad(connected=True, presses=presses, openings=openings, seen=now, changed=now)
        pygame.event.get()  # SDL tells what is held already as if it was pressed now
        self._look()

    def take(self, events: Iterable[object], now: float) -> bool:
        """Take in SDL's events (monotonic s); false: the pad was unplugged."""
        presses, changed = list(self.pad.presses), self.pad.changed
        for event in cast("Iterable[Event]", events):
            if getattr(event, "instance_id", None) != self._stick.get_instance_id():
                continue
            if event.type == self._removed:
                return False
            if event.type == self._pressed and event.button < len(presses):
                presses[event.button] += 1
            changed = now if event.type in self._told else changed
        self.pad = replace(self.pad, presses=tuple(presses), changed=changed)
        self._look()
        return True

    def _look(self) -> None:
        stick = self._stick
        axes = [max(-1.0, stick.get_axis(number)) for number in range(stick.get_numaxes())]
        for hat in range(stick.get_numhats()):
            right, up = stick.get_hat(hat)
            axes += [float(right), float(-up)]
        buttons = tuple(bool(stick.get_button(number)) for number in range(stick.get_numbuttons()))
        self.pad = replace(self.pad, axes=tuple(axes), buttons=buttons)


def attached(pygame: ModuleType, wanted: int | str, opening: int, now: float) -> tuple[Device | None, str]:
    """The pad of that number, or with that in its name; without one, why there is none."""
    count = int(pygame.joystick.get_count())
    if isinstance(wanted, int):
        if wanted < count:
            return Device(pygame, pygame.joystick.Joystick(wanted), opening, now), ""
        return None, f"SDL finds {count} joysticks; number {wanted}, counted from 0, is not among them."
    names = []
    for number in range(count):
        stick = pygame.joystick.Joystick(number)
        names.append(str(stick.get_name()))
        if wanted.casefold() in names[-1].casefold():
            return Device(pygame, stick, opening, now), ""
    return None, f"SDL finds no joystick '{wanted}' (there: {', '.join(names) or 'none'})."
