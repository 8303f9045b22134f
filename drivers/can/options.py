"""What a config may say about a CAN bus and the motor controllers on it, in SI units."""

from collections.abc import Mapping
from typing import Annotated, Literal, TypeVar

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError

from bentod.errors import ConfigError
from bentod.frames import JointSpec, Value


class Table(BaseModel):
    """A table of the file: no unknown keys, no infinities, no changes after reading."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)


class Options(Table):
    """The bus."""

    interface: str = Field("socketcan", pattern=r"^[a-z][a-z0-9_]{0,31}$")
    """Any of python-can's. Of them `virtual` and `udp_multicast` were tried, no adapter was."""
    channel: str = Field("can0", min_length=1, max_length=64)
    """Network interface, device or group address, as the interface has it."""
    bitrate: int = Field(500_000, ge=10_000, le=1_000_000)
    """bit/s. On SocketCAN the system sets it: `ip link set can0 up type can bitrate 500000`."""
    udp_port: int = Field(43113, ge=1024, le=65535)
    """Of `udp_multicast`, which is the simulator's bus: its frames do not leave the machine."""
    protocol: Literal["cansimple"] = "cansimple"
    """What the controllers speak."""
    stale_after_s: float = Field(0.025, ge=0.002, le=0.1)
    """A position that is older is not fresh: two and a half of ODrive's cycles of 10 ms."""
    heartbeat_s: float = Field(0.35, ge=0.02, le=1)
    """Silence of the heartbeat after which nothing of a joint is believed: three cycles of 100 ms."""
    lost_after_s: float = Field(0.5, ge=0.02, le=10)
    """A joint that is silent for longer is lost."""
    confirm_s: float = Field(0.35, ge=0.05, le=2)
    """How long a controller may take to confirm that it is armed, disarmed or without error."""
    open_s: float = Field(1.0, ge=0.2, le=10)
    """How long every controller may take to be heard at the start."""
    limit_margin_rad: float = Field(0.05, ge=0, le=0.5)
    """A joint farther outside its limits than this is not switched on."""
    rest_rad_s: float = Field(0.02, gt=0, le=0.5)
    """A joint that was told to stop and is slower than this is held where it is."""


def _not_zero(ratio: float) -> float:
    if abs(ratio) < 0.01:
        raise ValueError("must be at least 0.01, or at most -0.01 for a motor that turns the other way")
    return ratio


class Hardware(Table):
    """One motor controller and its gear."""

    node: int = Field(ge=0, le=62)
    """CAN node; 63 is for controllers that have none yet."""
    gear_ratio: Annotated[float, Field(ge=-10_000, le=10_000), AfterValidator(_not_zero)] = 1.0
    """Turns of the motor for one of the joint; negative if they turn against each other."""
    offset_rad: float = Field(0.0, ge=-6.3, le=6.3)
    """Angle of the joint where the controller counts 0 turns. Needs an encoder that is still right after
    power was off."""
    current_limit_a: float = Field(10.0, gt=0, le=200)
    velocity_limit_rad_s: float | None = Field(None, gt=0, le=100)
    """Of the joint, kept by the controller itself; without it half more than the joint's greatest."""
    acceleration_rad_s2: float = Field(10.0, gt=0, le=1000)
    """Of the joint, towards positions and before limits. A stop brakes as hard as the current allows."""
    bounded: bool = False
    """Run velocities as moves to the joint's limit: what goes on after this program died, without the
    controller's own watchdog, then ends at the limit."""


_T = TypeVar("_T", bound=Table)


def parse_options(options: Mapping[str, Value]) -> Options:
    """The bus options, checked. Raises ConfigError: an unknown key or a value out of bounds."""
    return parse(Options, options, "CAN bus")


def parse_hardware(spec: JointSpec) -> Hardware:
    """The joint's controller, checked. Raises ConfigError: an unknown key or a value out of bounds."""
    return parse(Hardware, spec.hardware, f"Controller of joint {spec.name}")


def parse(table: type[_T], values: Mapping[str, Value], what: str) -> _T:
    """The values as a table; `what` begins the sentence of an error. Raises ConfigError."""
    try:
        return table.model_validate(dict(values))
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(str(part) for part in first["loc"])
        raise ConfigError(f"{what}: {key}: {first['msg']}.", field=key) from None
