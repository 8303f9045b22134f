"""What a recording's own config says of muscles, learners and assist; read leniently: it may be old."""

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from bentod.frames import Value


@dataclass(frozen=True, slots=True)
class SiteSetup:
    """One EMG site as the config declared it."""

    name: str
    channel: int
    gain: float
    threshold: float  # V after gain
    maximum: float  # V after gain


@dataclass(frozen=True, slots=True)
class Setup:
    """The parts of a config that figures and tables need; what it does not say is empty or 0."""

    emg_rate_hz: float = 0.0
    window: int = 10  # samples
    sites: tuple[SiteSetup, ...] = ()
    predicting: tuple[str, ...] = ()  # joints that predictions are made from
    assist_timescale: float = 0.0  # steps
    assist_group: str = ""


def setup(config: str) -> Setup:
    """The setup in the text of a config file; an empty one if that is not TOML."""
    try:
        data = tomllib.loads(config)
    except tomllib.TOMLDecodeError:
        return Setup()
    emg, learn, assist = _table(data, "emg"), _table(data, "learn"), _table(data, "assist")
    return Setup(
        _number(emg, "rate_hz", 200.0 if emg else 0.0),
        int(_number(emg, "window", 10)),
        tuple(_site(site) for site in _list(emg, "sites") if isinstance(site, dict)),
        tuple(str(name) for name in _list(learn, "joints")),
        _number(assist, "timescale", 20.0 if assist else 0.0),
        str(assist.get("group", "")),
    )


def _site(site: Mapping[str, Value]) -> SiteSetup:
    return SiteSetup(
        str(site.get("name", "")),
        int(_number(site, "channel", 0)),
        _number(site, "gain", 1.0),
        _number(site, "threshold_v", 0.0),
        _number(site, "max_v", 0.0),
    )


def _table(data: Mapping[str, Value], key: str) -> Mapping[str, Value]:
    value = data.get(key)
    return value if isinstance(value, dict) else {}


def _list(data: Mapping[str, Value], key: str) -> Sequence[Value]:
    value = data.get(key)
    return value if isinstance(value, list) else []


def _number(data: Mapping[str, Value], key: str, default: float) -> float:
    value = data.get(key, default)
    return float(value) if isinstance(value, int | float) else default
