"""What a config may say about a simulated CAN bus: what a real one can be told, and physics."""

from collections.abc import Mapping
from typing import Annotated, TypeAlias

from pydantic import Field

from bentod.contracts import ArmConfig
from bentod.errors import ConfigError
from bentod.frames import Value
from drivers.can.options import Options as BusOptions
from drivers.can.options import parse

Gravity: TypeAlias = Annotated[float, Field(ge=-20, le=20)]
Start: TypeAlias = Annotated[float, Field(ge=-6.2, le=6.2)]


class Options(BusOptions):
    """The simulated axes.

    `interface` and `channel` are allowed and not used: a config changes between arm and simulation by the
    driver's name alone.
    """

    seed: int = 0
    """Of everything random: which frames are lost."""
    watchdog_s: float = Field(0.5, ge=0, le=10)
    """What stands in each axis' `watchdog_timeout`; 0: it is not enabled."""
    gravity_nm: dict[str, Gravity] = Field(default_factory=dict)
    """By joint: torque when what hangs on it points sideways, pulling towards the minimum at 0 rad.
    A joint that is not named has the Bento Arm's."""
    temperature: float = Field(25.0, ge=-20, le=70)
    """Of the room, degrees Celsius."""
    start_rad: dict[str, Start] = Field(default_factory=dict)
    """By joint: where it is at the start; a joint that is not named is at home."""


def parse_options(config: ArmConfig) -> Options:
    """The options of simulated axes, checked.

    Raises:
        ConfigError: an unknown key, a value out of bounds, or a joint that is not on this bus.
    """
    options = parse(Options, config.options, "Simulated CAN bus")
    _check_names(config, "gravity_nm", options.gravity_nm)
    _check_names(config, "start_rad", options.start_rad)
    return options


def bus_options(options: Options) -> dict[str, Value]:
    """What of `options` the driver understands."""
    values: dict[str, Value] = options.model_dump(include=set(BusOptions.model_fields))
    return values


def _check_names(config: ArmConfig, key: str, values: Mapping[str, float]) -> None:
    known = [spec.name for spec in config.joints]
    for name in values:
        if name not in known:
            raise ConfigError(f"Simulated CAN bus: {key}: no joint '{name}' is on it.", f"{key}.{name}")
