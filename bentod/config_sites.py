"""The tables of the config that say how muscles drive groups of joints: sites, pairs, toggles."""

from typing import Annotated, Literal, Self, TypeAlias

from pydantic import AliasChoices, Field, model_validator

from bentod.config_base import Name, Table

Direction: TypeAlias = Literal["forward", "backward"]

Quiet: TypeAlias = Annotated[float, Field(ge=0.05, le=2)]
"""s that muscles must have been quiet for before a contraction counts as a new one."""


BRACHIOPLEXUS = {"smin_v": "threshold_v", "smax_v": "max_v"}
"""What users of brachIOplexus call a site's parameters, and the names that they have here."""


class Site(Table):
    """One EMG site (thesis A.1.2): effort is 0 at the threshold and 1 at the maximum."""

    name: Name
    channel: Annotated[int, Field(ge=0, le=255)]
    gain: Annotated[float, Field(gt=0, le=1e6)] = 1.0
    threshold_v: Annotated[float, Field(ge=0, le=10, validation_alias=AliasChoices("threshold_v", "smin_v"))]
    max_v: Annotated[float, Field(gt=0, le=10, validation_alias=AliasChoices("max_v", "smax_v"))]
    release: Annotated[float, Field(ge=0.1, le=1)] = 1.0
    """Share of the threshold below which an effort ends that has begun above it; effort is then 0 there."""

    @model_validator(mode="before")
    @classmethod
    def _once(cls, table: object) -> object:
        given = set(table) if isinstance(table, dict) else set()
        twice = [(theirs, ours) for theirs, ours in BRACHIOPLEXUS.items() if {theirs, ours} <= given]
        if twice:
            raise ValueError("\n".join(f"{one} is another name of {two}: give one" for one, two in twice))
        return table

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if not self.threshold_v < self.max_v:
            raise ValueError(f"threshold_v = {self.threshold_v} must be below max_v = {self.max_v}")
        return self


class CoContraction(Table):
    """A squeeze of both sites of a pair at once, which toggles."""

    direction: Direction = "forward"
    together_s: Annotated[float, Field(ge=0.02, le=0.5)] = 0.12
    """From the rise of one site to that of the other, at most (brachIOplexus: CCtime)."""
    dwell_s: Annotated[float, Field(ge=0.02, le=1)] = 0.2
    """How long both stay, at least."""
    rest_s: Quiet = 0.2
    refractory_s: Annotated[float, Field(ge=0, le=5)] = 0.5
    """From one toggle to the next, at least."""
    balance: Annotated[float, Field(ge=0, le=1)] = 0.45
    """Loudness of the weaker site, as a share of its maximum, over that of the stronger one, at least."""


class Pulse(Table):
    """A short and strong contraction of one site of a pair, which toggles."""

    site: Name
    direction: Direction = "forward"
    strong: Annotated[float, Field(ge=0.2, le=1)] = 0.7
    """Effort that it reaches, at least."""
    rise_s: Annotated[float, Field(ge=0.02, le=0.5)] = 0.12
    """How long it takes to reach that, at most."""
    least_s: Annotated[float, Field(ge=0.02, le=0.5)] = 0.08
    """From its rise to its end, at least: what is shorter is an artefact."""
    within_s: Annotated[float, Field(ge=0.1, le=1)] = 0.4
    """From its rise to its end, at most."""
    rest_s: Quiet = 0.2
    refractory_s: Annotated[float, Field(ge=0, le=5)] = 0.5

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        problems = [
            f"{key} = {value} must be below within_s = {self.within_s}"
            for key, value in (("rise_s", self.rise_s), ("least_s", self.least_s))
            if not value < self.within_s
        ]
        if problems:
            raise ValueError("\n".join(problems))
        return self


class Toggled(Table):
    """What drives one group, and sites that toggle it."""

    group: Name
    toggle: Name | None = None
    """The site of which a contraction selects the next joint."""
    toggle_back: Name | None = None
    """The site for the previous joint. The same as `toggle`: a short contraction is next, a long one back."""
    long_s: Annotated[float, Field(ge=0.2, le=3)] = 0.6
    """How long a contraction is at least that is long."""

    def sites(self) -> tuple[str, ...]:
        """Every site that is named, the toggles last."""
        return tuple(filter(None, (self.toggle, self.toggle_back)))


class Pair(Toggled):
    """Two sites that drive one group."""

    positive: Name
    negative: Name
    rule: Literal["difference", "first_over", "greatest"] = "difference"
    """What counts when both are contracted: docs/muscles.md."""
    co_contraction: CoContraction | None = None
    pulse: Pulse | None = None

    @model_validator(mode="after")
    def _two(self) -> Self:
        own = (self.positive, self.negative)
        problems = [] if len(set(own)) == 2 else [f"positive and negative are the same site, '{own[0]}'"]
        if self.pulse and self.pulse.site not in own:
            problems.append(f"pulse.site = '{self.pulse.site}' must be '{own[0]}' or '{own[1]}'")
        if problems:
            raise ValueError("\n".join(problems))
        return self

    def sites(self) -> tuple[str, ...]:
        """Every site that is named, the toggles last."""
        return (self.positive, self.negative, *super().sites())

    def shortest(self) -> dict[str, float]:
        """How long (s) contractions of the pair must last at least to be toggles, by key."""
        squeeze = {"co_contraction.dwell_s": self.co_contraction.dwell_s} if self.co_contraction else {}
        pulse = {"pulse.least_s": self.pulse.least_s} if self.pulse else {}
        return squeeze | pulse


class SingleSite(Toggled):
    """One site that drives a group both ways."""

    site: Name
    rule: Literal["two_state", "alternate"] = "two_state"
    weak: Literal["positive", "negative"] = "positive"
    """Where a weak contraction goes; a strong one goes the other way."""
    strong: Annotated[float, Field(ge=0.1, le=0.95)] = 0.5
    """Effort from which on a contraction is strong."""
    decide_s: Annotated[float, Field(ge=0.05, le=0.5)] = 0.15
    """s after the rise within which it must be so; nothing moves before."""
    rest_s: Quiet = 0.2

    @model_validator(mode="after")
    def _another(self) -> Self:
        if self.site in super().sites():
            raise ValueError(f"'{self.site}' drives the group, and so cannot be its toggle site")
        return self

    def sites(self) -> tuple[str, ...]:
        """Every site that is named, the toggles last."""
        return (self.site, *super().sites())
