"""What EMG sites are set to in the daemon, and how that gets into the config file."""

from collections.abc import Collection, Mapping
from pathlib import Path

from bentod import registry
from bentod.calibration.config_edit import edited_sites, rewritten
from bentod.cli import show
from bentod.cli.configs import find, read
from bentod.config_sites import Site
from bentod.errors import ConfigError, nearest
from bentod.frames import Value

FIXED = frozenset({"name", "channel"})
"""What a site is, and not what it is set to."""


def keep(file: Path, described: Value, only: Collection[str] | None = None) -> list[str]:
    """Write to a config file what `emg_get` tells of its sites; returns what changed, in sentences.

    `only`: of these sites. Comments and everything else stay, and the old file is kept beside the new one.

    Raises:
        ConfigError: the file is not of this arm's sites, cannot be written, or would not load any more.
    """
    path = find(file)
    config = read(path)
    kept = {site.name: site for site in (config.emg.sites if config.emg else ())}
    changes: dict[str, dict[str, float]] = {}
    for table in map(show.fields, show.entries(show.fields(described).get("sites"))):
        name = str(table["name"])
        if only is None or name in only:
            changes[name] = _changes(path, table, kept)
    lines = [
        f"{path}: {name}: {key} = {value:g} (was {getattr(kept[name], key):g})"
        for name, values in changes.items()
        for key, value in values.items()
    ]
    if not lines:
        return [f"{path}: nothing to change"]
    backup = rewritten(path, lambda text: edited_sites(text, changes), registry)
    return [*lines, f"The file as it was: {backup}"]


def _changes(path: Path, table: Mapping[str, Value], kept: Mapping[str, Site]) -> dict[str, float]:
    """What the file says otherwise of a site. Raises ConfigError: it is not that site."""
    name = str(table["name"])
    if name not in kept:
        raise ConfigError(f"{path}: there is no EMG site '{name}'{nearest(name, kept)}; is it another arm's?")
    here, there = kept[name].channel, show.word(table["channel"])
    if str(here) != there:
        raise ConfigError(
            f"{path}: {name} is on channel {here}, the daemon's is on {there}; is it another arm's?"
        )
    return {
        key: float(value)
        for key, value in table.items()
        if key in Site.model_fields and key not in FIXED and isinstance(value, int | float)
        if value != getattr(kept[name], key)
    }
