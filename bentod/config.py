"""The config as one value: every table, and what must hold between them. Frozen once read."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Self

from pydantic import Field, model_validator

from bentod.config_learn import Learn
from bentod.config_tables import (
    Access,
    Assist,
    Chosen,
    Emg,
    Group,
    Joint,
    Name,
    Realtime,
    Record,
    Safety,
    Table,
    Tcp,
)
from bentod.errors import nearest

STOPPED_AFTER = 0.1
"""s after the last sample of a source that died, when the arm must have been told to stop."""


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
    rate_hz: Annotated[float, Field(ge=10, le=1000)] = 30.0
    socket: Path | None = None
    driver: Chosen | None = None
    drivers: dict[Name, Chosen] = Field(default_factory=dict, max_length=16)
    safety: Safety = Safety()
    realtime: Realtime = Realtime()
    access: Access = Access()
    tcp: Tcp | None = None
    record: Record = Record()
    joints: Annotated[tuple[Joint, ...], Field(min_length=1, max_length=32)]
    groups: Annotated[tuple[Group, ...], Field(max_length=16)] = ()
    emg: Emg | None = None
    learn: Learn | None = None
    assist: Assist | None = None
    assists: Annotated[tuple[Assist, ...], Field(max_length=15)] = ()
    """For further groups."""

    @model_validator(mode="after")
    def _names_exist(self) -> Self:
        problems = [*_duplicates(self), *_drivers(self), *_dangling(self)]
        if problems:
            raise ValueError("\n".join(problems))
        return self

    def helped(self) -> tuple[tuple[str, Assist], ...]:
        """The assists, each with its place in the file."""
        first = [("assist", self.assist)] if self.assist else []
        return (*first, *((f"assists.{i}", assist) for i, assist in enumerate(self.assists)))

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
        "assists": [assist.group for _, assist in config.helped()],
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
    for where, assist in config.helped():
        uses.append((f"{where}.group", assist.group, groups, "group"))
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
    helping = [(where, assist) for where, assist in config.helped() if assist.mode != "off"]
    if helping and config.learn is None:
        return [f"{where}: needs a [learn] table, whose predictions it follows" for where, _ in helping]
    timescales = config.learn.timescales if config.learn else ()
    known = ", ".join(f"{t:g}" for t in timescales)
    return [
        f"{where}.timescale = {assist.timescale:g} is not among learn.timescales ({known})"
        for where, assist in helping
        if assist.timescale not in timescales
    ]
