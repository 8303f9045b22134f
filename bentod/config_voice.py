"""The table of the config that says what is spoken, and what is heard while nobody speaks."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import Field, field_validator, model_validator

from bentod.config_base import Table
from bentod.config_sounds import NAMED, File, Say, event_problem, parse_sound, split
from bentod.errors import nearest
from bentod.frames import Value

MOST_SOUNDS = 128


class Voice(Table):
    """What is heard of the arm; an empty table is as good as any (docs/voice.md)."""

    enabled: bool = True
    voice: Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9+_-]{0,31}$")] = "en"
    """A voice of espeak-ng, which is a language, e.g. "de", and perhaps a variant, e.g. "en-us+f3"."""
    speed: Annotated[int, Field(ge=80, le=450)] = 170
    """Words per minute."""
    volume: Annotated[float, Field(ge=0, le=1)] = 0.8
    folder: Path | None = None
    """The user's own WAVs: `joint.elbow_flexion.wav` there is heard in place of what `sounds` says."""
    cue: Literal["off", "tone"] = "off"
    """What is heard of the selected joint all the time, while the arm may be moved (thesis 5.6.6)."""
    cue_volume: Annotated[float, Field(ge=0, le=0.2)] = 0.03
    sounds: Annotated[dict[str, str], Field(max_length=MOST_SOUNDS)] = Field(default_factory=dict)
    """By event; what is not there sounds as usual (`DEFAULTS`)."""

    @field_validator("sounds", mode="before")
    @classmethod
    def _flat(cls, table: object) -> object:
        """`home.done = …` without quotes is a table in a table to TOML."""
        return dict(_flattened(table)) if isinstance(table, dict) else table

    @model_validator(mode="after")
    def _plausible(self) -> Self:
        problems = [
            problem for event, sound in self.sounds.items() for problem in self._problems(event, sound)
        ]
        if self.folder and not self.folder.expanduser().is_absolute():
            problems.append(
                f"folder = '{self.folder}' must begin with / or ~: the daemon, the voice and the dashboard "
                "may run in different folders"
            )
        if problems:
            raise ValueError("\n".join(problems))
        return self

    def _problems(self, event: str, sound: str) -> Iterator[str]:
        if why := event_problem(event):
            yield f"sounds.{event}: {why}"
        try:
            parts = parse_sound(sound)
        except ValueError as error:
            yield f"sounds.{event} = '{sound}': {error}"
            return
        if any(isinstance(part, File) for part in parts) and self.folder is None:
            yield f"sounds.{event} = '{sound}': needs voice.folder, the folder that the file is in"
        if split(event)[0] not in NAMED and any(isinstance(p, Say) and "{}" in p.text for p in parts):
            yield f"sounds.{event} = '{sound}': {{}} stands for a name, and only {', '.join(NAMED)} have one"

    def misnamed(self, joints: Sequence[str]) -> list[str]:
        """A sentence for each sound of a joint that there is not."""
        return [
            f"voice.sounds.{event}: there is no joint '{name}'{nearest(name, joints)}"
            for event in self.sounds
            for base, name in [split(event)]
            if base == "joint" and name and name not in joints
        ]

    def describe(self) -> dict[str, Value]:
        """The table as clients get it, and as they may read it again."""
        told: dict[str, Value] = self.model_dump(mode="json")
        return told


def _flattened(table: Mapping[object, object], before: str = "") -> Iterator[tuple[str, object]]:
    for key, value in table.items():
        if isinstance(value, dict):
            yield from _flattened(value, f"{before}{key}.")
        else:
            yield f"{before}{key}", value
