"""What a config may say about a simulated arm: what a Dynamixel bus can be told, and physics."""

from collections.abc import Mapping
from typing import Annotated, TypeAlias

from pydantic import Field, ValidationError

from bentod.contracts import ArmConfig
from bentod.errors import ConfigError
from bentod.frames import Value
from drivers.dynamixel.options import Options as BusOptions

Gravity: TypeAlias = Annotated[float, Field(ge=-20, le=20)]
Angle: TypeAlias = Annotated[float, Field(ge=-3.1, le=3.1)]
Limits: TypeAlias = Annotated[list[Angle], Field(min_length=2, max_length=2)]


class Options(BusOptions):
    """The simulated arm."""

    port: str = "simulated"
    """Not used; allowed, so that a config changes between arm and simulation by the driver's name alone."""
    seed: int = 0
    """Of everything random: dead times, noise, glitches."""
    servo_dead_time_s: float = Field(0.017, ge=0, le=0.2)
    """What the simulated servos take; `dead_time_s` of a joint's hardware is what the driver believes."""
    gravity_nm: dict[str, Gravity] = Field(default_factory=dict)
    """By joint: torque when what hangs on it points sideways, pulling towards the minimum at 0 rad.
    A joint that is not named has the Bento Arm's."""
    temperature: float = Field(25.0, ge=-20, le=70)
    """Of the room, degrees Celsius."""
    start_rad: dict[str, Angle] = Field(default_factory=dict)
    """By joint: where it is at the start; a joint that is not named is at home."""
    stand: bool = True
    """Whether it stands on something until a joint is first given torque, as a real arm should: a servo's
    gears do not hold it. Without, it falls from the start."""
    limits_rad: dict[str, Limits] = Field(default_factory=dict)
    """By joint: what its servo holds as its limits; those of a joint that is not named are the config's."""
    usb_latency_s: float = Field(0.001, ge=0, le=0.05)
    """What the USB adapter adds to every reply; 0.016 is what Linux and Windows set unless told."""


def parse_options(config: ArmConfig) -> Options:
    """The options of a simulated arm, checked.

    Raises:
        ConfigError: an unknown key, a value out of bounds, or a joint that the arm does not have.
    """
    try:
        options = Options.model_validate(dict(config.options))
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(str(part) for part in first["loc"])
        raise ConfigError(f"Simulated arm: {key}: {first['msg']}.", field=key) from None
    _check_names(config, "gravity_nm", options.gravity_nm)
    _check_names(config, "start_rad", options.start_rad)
    _check_names(config, "limits_rad", options.limits_rad)
    return options


def bus_options(options: Options) -> dict[str, Value]:
    """What of `options` the Dynamixel driver understands."""
    values: dict[str, Value] = options.model_dump(include=set(BusOptions.model_fields))
    return values


def _check_names(config: ArmConfig, key: str, values: Mapping[str, object]) -> None:
    known = [spec.name for spec in config.joints]
    for name in values:
        if name not in known:
            raise ConfigError(f"Simulated arm: {key}: there is no joint '{name}'.", field=f"{key}.{name}")
