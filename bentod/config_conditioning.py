"""The tables of the config that say how muscle signals are conditioned: filters, envelope, leads."""

from collections.abc import Mapping, Sequence
from typing import Annotated, Literal, Self, TypeAlias

from pydantic import Field, model_validator

from bentod.config_base import Table

Hz: TypeAlias = Annotated[float, Field(ge=0.5, le=5000)]

KEYS: Mapping[str, frozenset[str]] = {
    "high_pass": frozenset({"hz"}),
    "low_pass": frozenset({"hz"}),
    "band_pass": frozenset({"low_hz", "high_hz"}),
    "notch": frozenset({"hz"}),
}
"""Frequencies that each kind of filter needs, and no other has."""

ORDER, Q, HARMONICS = 2, 20.0, 1
"""What a filter has that is told nothing else."""

OWN: Mapping[str, Mapping[str, float]] = {
    kind: {"q": Q, "harmonics": HARMONICS} if kind == "notch" else {"order": ORDER} for kind in KEYS
}
"""The other keys of each kind, and their defaults."""

MOST_OF_NYQUIST = 0.98
"""Share of half the sampling rate below which a filter's frequencies must lie: nearer to it, its sections
are all but unstable."""

WIDEST = 4.0
"""Hz: least distance of the edges of a band-pass, so that it settles in less than a second."""


class Filter(Table):
    """One causal filter of every channel: a Butterworth of so many sections, or notches."""

    kind: Literal["high_pass", "low_pass", "band_pass", "notch"]
    hz: Hz | None = None
    low_hz: Hz | None = None
    high_hz: Hz | None = None
    order: Annotated[int, Field(ge=1, le=8)] | None = None
    """Of a Butterworth; a band-pass has so many poles on each side."""
    q: Annotated[float, Field(ge=1, le=60)] | None = None
    """Of a notch: its frequency over its width at -3 dB."""
    harmonics: Annotated[int, Field(ge=1, le=20)] | None = None
    """Of a notch: 1 is the mains' own frequency alone, 3 takes the second and the third as well."""

    @model_validator(mode="before")
    @classmethod
    def _with_defaults(cls, table: object) -> object:
        """Those of its kind, so that what is written down of a filter is all of it."""
        own = OWN.get(str(table.get("kind"))) if isinstance(table, dict) else None
        return {**own, **table} if own and isinstance(table, dict) else table

    @model_validator(mode="after")
    def _whole(self) -> Self:
        needed = KEYS[self.kind]
        given = {key for key in type(self).model_fields if getattr(self, key) is not None} - {"kind"}
        foreign = sorted(given - needed - set(OWN[self.kind]))
        problems = [f"{key} is missing: kind = '{self.kind}' needs it" for key in sorted(needed - given)]
        problems += [f"{key} does not belong to kind = '{self.kind}'" for key in foreign]
        low, high = self.low_hz, self.high_hz
        if not problems and low is not None and high is not None and not high - low >= WIDEST:
            problems.append(f"high_hz = {high:g} must be at least {WIDEST:g} Hz above low_hz = {low:g}")
        if problems:
            raise ValueError("\n".join(problems))
        return self

    def frequencies(self) -> dict[str, float]:
        """Hz, by key."""
        named = {"hz": self.hz, "low_hz": self.low_hz, "high_hz": self.high_hz}
        return {key: value for key, value in named.items() if value is not None}


class Leads(Table):
    """When a channel's signal is taken for that of a lead that is off."""

    enabled: bool = True
    hum: Annotated[float, Field(ge=0.5, le=1)] = 0.85
    """Share of the power that is mains hum, above which it is no muscle; 1 never is."""
    slow: Annotated[float, Field(ge=0.5, le=1)] = 0.9
    """Share of the power that is slower than 10 Hz, above which it is no muscle; 1 never is."""
    hum_max: Annotated[float, Field(ge=1, le=1e6)] = 3.0
    """Times the site's maximum: hum as loud as this, before the filters, is no good contact's."""
    flat_s: Annotated[float, Field(ge=0.2, le=60)] = 2.0
    """How long a channel may stay within `flat_v` before somebody is told."""
    flat_v: Annotated[float, Field(ge=0, le=1e-2)] = 0.0
    """Peak to peak; what an amplifier with its input shorted makes at the most. 0: one single value."""


def beyond(filters: Sequence[Filter], rate_hz: float) -> list[str]:
    """One line for each frequency that a source of that rate cannot carry: "filters.0.hz = ..."."""
    bound = MOST_OF_NYQUIST * rate_hz / 2
    return [
        f"filters.{i}.{key} = {hz:g}: the bound is {bound:g} Hz, {MOST_OF_NYQUIST:g} of half the rate of "
        f"{rate_hz:g} Hz"
        for i, one in enumerate(filters)
        for key, hz in one.frequencies().items()
        if hz > bound
    ]
