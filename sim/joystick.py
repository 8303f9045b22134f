"""A simulated gamepad: pushed by a script, or by hand in tests, and unplugged on purpose."""

from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from bentod.contracts import Clock, Pad
from bentod.errors import ConfigError
from bentod.frames import Value

Level = Annotated[float, Field(ge=-1, le=1)]


class Table(BaseModel):
    """No unknown keys, no infinities, no changes after reading."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class Step(Table):
    """How the pad is pushed for a while."""

    seconds: Annotated[float, Field(ge=0.01, le=3600)]
    axes: Mapping[Annotated[str, Field(pattern=r"^\d{1,2}$")], Level] = {}
    """-1..1, by number; all others are at rest."""
    buttons: Annotated[tuple[Annotated[int, Field(ge=0, le=63)], ...], Field(max_length=64)] = ()
    """Those that are held."""


class Options(Table):
    """`[joystick.source]` of the source "sim"."""

    axes: Annotated[int, Field(ge=0, le=64)] = 8
    buttons: Annotated[int, Field(ge=0, le=64)] = 11
    program: Annotated[tuple[Step, ...], Field(max_length=1000)] = ()
    """Done again and again; without one nobody pushes anything."""


class SimPad:
    """A pad that tests may also push by hand. Faults are attributes that may change while it is in use."""

    def __init__(self, options: Options, clock: Clock) -> None:
        self._options = options
        self._clock = clock
        self._began = clock.now()
        self._step = -1  # of the program, counted through all its rounds
        self._openings = 1
        self._plugged = True
        self.axes = [0.0] * options.axes
        self.buttons = [False] * options.buttons
        self.presses = [0] * options.buttons
        self.changed = clock.now()
        """Monotonic s."""
        self.hung = False
        """Whoever looks at it looks no more: the time of its last sign of life stands still."""
        self._seen = clock.now()

    def latest(self) -> Pad:
        """How it is pushed now."""
        self._follow()
        if not self.hung:
            self._seen = self._clock.now()
        if not self._plugged:
            return Pad(reason="The simulated joystick is unplugged.", openings=self._openings)
        told = tuple(self.axes), tuple(self.buttons), tuple(self.presses)
        return Pad(True, "", *told, self._openings, self._seen, self.changed)

    def push(self, axis: int, value: float) -> None:
        """Push an axis to -1..1."""
        self.axes[axis] = value
        self.changed = self._clock.now()

    def press(self, *buttons: int) -> None:
        """Hold exactly these buttons."""
        for number, was in enumerate(self.buttons):
            self.buttons[number] = number in buttons
            self.presses[number] += number in buttons and not was
        self.changed = self._clock.now()

    def unplug(self) -> None:
        """Pull it out."""
        self._plugged = False

    def plug(self) -> None:
        """Plug it in again; what is held then is no press."""
        self._plugged = True
        self._openings += 1
        self.presses = [0] * len(self.presses)
        self.changed = self._clock.now()

    def _follow(self) -> None:
        """Do what the program has come to."""
        lap = sum(step.seconds for step in self._options.program)
        if not lap:
            return
        rounds, within = divmod(self._clock.now() - self._began, lap)
        place = 0
        while place < len(self._options.program) - 1 and within >= self._options.program[place].seconds:
            within -= self._options.program[place].seconds
            place += 1
        count = int(rounds) * len(self._options.program) + place
        for step in range(max(self._step, count - len(self._options.program)) + 1, count + 1):
            self._do(self._options.program[step % len(self._options.program)])
        self._step = count

    def _do(self, step: Step) -> None:
        self.press(*step.buttons)
        self.axes = [step.axes.get(str(number), 0.0) for number in range(len(self.axes))]


@asynccontextmanager
async def open_joystick(options: Mapping[str, Value], clock: Clock) -> AsyncIterator[SimPad]:
    """A simulated pad; the options are those of `Options`.

    Raises:
        ConfigError: an option is unknown or out of bounds.
    """
    try:
        checked = Options.model_validate(dict(options))
    except ValidationError as error:
        lines = (f"{'.'.join(map(str, one['loc']))}: {one['msg']}" for one in error.errors())
        raise ConfigError(f"The simulated joystick's options: {'; '.join(lines)}.") from None
    yield SimPad(checked, clock)
