"""The tables of the config: keys, units and bounds. What joins them is in `bentod.config`."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Literal, Self, TypeAlias, cast

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, JsonValue, model_validator

from bentod.config_base import Name, Table
from bentod.config_conditioning import Filter, Leads, beyond
from bentod.config_recognition import Recognition
from bentod.config_sites import Pair, SingleSite, Site
from bentod.frames import Bounds, JointSpec, Value
from bentod.hosts import is_this_machine

Angle: TypeAlias = Annotated[float, Field(ge=-6.3, le=6.3)]
Options: TypeAlias = dict[str, JsonValue]


class Chosen(BaseModel):
    """A table whose `name` chooses a factory of the registry; its other keys are the factory's own."""

    model_config = ConfigDict(extra="allow", frozen=True)

    name: Annotated[str, Field(pattern=r"^[a-z][a-z0-9_-]{0,31}$")]

    @property
    def options(self) -> Mapping[str, Value]:
        """The keys besides `name`."""
        return dict(self.model_extra or {})


class JointLimits(Table):
    """What a joint may do besides its position and velocity; see `Bounds`."""

    max_acceleration_rad_s2: Annotated[float, Field(gt=0, le=1000)] = Bounds.acceleration
    soft_zone_rad: Annotated[float, Field(ge=0, le=1)] = Bounds.soft_zone
    max_load: Annotated[float, Field(gt=0, le=1)] = Bounds.load
    warm_c: Annotated[float, Field(ge=20, le=100)] = Bounds.warm
    hot_c: Annotated[float, Field(ge=20, le=100)] = Bounds.hot

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if not self.warm_c < self.hot_c:
            raise ValueError(f"warm_c = {self.warm_c} must be below hot_c = {self.hot_c}")
        return self

    def bounds(self) -> Bounds:
        """The limits as controllers see them."""
        return Bounds(
            self.max_acceleration_rad_s2, self.soft_zone_rad, self.max_load, self.warm_c, self.hot_c
        )


class Joint(Table):
    """One joint: limits, speed, home, its driver (the default without), and the driver's own `hardware`."""

    name: Name
    min_rad: Angle
    max_rad: Angle
    max_velocity_rad_s: Annotated[float, Field(gt=0, le=10)]
    home_rad: Angle = 0.0
    driver: Name | None = None
    limits: JointLimits = JointLimits()
    hardware: Options = Field(default_factory=dict)

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if not self.min_rad < self.max_rad:
            raise ValueError(f"min_rad = {self.min_rad} must be below max_rad = {self.max_rad}")
        if not self.min_rad <= self.home_rad <= self.max_rad:
            raise ValueError(f"home_rad = {self.home_rad} is outside {self.min_rad} .. {self.max_rad}")
        return self

    def spec(self) -> JointSpec:
        """The joint as drivers and controllers see it."""
        hardware = cast("Mapping[str, Value]", self.hardware)
        return JointSpec(
            self.name,
            self.min_rad,
            self.max_rad,
            self.max_velocity_rad_s,
            self.home_rad,
            hardware,
            self.limits.bounds(),
        )


class Safety(Table):
    """What the arm does at the edges of its life."""

    start: Literal["limp", "hold", "active"] = "limp"
    exit: Literal["limp", "hold"] = "limp"
    fault: Literal["hold", "limp"] = "hold"
    hold_after_s: Annotated[float, Field(ge=0.01, le=1)] = 0.1
    fault_after_s: Annotated[float, Field(ge=0.05, le=5)] = 0.5
    home_speed_rad_s: Annotated[float, Field(gt=0.012, le=2)] = 0.35
    lease_max_s: Annotated[float, Field(ge=0.05, le=10)] = 2.0

    @model_validator(mode="after")
    def _ladder(self) -> Self:
        if self.fault_after_s < self.hold_after_s:
            raise ValueError(
                f"fault_after_s = {self.fault_after_s} must not be below hold_after_s = {self.hold_after_s}"
            )
        return self


class Group(Table):
    """A list of joints of which one is active (thesis A.1.1)."""

    name: Name
    joints: Annotated[tuple[Name, ...], Field(min_length=1, max_length=32)]


class Emg(Table):
    """Muscle signals and how they become effort."""

    rate_hz: Annotated[float, Field(ge=50, le=10_000)] = 200.0
    window: Annotated[int, Field(ge=1, le=1000)] = 10
    stall_s: Annotated[float, Field(ge=0.01, le=0.1)] = 0.06
    envelope: Literal["mean", "rms", "low_pass"] = "mean"
    """How loud a signal is: over `window` samples, or the rectified signal below `envelope_hz`."""
    envelope_hz: Annotated[float, Field(ge=0.5, le=20)] = 4.0
    filters: Annotated[tuple[Filter, ...], Field(max_length=8)] = ()
    leads: Leads = Leads()
    source: Chosen
    sites: Annotated[tuple[Site, ...], Field(min_length=1, max_length=64)]
    pairs: Annotated[tuple[Pair, ...], Field(max_length=16)] = ()
    single_sites: Annotated[tuple[SingleSite, ...], Field(max_length=16)] = ()
    recognition: Recognition | None = None

    def driven(self) -> tuple[tuple[str, Pair | SingleSite], ...]:
        """What drives groups, each with its place in the file."""
        pairs = ((f"emg.pairs.{i}", pair) for i, pair in enumerate(self.pairs))
        return (*pairs, *((f"emg.single_sites.{i}", one) for i, one in enumerate(self.single_sites)))

    @model_validator(mode="after")
    def _carried(self) -> Self:
        if problems := beyond(self.filters, self.rate_hz):
            raise ValueError("\n".join(problems))
        return self


