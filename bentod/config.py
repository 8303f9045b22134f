"""The config as one value: every table, and what must hold between them. Frozen once read."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Self

from pydantic import Field, model_validator

from bentod.config_base import Name, Table
from bentod.config_joystick import Joystick
from bentod.config_learn import Learn
from bentod.config_tables import (
    Access,
    Assist,
    Chosen,
    Emg,
    Group,
    Joint,
    Realtime,
    Record,
    Safety,
    Tcp,
)
from bentod.config_voice import Voice
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
    joystick: Joystick | None = None
    learn: Learn | None = None
    assist: Assist | None = None
    assists: Annotated[tuple[Assist, ...], Field(max_length=15)] = ()
    """For further groups."""
    voice: Voice = Voice()

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
        for where, table in config.emg.driven():
            uses.append((f"{where}.group", table.group, groups, "group"))
            uses += [(where, name, sites, "site") for name in table.sites()]
    if config.learn:
        uses += [("learn", name, joints, "joint") for name in (*config.learn.joints, *config.learn.predict)]
    for where, assist in config.helped():
        uses.append((f"{where}.group", assist.group, groups, "group"))
    found = [
        f"{where}: there is no {kind} '{name}'" for where, name, known, kind in uses if name not in known
    ]
    found += config.joystick.strangers(joints, groups) if config.joystick else []
    found += _assist_without_learning(config) + _too_slow_to_stop(config) + _fooled(config)
    return found + _unrecognisable(config) + config.voice.misnamed(joints)


def _unrecognisable(config: Config) -> list[str]:
    """Classes that move what is not there, or what sites move already."""
    if config.emg is None or config.emg.recognition is None:
        return []
    groups = {group.name: group.joints for group in config.groups}
    by_sites = {table.group for _, table in config.emg.driven()}
    found = []
    for i, one in enumerate(config.emg.recognition.classes):
        where = f"emg.recognition.classes.{i}"
        if one.group not in groups:
            found.append(f"{where}.group: there is no group '{one.group}'{nearest(one.group, groups)}")
            continue
        if one.group in by_sites:
            found.append(f"{where}.group: sites drive the group '{one.group}' already; leave it to either")
        found += [
            f"{where}.moves: {one.group} has no joint '{joint}'{nearest(joint, groups[one.group])}"
            for joint in one.moves
            if joint not in groups[one.group]
        ]
    return found


def _too_slow_to_stop(config: Config) -> list[str]:
    """A source that dies is noticed after `stall_s`, and stopped for at the next tick: 100 ms in all."""
    if config.emg is None or config.emg.stall_s + 1 / config.rate_hz <= STOPPED_AFTER + 1e-9:
        return []
    late = (config.emg.stall_s + 1 / config.rate_hz) * 1e3
    return [
        f"emg.stall_s = {config.emg.stall_s:g} at rate_hz = {config.rate_hz:g}: muscles that die would "
        f"move the arm for up to {late:.0f} ms; the bound is {STOPPED_AFTER * 1e3:.0f} ms"
    ]


def _fooled(config: Config) -> list[str]:
    """Toggles that one bad sample could make: it is heard for as long as the envelope remembers."""
    if config.emg is None:
        return []
    emg = config.emg
    window = 1 / emg.envelope_hz if emg.envelope == "low_pass" else emg.window / emg.rate_hz
    bounds = [
        (f"emg.pairs.{i}.{key}", value)
        for i, pair in enumerate(emg.pairs)
        for key, value in pair.shortest().items()
    ]
    return [
        f"{where} = {value:g}: must be above the memory of the envelope, {window:g} s, or one bad sample "
        "may toggle"
        for where, value in bounds
        if not value > window
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
