"""Changes keys of a joint or of EMG sites in a config file, and leaves all else in it as it was typed."""

import stat
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import tomlkit
from tomlkit import TOMLDocument
from tomlkit.exceptions import TOMLKitError
from tomlkit.items import AoT, InlineTable, Item, Table

from bentod.config_file import OptionModels, parse
from bentod.config_sites import BRACHIOPLEXUS, Site
from bentod.errors import ConfigError
from bentod.whole_file import replacing


def edited(text: str, joint: str, values: Mapping[str, float]) -> str:
    """The config `text` with `values` in the `hardware` of a joint.

    Raises:
        ConfigError: it is not TOML, or has no such joint.
    """
    document = _parsed(text)
    hardware = _hardware(document.get("joints"), joint)
    for key, value in values.items():
        hardware[key] = value
    return _tidy(tomlkit.dumps(document), hardware)


def edited_sites(text: str, sites: Mapping[str, Mapping[str, float]]) -> str:
    """The config `text` with these values in the tables of EMG sites, by name; what is so already stays.

    Raises:
        ConfigError: it is not TOML, or has no such site.
    """
    document = _parsed(text)
    emg = document.get("emg")
    listed = emg.get("sites") if isinstance(emg, Mapping) else None
    rows = listed if isinstance(listed, Sequence) and not isinstance(listed, str) else ()
    tables = {str(one.get("name")): one for one in rows if isinstance(one, Table | InlineTable)}
    for name, values in sites.items():
        if name not in tables:
            raise ConfigError(f"there is no [[emg.sites]] table of the name '{name}'")
        _put(tables[name], values)
    text = tomlkit.dumps(document)
    for table in tables.values():
        text = _tidy(text, table)
    return text


def _put(site: Table | InlineTable, values: Mapping[str, float]) -> None:
    """Into a table that may call its keys as users of brachIOplexus do."""
    for key, value in values.items():
        spelt = next((other for other, ours in BRACHIOPLEXUS.items() if ours == key and other in site), key)
        if site.get(spelt, Site.model_fields[key].default) != value:
            site[spelt] = value


def rewrite(path: Path, joint: str, values: Mapping[str, float], models: OptionModels) -> Path:
    """Edit a joint in the file at `path`; returns where the old one is kept. Raises as `rewritten` does."""
    return rewritten(path, lambda text: edited(text, joint, values), models)


def rewritten(path: Path, edit: Callable[[str], str], models: OptionModels) -> Path:
    """Edit the file at `path`, if the result is a config that loads; returns where the old one is kept.

    Raises:
        ConfigError: it cannot be read or written, or what it would become is not a valid config.
    """
    try:
        text = path.read_text(encoding="utf-8")
        changed = edit(text)
        parse(changed, str(path), models)
        backup = path.with_name(f"{path.name}.bak")
        _replace(backup, text, path)
        _replace(path, changed, path)
    except OSError as error:
        raise ConfigError(f"{path}: cannot be changed: {error.strerror}") from error
    return backup


def _parsed(text: str) -> TOMLDocument:
    try:
        return tomlkit.parse(text)
    except TOMLKitError as error:
        raise ConfigError(f"not valid TOML: {error}") from error


def _hardware(joints: Item | None, name: str) -> Table | InlineTable:
    for joint in joints if isinstance(joints, AoT) else []:
        if joint.get("name") == name:
            found = joint.setdefault("hardware", tomlkit.inline_table())
            if isinstance(found, Table | InlineTable):
                return found
    raise ConfigError(f"there is no [[joints]] table of the name '{name}'")


def _tidy(text: str, hardware: Table | InlineTable) -> str:
    """With the space before the closing brace that tomlkit drops from an inline table when it appends."""
    written = hardware.as_string()
    if not isinstance(hardware, InlineTable) or not written.startswith("{ ") or written.endswith(" }"):
        return text
    return text.replace(written, f"{written[:-1].rstrip()} }}", 1)


def _replace(path: Path, text: str, like: Path) -> None:
    """Write a whole file or nothing, with the permissions of another: the power may fail at any time."""
    with replacing(path, stat.S_IMODE(like.stat().st_mode)) as file:
        file.write(text.encode())
