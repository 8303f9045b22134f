"""What a config may say about a Dynamixel bus and its servos, in SI units."""

import difflib
from collections.abc import Mapping
from typing import Literal, Self, TypeAlias, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator
from pydantic_core import ErrorDetails

from bentod.errors import ConfigError
from bentod.frames import JointSpec, Value
from drivers.dynamixel import deadman
from drivers.dynamixel.stopping import StopRule
from drivers.dynamixel.tables import MODELS, ServoModel
from drivers.dynamixel.tuning import Tuning

Model: TypeAlias = Literal[
    "AX-12A", "MX-28", "MX-64", "MX-106", "MX-28(2.0)", "MX-64(2.0)", "MX-106(2.0)"
]  # fmt: skip

PIN_STEPS = 5
"""Steps of speed at which a joint is pinned where it is; brachIOplexus does it so."""


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)


class Options(_Table):
    """The bus."""

    port: str = Field(min_length=1)
    """Serial port, best by its lasting name under /dev/serial/by-id."""
    baud: int = Field(1_000_000, ge=9_600, le=4_500_000)
    """bit/s, the same for every servo."""
    reply_margin_s: float = Field(0.005, ge=0.0005, le=0.1)
    """Wait for a reply beyond its computed time on the wire; above the adapter's latency timer."""
    lost_after_s: float = Field(0.5, ge=0.02, le=10)
    """A joint that is silent for longer is lost."""
    stop: StopRule = "full"
    """How the resting place of a stop is estimated."""
    stop_learning: bool = True
    """Whether the dead times that stops count with are corrected by what the joints do."""
    dead_man_s: float | None = Field(None, ge=0, le=2.5)
    """Joints come to rest this long after the last order, should the daemon die; 0: they go on to the end.
    By default 0.3 s, or as much more as the rate of the ticks needs."""
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
    """With "(2.0)": its firmware is for protocol 2.0."""
    dead_time_s: float = Field(0.017, ge=0, le=0.2)
    """From the arrival of a command to its effect; found by a step test."""
    p_gain: int = Field(32, ge=1, le=16383)
    """P Gain or Position P Gain register, written when torque is switched on; by default the manual's."""
    goal_acceleration_rad_s2: float = Field(0.0, ge=0)
    """Goal or Profile Acceleration, written when torque is switched on; 0: unlimited."""
    stop: StopRule | None = None
    """How a stop of this joint is estimated, if not as the bus says."""

    @model_validator(mode="before")
    @classmethod
    def _know_the_default_gain(cls, values: dict[str, Value]) -> dict[str, Value]:
        model = values.get("model")
        known = MODELS.get(model) if isinstance(model, str) else None
        return {"p_gain": known.gain, **values} if known else values

    @model_validator(mode="after")
    def _within_the_models_bounds(self) -> Self:
        model = self.kind
        _bound("p_gain", self.p_gain, model.least_gain, model.greatest_gain, self.model)
        _bound(
            "goal_acceleration_rad_s2",
            self.goal_acceleration_rad_s2,
            0,
            model.greatest_acceleration,
            self.model,
        )
        return self

    @property
    def kind(self) -> ServoModel:
        """The model's tables."""
        return MODELS[self.model]


_T = TypeVar("_T", bound=_Table)


def parse_options(options: Mapping[str, Value]) -> Options:
    """The bus options, checked.

    Raises:
        ConfigError: an unknown key or a value out of bounds.
    """
    return _parse(Options, options, "Dynamixel bus")


def with_dead_man(options: Options, period: float) -> Options:
    """`options` with the dead-man's time that serves for ticks of `period` (s).

    Raises:
        ConfigError: the one in the options is too short.
    """
    return options.model_copy(update={"dead_man_s": deadman.chosen(options.dead_man_s, period)})


def parse_hardware(spec: JointSpec) -> Hardware:
    """The joint's servo, checked.

    Raises:
        ConfigError: an unknown key or a value out of bounds, among them those of its model.
    """
    return _parse(Hardware, spec.hardware, f"Servo of joint {spec.name}")


def tuning(options: Options, hardware: Hardware) -> Tuning:
    """What moving and stopping a joint need to know of it."""
    model = hardware.kind
    return Tuning(
        dead_time_s=hardware.dead_time_s,
        bus_time_s=options.bus_time_s,
        longest_age_s=options.lost_after_s,
        p_gain=hardware.p_gain * model.gain_per_lsb,
        goal_acceleration=hardware.goal_acceleration_rad_s2,
        rule=hardware.stop or options.stop,
        learning=options.stop_learning,
        tick=model.tick,
        slowest=model.speed_step,
        pin_speed=PIN_STEPS * model.speed_step,
        dead_man=deadman.USUAL if options.dead_man_s is None else options.dead_man_s,
    )


def _bound(key: str, value: float, least: float, greatest: float, model: str) -> None:
    if not least <= value <= greatest:
        bound = (
            f"{least:g} to {greatest:.5g}" if greatest > least else f"{greatest:g}, which cannot be changed"
        )
        raise ValueError(f"{key} is {value:g}; of an {model} it is {bound}")


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
    if detail["type"] == "value_error":
        return detail["msg"].removeprefix("Value error, ")
    if detail["type"] != "extra_forbidden":
        return f"{key} is {detail['input']!r}: {detail['msg'].lower()}"
    near = difflib.get_close_matches(key, table.model_fields, n=1)
    return f"{key} is not known" + (f", did you mean {near[0]}?" if near else "")
