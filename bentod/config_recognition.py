"""The table of the config that says how classes of muscle signals are recognised, and what each moves."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Self, TypeAlias

from pydantic import Field, JsonValue, model_validator

from bentod.config_adaptation import Adaptation, Fusion
from bentod.config_base import Name, Table

Word: TypeAlias = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_ -]{0,31}$")]
"""What a class is called, as it is prompted."""

Share: TypeAlias = Annotated[float, Field(ge=-1, le=1)]

RESTING = "rest"
"""The class that always is there, and moves nothing."""


class RecognisedClass(Table):
    """What one class of contraction moves."""

    name: Word
    group: Name
    moves: Annotated[dict[Name, Share], Field(min_length=1, max_length=32)]
    """Of each joint, the share of its greatest velocity at full speed; several joints are a synergy."""

    @model_validator(mode="after")
    def _moving(self) -> Self:
        problems = [f"moves.{joint} is 0: leave it out" for joint, share in self.moves.items() if not share]
        if self.name == RESTING:
            problems.append(f"'{RESTING}' is there by itself, and moves nothing")
        if problems:
            raise ValueError("\n".join(problems))
        return self


class Recognition(Table):
    """Pattern recognition of muscle signals."""

    folder: Path | None = None
    """Of models and of what they are trained on; without, in the state directory, named after the config."""
    model: Name = "model"
    """Which model is used at the start."""
    channels: Annotated[tuple[Annotated[int, Field(ge=0, le=255)], ...], Field(max_length=64)] = ()
    """Of the source; none: all that it has."""
    window_s: Annotated[float, Field(ge=0.02, le=2)] = 0.15
    step_s: Annotated[float, Field(ge=0.005, le=1)] = 0.05
    features: Annotated[tuple[str | dict[str, JsonValue], ...], Field(min_length=1, max_length=32)] = ("td",)
    classifier: Name = "lda"
    options: Mapping[str, Annotated[float, Field(ge=-1e6, le=1e6)]] = {}
    """The classifier's own."""
    tonic: Annotated[float, Field(ge=0, le=10)] | None = None
    """Train also as if a load were held, up to so many times the loudest channel."""
    seed: Annotated[int, Field(ge=0, le=2**31)] = 0
    reject_below: Annotated[float, Field(ge=0, le=1)] = 0.5
    votes: Annotated[int, Field(ge=1, le=31)] = 3
    flutter: Annotated[int, Field(ge=1, le=20)] = 1
    ramp: Annotated[int, Field(ge=0, le=200)] = 0
    ramp_down: Annotated[int, Field(ge=1, le=200)] = 2
    proportional: bool = True
    adaptation: Adaptation | None = None
    """Whether the classifier follows the wearer; needs `lda_adaptive`."""
    fusion: Fusion | None = None
    """Whether what is predicted counts."""
    classes: Annotated[tuple[RecognisedClass, ...], Field(min_length=1, max_length=32)]

    @model_validator(mode="after")
    def _whole(self) -> Self:
        names = [one.name for one in self.classes]
        problems: list[str] = []
        if self.adaptation and self.classifier != "lda_adaptive":
            problems.append(f"adaptation: needs classifier = 'lda_adaptive', not '{self.classifier}'")
        problems += [f"the class '{name}' stands {names.count(name)} times" for name in sorted(set(names))
                    if names.count(name) > 1]  # fmt: skip
        if not self.votes % 2:
            problems.append(f"votes = {self.votes}: of two classes one must win, so it must be odd")
        if len(set(self.channels)) != len(self.channels):
            problems.append("channels: one stands twice")
        if problems:
            raise ValueError("\n".join(problems))
        return self

    def groups(self) -> tuple[str, ...]:
        """Of which joints are moved, in order of the classes."""
        return tuple(dict.fromkeys(one.group for one in self.classes))
