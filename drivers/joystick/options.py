"""The tables of the sources of pushes: keys and bounds."""

from collections.abc import Mapping
from typing import Annotated, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from bentod.errors import ConfigError
from bentod.frames import Value


class Table(BaseModel):
    """No unknown keys, no changes after reading."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class LinuxOptions(Table):
    """`[joystick.source]` of the source "linux"."""

    device: Annotated[str, Field(min_length=1, max_length=4096)] = "/dev/input/js0"
    """A name below /dev/input/by-id stays when devices come and go."""


class SdlOptions(Table):
    """`[joystick.source]` of the source "sdl"."""

    pad: Annotated[int, Field(ge=0, le=15)] | Annotated[str, Field(min_length=1, max_length=128)] = 0
    """Its number, or a part of its name."""


Checked = TypeVar("Checked", bound=Table)


def parse(model: type[Checked], table: Mapping[str, Value]) -> Checked:
    """`table` as a checked `model`. Raises ConfigError: a key is unknown, or a value out of bounds."""
    try:
        return model.model_validate(dict(table))
    except ValidationError as error:
        lines = (f"{'.'.join(map(str, one['loc']))}: {one['msg']}" for one in error.errors())
        raise ConfigError(f"The joystick's options: {'; '.join(lines)}.") from None
