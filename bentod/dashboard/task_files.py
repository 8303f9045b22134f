"""The tasks that there are: those that come with bentod, and the user's own."""

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from bentod.errors import ConfigError
from bentod.shipped import folders
from bentod.tasks.tables import parse
from bentod.tasks.task import Task

LONGEST = 100_000
"""Bytes of a file that can be a task."""


@dataclass(frozen=True, slots=True)
class Shelf:
    """What was found."""

    tasks: Mapping[str, Task]  # by name: that of the file
    problems: tuple[str, ...]  # one line for each mistake in a file, which is then left out


def own_folder() -> Path:
    """Where users keep their own: in $XDG_CONFIG_HOME, else in ~/.config."""
    base = os.environ.get("XDG_CONFIG_HOME") or Path.home() / ".config"
    return Path(base, "bentod", "tasks")


def read_shelf() -> Shelf:
    """Every task, as its file is now; one of the user's own takes the place of a shipped one of that name."""
    shipped = next((folder / "tasks" for folder in folders() if (folder / "tasks").is_dir()), None)
    found: dict[str, Path] = {}
    for folder in filter(None, (shipped, own_folder())):
        found |= {path.stem: path for path in sorted(folder.glob("*.toml"))}
    tasks: dict[str, Task] = {}
    problems: list[str] = []
    for name, path in found.items():
        try:
            tasks[name] = read_task(path)
        except ConfigError as error:
            problems += str(error).splitlines()
    return Shelf(tasks, tuple(problems))


def read_task(path: Path) -> Task:
    """The task in a file, with the file's name. Raises ConfigError: one line for every mistake."""
    try:
        with path.open("rb") as file:
            content = file.read(LONGEST + 1)
        if len(content) > LONGEST:
            raise ConfigError(f"{path}: it is longer than {LONGEST} bytes, and so no task")
        return parse(content.decode(), path.stem[:32], str(path))
    except (OSError, UnicodeDecodeError) as error:
        raise ConfigError(f"{path}: cannot be read: {error}") from error
