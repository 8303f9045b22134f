"""The table [learn] of the config: what is predicted, from what, by which algorithm."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Literal, Self, TypeAlias

from pydantic import Field, model_validator

from bentod.config_base import Name, Table

Expression: TypeAlias = Annotated[str, Field(min_length=1, max_length=500)]
"""A number of the state, e.g. "elbow.position" or "above(gripper.load, 0.2)": see docs/learning.md."""

GvfName: TypeAlias = Annotated[str, Field(pattern=r"^[a-zA-Z{][a-zA-Z0-9_.@{}-]{0,63}$")]
Timescale: TypeAlias = Annotated[float, Field(gt=1, le=10_000)]
Seconds: TypeAlias = Annotated[float, Field(gt=0, le=1000)]
Share: TypeAlias = Annotated[float, Field(ge=0, le=1)]

ARM = "arm"
"""The representation that every [learn] table with `joints` has: that of thesis 5.3."""


class Tiles(Table):
    """One tile coding of a representation: grids of tiles over inputs that lie in 0..1."""

    inputs: Annotated[tuple[Expression, ...], Field(min_length=1, max_length=256)]
    combine: Literal["together", "each", "pairs"] = "together"
    """One coding of all inputs; or one of each input; or one of each pair of inputs."""
    tilings: Annotated[int, Field(ge=1, le=1024)] = 8
    width: Annotated[float, Field(gt=0, le=1)] | tuple[Annotated[float, Field(gt=0, le=1)], ...] = 1.0
    """Of a tile, for all dimensions or, one each, for those of one coding."""
    memory: Annotated[int, Field(ge=0, le=1 << 24)] = 0
    """Features that the tiles are hashed into; 0 gives every tile its own."""


class RepresentationTable(Table):
    """How the state becomes features."""

    name: Name
    bias: bool = True
    tiles: Annotated[tuple[Tiles, ...], Field(max_length=64)] = ()
    raw: Annotated[tuple[Expression, ...], Field(max_length=4096)] = ()
    """Features with the values of expressions, as they are."""

    @model_validator(mode="after")
    def _something(self) -> Self:
        if self.name == ARM:
            raise ValueError(f"'{ARM}' is what learn.joints makes: choose another name")
        if not (self.tiles or self.raw):
            raise ValueError("needs tiles, raw inputs, or both")
        return self


class Gvf(Table):
    """One general value function, or a family of them: one for each cumulant and each timescale."""

    name: GvfName
    """Of a family, {cumulant} and {timescale} stand where it has several: "{cumulant}@{timescale}"."""
    cumulant: Expression | Annotated[tuple[Expression, ...], Field(min_length=1, max_length=4096)]
    """An expression; or several; or one with stars that stands for all signals it matches: "*.velocity"."""
    timescale: Timescale | Annotated[tuple[Timescale, ...], Field(min_length=1)] | None = None
    """In ticks."""
    timescale_s: Seconds | Annotated[tuple[Seconds, ...], Field(min_length=1)] | None = None
    gamma: Share | Expression | None = None
    """A number, or an expression of the state, which is kept in 0..1."""
    scaling: Literal["instantaneous", "cumulative"] = "instantaneous"
    """Whether the cumulant is multiplied by 1 − γ (thesis 2.3.3)."""
    trace_lambda: Share = 0.95
    step_size: Annotated[float, Field(gt=0, le=1)] = 0.3
    """Divided by the number of active features, this is α."""
    algorithm: Annotated[str, Field(pattern=r"^[a-z][a-z0-9_-]{0,31}$")] = "true_online"
    options: Mapping[str, Annotated[float, Field(ge=-1e6, le=1e6)]] = {}
    """The algorithm's own parameters."""
    representation: Name = ARM
    policy: Expression | None = None
    """ρ, for algorithms that learn off policy: how much likelier that policy was to do what was done."""
    initial: Annotated[float, Field(ge=-1e9, le=1e9)] = 0.0
    """What is predicted before anything is learned, to within the features that collisions cost."""
    confidence: bool = True
    """Whether U and C of thesis 6.1.1 are estimated; costs as many weights again."""
    confidence_range: Annotated[float, Field(gt=0, le=1e9)] | None = None
    """What |δ| is divided by; left out, the span of the cumulant seen so far."""
    interval: Annotated[int, Field(ge=0, le=100)] = 0
    """How many past weight vectors tell how far it has converged; 0 keeps none."""
    variance: bool = False
    """Whether a companion "<name>.variance" learns the variance of the λ-return."""
    adviser: Name | None = None
    """Whose answer to the question of the same name is the initial guess; `initial` then counts nothing."""

    @model_validator(mode="after")
    def _one_horizon(self) -> Self:
        given = [self.timescale, self.timescale_s, self.gamma]
        if sum(value is not None for value in given) != 1:
            raise ValueError("needs exactly one of timescale (ticks), timescale_s and gamma")
        if self.interval == 1:
            raise ValueError("interval: it takes 2 past weight vectors at least, or 0 for none")
        return self

    @model_validator(mode="after")
    def _an_interval_of_several(self) -> Self:
        if self.interval == 1:
            raise ValueError("interval = 1: one weight vector makes no interval; give it 2 to 100, or 0")
        if self.interval and self.adviser:
            raise ValueError("interval: is of weights alone, to which an adviser's answer would be missing")
        return self


