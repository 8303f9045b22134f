"""What a config may say about a Dynamixel bus and its servos, in SI units."""

import difflib
import math
from collections.abc import Mapping
from typing import Annotated, Literal, TypeAlias, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError
from pydantic_core import ErrorDetails

from bentod.errors import ConfigError
from bentod.frames import JointSpec, Value
from drivers.dynamixel.motion import Tuning
from drivers.dynamixel.stopping import StopRule

Model: TypeAlias = Literal["MX-28", "MX-64", "MX-106"]

FASTEST_ACCELERATION = math.radians(254 * 8.583)
"""rad/s²: the greatest Goal Acceleration, https://emanual.robotis.com/docs/en/dxl/mx/mx-28/#goal-acceleration"""


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)


class Options(_Table):
    """The bus."""

    port: str = Field(min_length=1)
    """Serial port, best by its lasting name under /dev/serial/by-id."""
    baud: int = Field(1_000_000, ge=9_600, le=3_000_000)
    """bit/s, the same for every servo."""
    reply_margin_s: float = Field(0.005, ge=0.0005, le=0.1)
    """Wait for a reply beyond its computed time on the wire; above the adapter's latency timer."""
    lost_after_s: float = Field(0.5, ge=0.02, le=10)
    """A joint that is silent for longer is lost."""
    stop: StopRule = "full"
    """How the resting place of a stop is estimated."""
    bus_time_s: float = Field(0.002, ge=0, le=0.05)
    """From the decision to the arrival of a command at the servo."""
    limit_margin_rad: float = Field(0.05, ge=0, le=0.5)
    """A joint farther outside its limits than this is not switched on."""
    attempts: int = Field(3, ge=1, le=10)
    """How often a question is asked at opening and when torque is switched."""


class Hardware(_Table):
    """One servo."""

    id: int = Field(ge=0, le=252)
    model: Model
    dead_time_s: float = Field(0.017, ge=0, le=0.2)
    """From the arrival of a command to its effect; found by a step test."""
    p_gain: int = Field(32, ge=1, le=254)
    """P gain register, written when torque is switched on."""
    goal_acceleration_rad_s2: Annotated[float, Field(ge=0, le=FASTEST_ACCELERATION)] = 0.0
    """Goal Acceleration, written when torque is switched on; 0: unlimited."""


_T = TypeVar("_T", bound=_Table)


def parse_options(options: Mapping[str, Value]) -> Options:
    """The bus options, checked.

    Raises:
        ConfigError: an unknown key or a value out of bounds.
    """
    return _parse(Options, options, "Dynamixel bus")


def parse_hardware(spec: JointSpec) -> Hardware:
    """The joint's servo, checked.

    Raises:
        ConfigError: an unknown key or a value out of bounds.
    """
    return _parse(Hardware, spec.hardware, f"Servo of joint {spec.name}")


def tuning(options: Options, hardware: Hardware) -> Tuning:
    """What the stop estimate needs to know."""
    return Tuning(
        dead_time_s=hardware.dead_time_s,
        bus_time_s=options.bus_time_s,
        longest_age_s=options.lost_after_s,
        p_gain=hardware.p_gain,
        goal_acceleration=hardware.goal_acceleration_rad_s2,
        rule=options.stop,
    )


def _parse(table: type[_T], values: Mapping[str, Value], what: str) -> _T:
    try:
        return table.model_validate(dict(values))
    except ValidationError as error:
        details = error.errors()
        complaints = "; ".join(_complaint(detail, table) for detail in details)
        field = ".".join(str(part) for part in details[0]["loc"])
        raise ConfigError(f"{what}: {complaints}.", field=field) from None


def _complaint(detail: ErrorDetails, table: type[_Table]) -> str:
    key = ".".join(str(part) for part in detail["loc"])
    if detail["type"] == "missing":
        return f"{key} is missing"
    if detail["type"] != "extra_forbidden":
        return f"{key} is {detail['input']!r}: {detail['msg'].lower()}"
    near = difflib.get_close_matches(key, table.model_fields, n=1)
    return f"{key} is not known" + (f", did you mean {near[0]}?" if near else "")
