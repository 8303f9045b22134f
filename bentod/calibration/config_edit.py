"""Changes a joint's hardware keys in a config file and leaves everything else in it as it was typed."""

import os
import tempfile
from collections.abc import Mapping
from pathlib import Path

import tomlkit
from tomlkit.exceptions import TOMLKitError
from tomlkit.items import AoT, InlineTable, Item, Table

from bentod.config_file import OptionModels, parse
from bentod.errors import ConfigError


def edited(text: str, joint: str, values: Mapping[str, float]) -> str:
    """The config `text` with `values` in the `hardware` of a joint.

    Raises:
        ConfigError: it is not TOML, or has no such joint.
    """
    try:
        document = tomlkit.parse(text)
    except TOMLKitError as error:
        raise ConfigError(f"not valid TOML: {error}") from error
    hardware = _hardware(document.get("joints"), joint)
    for key, value in values.items():
        hardware[key] = value
    return _tidy(tomlkit.dumps(document), hardware)


def rewrite(path: Path, joint: str, values: Mapping[str, float], models: OptionModels) -> Path:
    """Edit the file at `path`, if the result is a config that loads; returns where the old one is kept.

    Raises:
        ConfigError: it cannot be read or written, or what it would become is not a valid config.
    """
    try:
        text = path.read_text(encoding="utf-8")
        changed = edited(text, joint, values)
        parse(changed, str(path), models)
        backup = path.with_name(f"{path.name}.bak")
        _replace(backup, text, path)
        _replace(path, changed, path)
    except OSError as error:
        raise ConfigError(f"{path}: cannot be changed: {error.strerror}") from error
    return backup


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
    mode = like.stat().st_mode
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    try:
        with os.fdopen(handle, "w", encoding="utf-8") as file:
            file.write(text)
            file.flush()
            os.fsync(file.fileno())
        os.chmod(name, mode)
        os.replace(name, path)
    except BaseException:
        os.unlink(name)
        raise