class Assist(Table):
    """What helps with the joints of a group: a mode of `bentod.registry.ASSISTS`, several with +, or off."""

    mode: Annotated[str, Field(pattern=r"^[a-z][a-z0-9_-]{0,31}(\+[a-z][a-z0-9_-]{0,31}){0,3}$")] = "dpcc"
    group: Name
    timescale: Annotated[float, Field(gt=1, le=10_000)] = 20.0
    k: Annotated[float, Field(gt=0, lt=1)] = 0.025
    velocity_limit_rad_s: Annotated[float, Field(gt=0, le=10)] = 10.0
    manual_after_toggle_s: Annotated[float, Field(ge=0, le=10)] = 0.5
    timescale_by: Literal["fixed", "sarsa", "blend", "state"] = "fixed"
    """Whether the assist follows `timescale`, or one that is found by reward (thesis 6.3): docs/assist.md."""
    toggle_reward: Annotated[float, Field(ge=-10, le=10)] = -1.0
    contact_reward: Annotated[float, Field(ge=-10, le=10)] = -1.0
    options: Mapping[str, Annotated[float, Field(ge=-1e6, le=1e6)]] = {}
    """The mode's own parameters."""


HIGHEST_PRIORITY = 49
"""Linux runs the threads of interrupts at 50 (kernel/irq/manage.c: sched_set_fifo), the arm's port among
them."""


def _below_interrupts(priority: int) -> int:
    if priority > HIGHEST_PRIORITY:
        raise ValueError(
            f"{priority} is above the bound, {HIGHEST_PRIORITY}: interrupts may run at 50, and the port of "
            "the arm must not wait for the tick that waits for it"
        )
    return priority


class Realtime(Table):
    """What the process asks of the operating system, to be on time."""

    priority: Annotated[int, Field(ge=0), AfterValidator(_below_interrupts)] = 0
    """Of SCHED_FIFO, up to `HIGHEST_PRIORITY`; 0 leaves the scheduling as it is."""
    lock_memory: bool = False
    cpus: Annotated[tuple[Annotated[int, Field(ge=0, le=1023)], ...], Field(max_length=64)] = ()
    gc: Literal["slack", "python"] = "slack"
    required: bool = False


GroupOfUsers: TypeAlias = Annotated[str, Field(pattern=r"^[a-z_][a-z0-9_-]{0,31}$")]


class Access(Table):
    """Who may do what on the Unix socket, by Unix group; the daemon's own user and root may do everything."""

    operators: Annotated[tuple[GroupOfUsers, ...], Field(max_length=16)] = ()
    observers: Annotated[tuple[GroupOfUsers, ...], Field(max_length=16)] | None = None
    """None: whoever the permissions of the socket let in."""
    connections_per_user: Annotated[int, Field(ge=1, le=1024)] = 32
    requests_per_s: Annotated[float, Field(ge=50, le=100_000)] = 2000.0


class Tcp(Table):
    """The same API over TCP: off without this table. Who has a token may come in, whoever it is."""

    host: Annotated[str, Field(min_length=1, max_length=253)] = "127.0.0.1"
    port: Annotated[int, Field(ge=1, le=65_535)] = 4776
    certificate: Path | None = None
    key: Path | None = None
    operator_token: Path | None = None
    observer_token: Path | None = None

    @model_validator(mode="after")
    def _closed(self) -> Self:
        problems = []
        if (self.certificate is None) is not (self.key is None):
            problems.append("certificate and key go together: give both or neither")
        elif self.certificate is None and not is_this_machine(self.host):
            problems.append(
                f"host = '{self.host}' can be reached by others, and so needs TLS: give certificate and key, "
                "or choose 127.0.0.1 or ::1"
            )
        if self.operator_token is None and self.observer_token is None:
            problems.append("needs operator_token, observer_token or both: files with what clients must know")
        if problems:
            raise ValueError("\n".join(problems))
        return self


class Record(Table):
    """What is kept of a session, where, and how much of the disk it may take."""

    enabled: bool = True
    folder: Path | None = None
    """Without: $STATE_DIRECTORY/recordings, else bentod/recordings in $XDG_STATE_HOME or ~/.local/state."""
    urdf: Path | None = None
    """The robot's description; a copy goes into every recording."""
    max_file_mb: Annotated[float, Field(ge=1, le=100_000)] = 1000.0
    max_file_min: Annotated[float, Field(ge=1, le=1440)] = 60.0
    max_gb: Annotated[float, Field(gt=0, le=100_000)] = 50.0
    """Of all recordings in the folder together. The recording ends before it is exceeded."""
    min_free_gb: Annotated[float, Field(ge=0, le=100_000)] = 2.0
