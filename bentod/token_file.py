"""Tokens: read from a file that nobody else can read, as with SSH's keys, and known without being told."""

import hashlib
import hmac
import os
import stat
from pathlib import Path

from bentod.errors import ConfigError

SHORTEST = 32
"""Characters. `openssl rand -hex 32` makes 64, which nobody guesses."""

LONGEST = 1024
"""Characters of a token, and bytes of its file."""


def read_token(path: Path, key: str) -> str:
    """The token in `path`; `key` says what asked for it. No sentence ever holds any of it.

    Raises:
        ConfigError: it cannot be read, others can read or replace it, or it is no good as a token.
    """
    found = _find(path)
    try:
        descriptor = os.open(found, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)
    except OSError as error:
        raise ConfigError(f"{key}: {found} cannot be read: {error.strerror}.", key) from error
    try:
        problem = _problem(os.fstat(descriptor), from_systemd=found != path)
        content = b"" if problem else os.read(descriptor, LONGEST + 1)
    finally:
        os.close(descriptor)
    if problem:
        raise ConfigError(f"{key}: {found} {problem}.", key)
    return _checked(content, f"{key}: the token in {found}", key)


def proof(token: str, nonce: str) -> str:
    """Shows whoever knows `token`, and nobody else, that we know it, too: for this `nonce` only.

    HMAC-SHA256 (RFC 2104) of the nonce's characters, keyed with the token's, in hexadecimal digits.
    """
    return hmac.new(token.encode(), nonce.encode(), hashlib.sha256).hexdigest()


def _find(path: Path) -> Path:
    """Where the file is: a name that systemd keeps as a credential, or else as it stands."""
    folder = os.environ.get("CREDENTIALS_DIRECTORY")
    if folder and not path.is_absolute() and Path(folder, path).exists():
        return Path(folder, path)
    return path


def _problem(found: os.stat_result, from_systemd: bool) -> str:
    """Why this is no file for a secret; empty if it is."""
    if not stat.S_ISREG(found.st_mode):
        return "is not a regular file"
    if found.st_uid not in (0, os.geteuid()):
        return f"belongs to user {found.st_uid}, and must belong to uid {os.geteuid()} or root"
    # systemd lets a service read its credentials by an access list, which shows as the group's right.
    strangers = stat.S_IRWXO | (0 if from_systemd else stat.S_IRWXG)
    if found.st_mode & strangers:
        mode = stat.S_IMODE(found.st_mode)
        return f"is open to others (mode {mode:04o}); close it with chmod 600"
    return ""


def _checked(content: bytes, what: str, key: str) -> str:
    try:
        token = content.decode("ascii").strip()
    except UnicodeDecodeError:
        raise ConfigError(f"{what} is not plain text.", key) from None
    if not SHORTEST <= len(token) <= LONGEST:
        raise ConfigError(
            f"{what} has {len(token)} characters, and must have {SHORTEST} to {LONGEST}. "
            "Make one with: openssl rand -hex 32",
            key,
        )
    if not token.isprintable() or " " in token:
        raise ConfigError(f"{what} must be one word.", key)
    return token