class AdviserTable(Table):
    """What was learned elsewhere, and gives advice here without learning any more (thesis 4.6.1)."""

    name: Name
    snapshot: Path
    digest: Annotated[str, Field(pattern=r"^([0-9a-f]{64})?$")] = ""
    """SHA-256 that `bentod learn show` tells; given, no other snapshot is taken. A recording gives it."""


class SnapshotTable(Table):
    """Where what was learned is kept from session to session."""

    path: Path | None = None
    """Left out, it is named after the config, in the state directory of the user or the service."""
    every_s: Annotated[float, Field(ge=5, le=86_400)] = 60.0


class Learn(Table):
    """What is predicted and how it is learned (thesis 5.3); questions of one's own in `gvfs`."""

    joints: Annotated[tuple[Name, ...], Field(max_length=8)] = ()
    """Whose angles and history the representation "arm" is made of."""
    predict: tuple[Name, ...] = ()
    timescales: Annotated[tuple[Timescale, ...], Field(min_length=1)] = (20.0,)
    representation: Name = ARM
    """What the joints' positions at `timescales`, which assists follow, are predicted from."""
    tilings: Annotated[int, Field(ge=1, le=1024)] = 100
    memory: Annotated[int, Field(ge=16, le=1 << 20)] = 2048
    trace_decay: Annotated[float, Field(ge=0, lt=1)] = 0.99
    trace_lambda: Share = 0.95
    step_size: Annotated[float, Field(gt=0, le=1)] = 0.3
    budget: Annotated[float, Field(gt=0, le=1)] = 0.6
    """Share of a tick's period after which no learner is updated any more in that tick."""
    kernel: Literal["auto", "numpy", "compiled"] = "auto"
    """What updates the shared weights: the compiled kernel where there is one, or numpy."""
    precision: Literal["float64", "float32"] = "float64"
    define: Mapping[Name, Expression] = {}
    """Names for expressions, to be used in others."""
    representations: Annotated[tuple[RepresentationTable, ...], Field(max_length=64)] = ()
    gvfs: Annotated[tuple[Gvf, ...], Field(max_length=4096)] = ()
    snapshot: SnapshotTable | None = None
    advisers: Annotated[tuple[AdviserTable, ...], Field(max_length=8)] = ()
    """Whose answers `advice("name", "question")` are."""
    adviser: Name | None = None
    """Whose answers to the questions about `joints` are where those begin."""

    def of(self, digests: Mapping[str, str]) -> Self:
        """The same, and of these snapshots only: each adviser's by its whole path and its digest."""
        pinned = tuple(
            table.model_copy(update={"snapshot": table.snapshot.absolute(), "digest": digests[table.name]})
            for table in self.advisers
        )
        return self.model_copy(update={"advisers": pinned})

    @model_validator(mode="after")
    def _something(self) -> Self:
        if not (self.joints or self.gvfs):
            raise ValueError("needs joints to predict from, or gvfs")
        if self.predict and not self.joints:
            raise ValueError("predict: needs joints to predict from")
        if self.representation != ARM and not self.joints:
            raise ValueError("representation: needs joints, whose positions are predicted from it")
        if self.adviser and not self.joints:
            raise ValueError("adviser: needs joints, about whose positions it is asked")
        names = [adviser.name for adviser in self.advisers]
        if twice := [name for name in names if names.count(name) > 1]:
            raise ValueError(f"advisers: the name '{twice[0]}' stands {names.count(twice[0])} times")
        return self
