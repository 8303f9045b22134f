"""Where config files are, and how the command line reads them."""

from pathlib import Path

from bentod import registry
from bentod.config import Config
from bentod.config_file import Overrides, load
from bentod.config_tables import Chosen
from bentod.errors import ConfigError
from bentod.shipped import folders

DEFAULT = "sim.toml"
"""What runs when nobody says: the simulated arm."""


def read(path: Path | None, emg: str = "", port: str = "", record: bool | None = None) -> Config:
    """The config at `path`, or the shipped one of that name.

    `emg`, e.g. "replay:FILE", replaces its EMG source, `port` its driver's port, `record` whether it records.

    Raises:
        ConfigError: there is no such file, or it has mistakes; one line for each.
    """
    overrides = Overrides(parse_source(emg) if emg else None, port, record)
    return load(find(path or Path(DEFAULT)), registry, overrides)


def find(path: Path) -> Path:
    """`path` itself, or the shipped config that it names. Raises ConfigError: neither exists."""
    shipped = [folder / path.name for folder in folders()]
    candidates = [path, *(shipped if path.name == str(path) else [])]
    for candidate in candidates:
        if candidate.is_file():
            return candidate
    names = sorted({p.name for folder in folders() for p in folder.glob("*.toml")})
    raise ConfigError(f"there is no config file {path} (shipped: {', '.join(names)})")


def parse_source(text: str) -> Chosen:
    """An EMG source from the command line: "NAME", "replay:FILE" or "replay:FILE#ARRAY".

    Raises:
        ConfigError: there is no such source.
    """
    name, _, rest = text.partition(":")
    file, _, array = rest.partition("#")
    registry.emg_model(name)
    return Chosen.model_validate(
        {"name": name} | ({"file": file} if file else {}) | ({"array": array} if array else {})
    )
