"""What can be asked of each feature: its table, with units, bounds and defaults, and the named sets."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Annotated, Literal, TypeAlias

from pydantic import Field, ValidationError

from bentod.config_base import Table
from bentod.config_errors import explain
from bentod.errors import ConfigError, nearest
from bentod.frames import Value

Asking: TypeAlias = str | Mapping[str, Value]
"""The name of a feature or of a set of them, or a table with `name` and what is not as by default."""

Volts: TypeAlias = Annotated[float, Field(ge=-1e6, le=1e6)]


class Feature(Table):
    """A feature of each channel by itself, of each of so many equal parts of a window."""

    name: str
    segments: Annotated[int, Field(ge=1, le=100)] = 1


class Bias(Table):
    """A column of ones."""

    name: str
    segments: Literal[1] = 1


class Slope(Feature):
    """From each segment to the next."""

    segments: Annotated[int, Field(ge=2, le=100)] = 3


class Thresholded(Feature):
    """A count of what goes beyond a threshold; 0: beyond nothing."""

    threshold_v: Annotated[float, Field(ge=0, le=1e3)] = 0.0


class Histogram(Feature):
    """Bins of equal width from `low_v` to `high_v` of each channel, the outer ones open; `fit` finds both."""

    bins: Annotated[int, Field(ge=2, le=1000)] = 9
    low_v: tuple[Volts, ...] = ()
    high_v: tuple[Volts, ...] = ()


class Ratios(Feature):
    """Of pairs of channels; `floor_v`: least sum of a pair, from what the electrodes give at rest."""

    floor_v: Annotated[float, Field(gt=0, le=1e3)] = 1e-6


class Logarithm(Feature):
    """`floor_v`: least value that has a logarithm of its own, from what the electrodes give at rest."""

    floor_v: Annotated[float, Field(gt=0, le=1e3, allow_inf_nan=False)] = 5e-6


class Autoregressive(Feature):
    """Coefficients of a linear prediction from the `order` samples before."""

    order: Annotated[int, Field(ge=1, le=30)] = 4


class Cepstral(Autoregressive):
    """Coefficients of the cepstrum of a linear prediction by this method."""

    method: Literal["burg", "autocorr"] = "burg"


Asked: TypeAlias = Feature | Bias

TABLES: dict[str, type[Asked]] = {
    **dict.fromkeys(
        ("mav", "iav", "wl", "rms", "var_centred", "var_meansquare", "var_zero_mean"),
        Feature,
    ),
    **dict.fromkeys(("zc", "zc_product", "ssc", "ssc_ge0", "wamp"), Thresholded),
    **dict.fromkeys(("ar_burg", "ar_autocorr"), Autoregressive),
    "mavs": Slope,
    "hist": Histogram,
    "ratios": Ratios,
    "log_rms": Logarithm,
    "cc": Cepstral,
    "bias": Bias,
}
"""The features by name."""

TD: tuple[dict[str, Value], ...] = ({"name": "mav"}, {"name": "zc"}, {"name": "ssc"}, {"name": "wl"})
"""Features of the time domain (Hudgins et al. 1993), without the slope of the first."""

SETS: dict[str, tuple[dict[str, Value], ...]] = {
    "td": TD,
    "tdar": (*TD, {"name": "ar_burg", "order": 4}),
    # What a load adds moves logarithms and ratios less than volts: `bentod study patterns`.
    "robust": ({"name": "log_rms"}, {"name": "ratios"}, {"name": "ar_burg", "order": 4}),
    # Table 3.2 of the thesis, whose 0.1 V are behind the amplifier.
    "thesis": (
        {"name": "mav", "segments": 10},
        {"name": "zc", "threshold_v": 0.1},
        {"name": "ssc", "threshold_v": 0.1},
        {"name": "wl", "segments": 5},
        {"name": "var_zero_mean", "segments": 6},
        {"name": "mavs", "segments": 5},
        {"name": "hist", "bins": 70},
        {"name": "ratios", "segments": 5},
        {"name": "cc", "order": 2},
        {"name": "ar_burg", "order": 2},
        {"name": "bias"},
    ),
}
"""Sets of features by name. What a table says besides the name is for those of the set that know the key."""


def read(asking: Asking | Sequence[Asking], channels: int) -> tuple[Asked, ...]:
    """The features that are asked for, in order.

    Raises:
        ConfigError: a name or key is unknown, a value is out of bounds, a feature is asked for twice.
    """
    each = [asking] if isinstance(asking, str | Mapping) else asking
    found = tuple(_read(table, channels) for one in each for table in _tables(one))
    if not found:
        raise ConfigError("there is no feature in the list of features", "features")
    for number, asked in enumerate(found):
        if asked in found[:number]:
            raise ConfigError(f"the feature '{asked.name}' is asked for twice in the same way", "features")
    return found


def _tables(asking: Asking) -> Iterator[Mapping[str, Value]]:
    """One for each feature."""
    table = {"name": asking} if isinstance(asking, str) else dict(asking)
    name = table.pop("name", None)
    if not isinstance(name, str):
        raise ConfigError(f"the feature {asking!r} has no name", "features")
    if name in SETS:
        yield from _members(name, table)
    elif name in TABLES:
        yield {"name": name, **table}
    else:
        raise ConfigError(f"there is no feature '{name}'{nearest(name, [*TABLES, *SETS])}", "features")


def _members(name: str, changes: Mapping[str, Value]) -> Iterator[Mapping[str, Value]]:
    known = {key for member in SETS[name] for key in TABLES[str(member["name"])].model_fields}
    for key in changes:
        if key not in known:
            raise ConfigError(f"no feature of '{name}' has a key '{key}'{nearest(key, known)}", "features")
    for member in SETS[name]:
        keys = TABLES[str(member["name"])].model_fields
        yield {**member, **{key: value for key, value in changes.items() if key in keys}}


def _read(table: Mapping[str, Value], channels: int) -> Asked:
    name = str(table["name"])
    model = TABLES[name]
    try:
        asked = model.model_validate(dict(table))
    except ValidationError as error:
        raise ConfigError("; ".join(explain(error, model, ("features", name))), "features") from error
    if isinstance(asked, Ratios) and channels < 2:
        raise ConfigError(f"'{name}' compares channels; of {channels} there is none to compare", "features")
    if isinstance(asked, Histogram):
        _check_edges(asked, channels)
    return asked


def _check_edges(asked: Histogram, channels: int) -> None:
    for key, values in (("low_v", asked.low_v), ("high_v", asked.high_v)):
        if len(values) not in (0, channels):
            raise ConfigError(f"hist.{key} has {len(values)} values for {channels} channels", "features")
    if len(asked.low_v) != len(asked.high_v):
        raise ConfigError("hist has one of low_v and high_v without the other", "features")
    for channel, (low, high) in enumerate(zip(asked.low_v, asked.high_v, strict=True)):
        if not low < high:
            raise ConfigError(
                f"hist of channel {channel}: low_v = {low:g} V must be below high_v = {high:g} V", "features"
            )
