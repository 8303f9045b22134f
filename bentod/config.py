"""The config as values: tables, keys, units and bounds. Frozen once read."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal, Self, TypeAlias, cast

from pydantic import BaseModel, ConfigDict, Field, JsonValue, model_validator

from bentod.errors import nearest
from bentod.frames import JointSpec, Value

STOPPED_AFTER = 0.1
"""s after the last sample of a source that died, when the arm must have been told to stop."""

Name: TypeAlias = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]{0,31}$")]
Angle: TypeAlias = Annotated[float, Field(ge=-6.3, le=6.3)]
Options: TypeAlias = dict[str, JsonValue]


class Table(BaseModel):
    """A table of the file: no unknown keys, no infinities, no changes after reading."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class Chosen(BaseModel):
    """A table whose `name` chooses a factory of the registry; its other keys are the factory's own."""

    model_config = ConfigDict(extra="allow", frozen=True)

    name: Annotated[str, Field(pattern=r"^[a-z][a-z0-9_-]{0,31}$")]

    @property
    def options(self) -> Mapping[str, Value]:
        """The keys besides `name`."""
        return dict(self.model_extra or {})


class Joint(Table):
    """One joint: limits, speed, home, its driver (the default without), and the driver's own `hardware`."""

    name: Name
    min_rad: Angle
    max_rad: Angle
    max_velocity_rad_s: Annotated[float, Field(gt=0, le=10)]
    home_rad: Angle = 0.0
    driver: Name | None = None
    hardware: Options = {}

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
            self.name, self.min_rad, self.max_rad, self.max_velocity_rad_s, self.home_rad, hardware
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


class Site(Table):
    """One EMG site (thesis A.1.2): effort is 0 at the threshold and 1 at the maximum."""

    name: Name
    channel: Annotated[int, Field(ge=0, le=255)]
    gain: Annotated[float, Field(gt=0, le=1e6)] = 1.0
    threshold_v: Annotated[float, Field(ge=0, le=10)]
    max_v: Annotated[float, Field(gt=0, le=10)]

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if not self.threshold_v < self.max_v:
            raise ValueError(f"threshold_v = {self.threshold_v} must be below max_v = {self.max_v}")
        return self


class Pair(Table):
    """Two sites that drive one group, and a third that toggles it."""

    group: Name
    positive: Name
    negative: Name
    toggle: Name | None = None


class Emg(Table):
    """Muscle signals and how they become effort."""

    rate_hz: Annotated[float, Field(ge=50, le=10_000)] = 200.0
    window: Annotated[int, Field(ge=1, le=1000)] = 10
    stall_s: Annotated[float, Field(ge=0.01, le=0.1)] = 0.06
    source: Chosen
    sites: Annotated[tuple[Site, ...], Field(min_length=1, max_length=64)]
    pairs: Annotated[tuple[Pair, ...], Field(max_length=16)] = ()


class Learn(Table):
    """What is predicted and how it is learned (thesis 5.3)."""

    joints: Annotated[tuple[Name, ...], Field(min_length=1, max_length=8)]
    predict: tuple[Name, ...] = ()
    timescales: Annotated[tuple[Annotated[float, Field(gt=1, le=10_000)], ...], Field(min_length=1)] = (20.0,)
    tilings: Annotated[int, Field(ge=1, le=1024)] = 100
    memory: Annotated[int, Field(ge=16, le=1 << 20)] = 2048
    trace_decay: Annotated[float, Field(ge=0, lt=1)] = 0.99
    trace_lambda: Annotated[float, Field(ge=0, le=1)] = 0.95
    step_size: Annotated[float, Field(gt=0, le=1)] = 0.3


class Assist(Table):
    """Direct Predictive Collaborative Control (thesis 5.3)."""

    mode: Literal["off", "dpcc"] = "dpcc"
    group: Name
    timescale: Annotated[float, Field(gt=1, le=10_000)] = 20.0
    k: Annotated[float, Field(gt=0, lt=1)] = 0.025
    velocity_limit_rad_s: Annotated[float, Field(gt=0, le=10)] = 10.0
    manual_after_toggle_s: Annotated[float, Field(ge=0, le=10)] = 0.5


@dataclass(frozen=True, slots=True)
class Share:
    """One driver, and which joints are on it."""

    key: str  # what joints call it; "" for the default
    driver: Chosen
    joints: tuple[int, ...]  # indices, in the order of the file

    @property
    def place(self) -> str:
        """Its table in the file."""
        return f"drivers.{self.key}" if self.key else "driver"


