"""The config that a session was recorded with, and others that are to be tried in its place."""

import logging
import tomllib
from collections.abc import Collection, Mapping
from typing import TypeAlias

import tomlkit
from tomlkit.exceptions import TOMLKitError

from bentod import registry
from bentod.config import Config
from bentod.config_file import parse
from bentod.errors import ConfigError, SnapshotError, nearest
from bentod.frames import Value
from bentod.learn.snapshot import parsed
from bentod.record.session import Header
from bentod.replay.relearn import Relearner
from bentod.replay.stage import explained

_log = logging.getLogger(__name__)

Changes: TypeAlias = Mapping[str, Value]
"""Values by key, e.g. {"learn.step_size": 0.1}; an entry of a list has its name or its number for a key."""


def altered(header: Header, changes: Changes) -> Config:
    """The recording's own config, with what is to be tried in its place.

    Raises:
        ConfigError: this version cannot use it, or a change is wrong.
    """
    tables = tomllib.loads(header.config)
    for key, value in changes.items():
        _put(tables, key, value)
    try:
        return parse(_text(tables), "the recording's config", registry)
    except ConfigError as error:
        raise ConfigError(explained(error, header.config_name)) from error


def relearner(header: Header, changes: Changes) -> Relearner:
    """Who learns again from the recording, beginning with what its session began with, if that still fits.

    Raises:
        ConfigError: as `altered` does.
    """
    found = Relearner(altered(header, changes), kept(changes))
    if header.learned and found.learners:
        try:
            parsed(header.learned).give(found.learners)
        except SnapshotError as error:
            _log.warning("What the session began with does not fit, so nothing is known at first: %s.", error)
    return found


def kept(changes: Collection[str]) -> list[str]:
    """Of the changed keys those of the assist, whose recorded changes must not undo them."""
    return [key.partition(".")[2] for key in changes if key.startswith("assist.")]


def _put(tables: dict[str, Value], key: str, value: Value) -> None:
    *path, last = key.split(".")
    place: Value = tables
    for name in path:
        place = _inside(place, name, key)
    if not isinstance(place, dict) or not path:
        raise ConfigError(f"{key}: a change is of the form TABLE.KEY=VALUE")
    place[last] = value


def _inside(place: Value, name: str, key: str) -> Value:
    if isinstance(place, dict):
        return place.setdefault(name, {})
    if not isinstance(place, list):
        raise ConfigError(f"{key}: there is no table above '{name}'")
    if name.isdecimal() and int(name) < len(place):
        return place[int(name)]
    named = {str(table.get("name")): table for table in place if isinstance(table, dict)}
    if name not in named:
        raise ConfigError(f"{key}: there is no '{name}'{nearest(name, named)}")
    return named[name]


def _text(tables: dict[str, Value]) -> str:
    try:
        return tomlkit.dumps(tables)
    except (TOMLKitError, TypeError, ValueError) as error:
        raise ConfigError(f"a config cannot hold this value: {error}") from error
