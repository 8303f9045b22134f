"""Where a session comes from: the config as it was read, the robot, and the versions of what ran."""

import os
import platform
import secrets
import shutil
import subprocess
from collections.abc import Mapping
from dataclasses import replace
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import tomlkit

from bentod.config import Config
from bentod.config_tables import Record
from bentod.contracts import Clock
from bentod.errors import ConfigError
from bentod.record.disk import GB, Budget, default_folder, session_name
from bentod.record.scribe import Limits
from bentod.record.session import SCHEMA, Header

_PACKAGES = ("bentod", "numpy", "mcap", "protobuf", "zstandard")

_PATIENCE = 2.0  # s that git may take


def new_header(config: Config, text: str, name: str, clock: Clock, learned: bytes = b"") -> Header:
    """The header of a session that begins now, as `template` and `begun` make it."""
    return begun(template(config, text, name), clock, learned=learned)


def template(config: Config, text: str, name: str) -> Header:
    """What all sessions with a config have in common; `text` and `name` are those of its file.

    It starts git, so it belongs before the first tick, or into a thread.

    Raises:
        ConfigError: the robot's description cannot be read.
    """
    return Header(
        session="",
        schema=SCHEMA,
        started=0.0,
        started_wall=0.0,
        arm=config.arm,
        rate_hz=config.rate_hz,
        joints=tuple(joint.spec() for joint in config.joints),
        config=text,
        config_name=name,
        versions=versions(),
        urdf=_urdf(config.record.urdf),
    )


def begun(common: Header, clock: Clock, note: str = "", learned: bytes = b"") -> Header:
    """The header of a session that begins now; `learned`: the snapshot that its learners go on with."""
    wall = clock.wall()
    session = session_name(wall, secrets.randbits(16))
    return replace(
        common, session=session, started=clock.now(), started_wall=wall, note=note, learned=learned
    )


def as_toml(config: Config) -> str:
    """What the config says in effect, with every default and what the command line replaced."""
    return tomlkit.dumps(config.model_dump(mode="json", exclude_none=True))


def folder(table: Record, environment: Mapping[str, str] = os.environ) -> Path:
    """Where recordings go."""
    return table.folder or default_folder(environment)


def limits(table: Record) -> Limits:
    """When a new part begins, and what all recordings may use."""
    budget = Budget(table.max_gb * GB, table.min_free_gb * GB)
    return Limits(table.max_file_mb * 1e6, table.max_file_min * 60, budget)


def versions(root: Path = Path(__file__).parents[2]) -> dict[str, str]:
    """Of bentod, of what records, of Python and of the system; and the commit, if `root` is a checkout."""
    found = {name: known for name in _PACKAGES if (known := _version(name))}
    found["python"] = platform.python_version()
    found["system"] = platform.platform()
    return found | _git(root)


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return ""


def _git(root: Path) -> dict[str, str]:
    """The commit, and whether files differ from it. Nothing of git is worth a late start."""
    git = shutil.which("git")
    if git is None or not (root / ".git").exists():
        return {}
    try:
        commit = _asked(git, root, "rev-parse", "HEAD")
        changed = _asked(git, root, "status", "--porcelain", "--untracked-files=no")
    except (OSError, subprocess.SubprocessError):
        return {}
    return {"commit": commit, "dirty": "yes" if changed else "no"}


def _asked(git: str, root: Path, *question: str) -> str:
    command = [git, "-C", str(root), *question]
    answer = subprocess.run(command, capture_output=True, text=True, check=True, timeout=_PATIENCE)  # noqa: S603
    return answer.stdout.strip()


def _urdf(path: Path | None) -> str:
    if path is None:
        return ""
    try:
        return path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise ConfigError(f"record.urdf = '{path}' cannot be read: {error}", "record.urdf") from error
