"""Who could put something else in the place of a path: the folders on the way there, looked at one by one."""

import os
import stat
from pathlib import Path

from bentod.errors import ConfigError

MOST_LINKS = 40
"""Symbolic links on one way, as in the kernel."""


def make_folder(folder: Path) -> None:
    """Make `folder`, and those above it that are missing, each for its owner only.

    Raises:
        OSError: it cannot be made.
    """
    missing = [step for step in (folder, *folder.parents) if not os.path.lexists(step)]
    for step in reversed(missing):
        step.mkdir(mode=0o700, exist_ok=True)


def check_private(folder: Path) -> None:
    """Nobody but its owner and root may be able to put a file into `folder`, or another folder in its place.

    In a sticky folder such as /tmp others cannot move what is ours, so it may be on the way there; but it
    is not private itself, because whoever comes first may take the name.

    Raises:
        ConfigError: somebody else could; the sentence says where.
        OSError: a folder cannot be looked at.
    """
    steps = _steps(folder)
    for step in steps:
        found = step.lstat()
        if found.st_uid not in (0, os.geteuid()):
            raise _stranger(folder, f"{step} belongs to user {found.st_uid}, not to us or root")
        _check_mode(folder, step, found.st_mode, last=step == steps[-1])


def _check_mode(folder: Path, step: Path, mode: int, last: bool) -> None:
    if stat.S_ISLNK(mode) or not mode & (stat.S_IWGRP | stat.S_IWOTH):
        return
    if last or not mode & stat.S_ISVTX:
        whom = "everybody" if mode & stat.S_IWOTH else "its group"
        raise _stranger(folder, f"{whom} may write to {step} (mode {stat.S_IMODE(mode):04o})")


def _stranger(folder: Path, why: str) -> ConfigError:
    return ConfigError(
        f"The socket cannot be kept in {folder}, because others could replace it: {why}. "
        "Choose a folder that only its owner can write to.",
        "socket",
    )


def _steps(folder: Path) -> list[Path]:
    """Every folder and link on the way from the root to `folder`, in order; links are followed by hand."""
    steps = [Path("/")]
    todo = list(reversed((Path.cwd() / folder).parts[1:]))  # with its "..": they count behind links
    links = 0
    while todo:
        part = todo.pop()
        step = steps[-1].parent if part == ".." else steps[-1] / part
        steps.append(step)
        if step.is_symlink():
            links += 1
            _check_links(folder, links)
            todo += reversed(_target(step))
            steps.append(Path("/") if step.readlink().is_absolute() else step.parent)
    return steps


def _target(link: Path) -> tuple[str, ...]:
    target = link.readlink()
    return target.parts[1:] if target.is_absolute() else target.parts


def _check_links(folder: Path, links: int) -> None:
    if links > MOST_LINKS:
        raise ConfigError(f"The way to {folder} goes round in symbolic links.", "socket")
