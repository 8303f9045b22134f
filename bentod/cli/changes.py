"""What `--set` says: other values for keys of a config, one each or several."""

import json
from collections.abc import Iterable

from bentod.cli.link import parsed
from bentod.errors import ConfigError
from bentod.frames import Value


def single(words: Iterable[str]) -> dict[str, Value]:
    """One value a key, from KEY=VALUE. Raises ConfigError: a word is not of that form."""
    return {key: parsed(text) for key, text in map(_parted, words)}


def grid(words: Iterable[str]) -> dict[str, list[Value]]:
    """Several values a key, from KEY=VALUE,VALUE,…; lists keep their commas: KEY=[10,20],[10,30].

    Raises:
        ConfigError: a word is not of that form, or names a key again.
    """
    found: dict[str, list[Value]] = {}
    for key, text in map(_parted, words):
        if key in found:
            raise ConfigError(f"--set {key}: stands twice; write all its values behind one '='")
        found[key] = _several(text)
    return found


def _parted(word: str) -> tuple[str, str]:
    key, sign, text = word.partition("=")
    if not sign or "." not in key or not text:
        raise ConfigError(f"--set {word}: write TABLE.KEY=VALUE")
    return key, text


def _several(text: str) -> list[Value]:
    try:
        values: list[Value] = json.loads(f"[{text}]")
    except ValueError:
        return [parsed(part) for part in text.split(",")]
    return values