class Config(Table):
    """The whole file."""

    arm: Annotated[str, Field(min_length=1, max_length=64)]
    rate_hz: Annotated[float, Field(ge=10, le=500)] = 30.0
    socket: Path | None = None
    driver: Chosen | None = None
    drivers: Annotated[dict[Name, Chosen], Field(max_length=16)] = {}
    safety: Safety = Safety()
    joints: Annotated[tuple[Joint, ...], Field(min_length=1, max_length=32)]
    groups: Annotated[tuple[Group, ...], Field(max_length=16)] = ()
    emg: Emg | None = None
    learn: Learn | None = None
    assist: Assist | None = None

    @model_validator(mode="after")
    def _names_exist(self) -> Self:
        problems = [*_duplicates(self), *_drivers(self), *_dangling(self)]
        if problems:
            raise ValueError("\n".join(problems))
        return self

    def shares(self) -> tuple[Share, ...]:
        """The drivers that have joints, the default first."""
        tables = {**({"": self.driver} if self.driver else {}), **self.drivers}
        joints = {
            key: tuple(i for i, j in enumerate(self.joints) if (j.driver or "") == key) for key in tables
        }
        return tuple(Share(key, tables[key], indices) for key, indices in joints.items() if indices)


def _duplicates(config: Config) -> list[str]:
    """Names that stand twice in one list."""
    lists = {
        "joints": [joint.name for joint in config.joints],
        "groups": [group.name for group in config.groups],
        "emg.sites": [site.name for site in config.emg.sites] if config.emg else [],
    }
    return [
        f"{where}: the name '{name}' stands {names.count(name)} times"
        for where, names in lists.items()
        for name in sorted(set(names))
        if names.count(name) > 1
    ]


def _drivers(config: Config) -> list[str]:
    """Joints without a driver, and drivers without a joint."""
    named = {joint.driver for joint in config.joints}
    problems = [
        f"joints.{i}.driver: there is no [drivers.{joint.driver}]{nearest(joint.driver, config.drivers)}"
        for i, joint in enumerate(config.joints)
        if joint.driver is not None and joint.driver not in config.drivers
    ]
    if config.driver is None and None in named:
        problems.append("driver: is missing, and not every joint names another")
    if config.driver is not None and None not in named:
        problems.append("driver: no joint is on it")
    return problems + [f"drivers.{key}: no joint is on it" for key in config.drivers if key not in named]


def _dangling(config: Config) -> list[str]:
    """References to joints, groups or sites that do not exist."""
    joints = [joint.name for joint in config.joints]
    groups = [group.name for group in config.groups]
    uses = [(f"groups.{g.name}.joints", name, joints, "joint") for g in config.groups for name in g.joints]
    if config.emg:
        sites = [site.name for site in config.emg.sites]
        for i, pair in enumerate(config.emg.pairs):
            uses.append((f"emg.pairs.{i}.group", pair.group, groups, "group"))
            named = [pair.positive, pair.negative, *([pair.toggle] if pair.toggle else [])]
            uses += [(f"emg.pairs.{i}", name, sites, "site") for name in named]
    if config.learn:
        uses += [("learn", name, joints, "joint") for name in (*config.learn.joints, *config.learn.predict)]
    if config.assist:
        uses.append(("assist.group", config.assist.group, groups, "group"))
    found = [
        f"{where}: there is no {kind} '{name}'" for where, name, known, kind in uses if name not in known
    ]
    return found + _assist_without_learning(config) + _too_slow_to_stop(config)


def _too_slow_to_stop(config: Config) -> list[str]:
    """A source that dies is noticed after `stall_s`, and stopped for at the next tick: 100 ms in all."""
    if config.emg is None or config.emg.stall_s + 1 / config.rate_hz <= STOPPED_AFTER + 1e-9:
        return []
    late = (config.emg.stall_s + 1 / config.rate_hz) * 1e3
    return [
        f"emg.stall_s = {config.emg.stall_s:g} at rate_hz = {config.rate_hz:g}: muscles that die would "
        f"move the arm for up to {late:.0f} ms; the bound is {STOPPED_AFTER * 1e3:.0f} ms"
    ]


def _assist_without_learning(config: Config) -> list[str]:
    if config.assist is None or config.assist.mode == "off":
        return []
    if config.learn is None:
        return ["assist: needs a [learn] table, whose predictions it follows"]
    if config.assist.timescale not in config.learn.timescales:
        known = ", ".join(f"{t:g}" for t in config.learn.timescales)
        return [f"assist.timescale = {config.assist.timescale:g} is not among learn.timescales ({known})"]
    return []
