"""Where a daemon is and how to reach it: a path, tls://host:port, or tcp://host:port on this machine."""

import os
import ssl
import stat
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import urlsplit

from bentod.errors import BadRequest, ConfigError
from bentod.frames import Value
from bentod.hosts import is_this_machine
from bentod.token_file import proof, read_token

PORT = 4776

TOKEN_VARIABLE, CA_VARIABLE = "BENTOD_TOKEN_FILE", "BENTOD_CA_FILE"


@dataclass(frozen=True, slots=True)
class Address:
    """Where a daemon listens: a socket in the file system, or a port of a host."""

    text: str  # as the user gave it
    path: str = ""  # empty: TCP
    host: str = ""
    port: int = PORT
    tls: bool = False

    def check(self) -> None:
        """See that nobody else could be listening in the daemon's place.

        Raises:
            ConfigError: in /tmp another user has made the socket, or the folder that it is in.
        """
        folder = Path(self.path).parent
        if folder == shared_folder():
            for place in (folder, Path(self.path)):
                _check_owner(place)

    def token(self, given: str | None) -> str:
        """What proves who we are: as given, or in the file that the environment names.

        Raises:
            ConfigError: there is no token, or its file is not private.
        """
        if given is not None:
            return given
        file = os.environ.get(TOKEN_VARIABLE)
        if not file:
            raise ConfigError(f"{self.text} asks for a token; name its file in {TOKEN_VARIABLE}.", "token")
        return read_token(Path(file), TOKEN_VARIABLE)

    def answer(self, challenge: Value, token: str | None) -> dict[str, Value]:
        """Parameters that prove who we are, without the token, to a server that has sent a challenge.

        Raises:
            ConfigError: as `token` does.
        """
        nonce = challenge.get("nonce") if isinstance(challenge, dict) else None
        return {"proof": proof(self.token(token), str(nonce))}

    def tls_context(self, cafile: Path | str | None) -> ssl.SSLContext | None:
        """What the server must prove: a certificate for the host, by an authority in `cafile` or a known one.

        Raises:
            ConfigError: the file holds no certificate.
        """
        if not self.tls:
            return None
        file = cafile or os.environ.get(CA_VARIABLE) or None
        try:
            context = ssl.create_default_context(cafile=file)
        except OSError as error:
            raise ConfigError(f"{file} holds no certificate: {error.strerror or error}.", "cafile") from error
        context.minimum_version = ssl.TLSVersion.TLSv1_2
        return context


def shared_folder() -> Path:
    """Where the socket is when users have no folder of their own; anybody could make it first."""
    return Path("/tmp", f"bentod-{os.getuid()}")  # noqa: S108 - who made it is checked at both ends


def parse(where: Path | str) -> Address:
    """The address that a path or a text stands for.

    Raises:
        BadRequest: it is neither a path nor of one of the two forms, or would send the token in the clear.
    """
    text = os.fspath(where)
    if "://" not in text:
        return Address(text, path=text)
    try:
        parts = urlsplit(text)
        host, port = parts.hostname, parts.port
    except ValueError as error:
        raise BadRequest(f"{text}: {error}.", "socket") from error
    bare = parts.path in ("", "/") and not (parts.query or parts.fragment or "@" in parts.netloc)
    if parts.scheme not in ("tcp", "tls") or not host or not bare:
        raise BadRequest(f"{text} is neither a path nor tls://HOST:PORT nor tcp://HOST:PORT.", "socket")
    if parts.scheme == "tcp" and not is_this_machine(host):
        raise BadRequest(f"{text} would send the token in the clear; use tls://{parts.netloc}.", "socket")
    return Address(text, host=host, port=port or PORT, tls=parts.scheme == "tls")


def _check_owner(place: Path) -> None:
    try:
        found = place.lstat()
    except OSError:  # connecting says why in better words
        return
    owner = found.st_uid
    if owner not in (0, os.getuid()):
        raise ConfigError(f"{place} belongs to user {owner}, who may only pose as your daemon.", "socket")
    if stat.S_ISLNK(found.st_mode):
        raise ConfigError(f"{place} is a link, and no daemon makes one; remove it.", "socket")
    if stat.S_ISDIR(found.st_mode) and found.st_mode & (stat.S_IWGRP | stat.S_IWOTH):
        raise ConfigError(
            f"Others may write to {place} (mode {stat.S_IMODE(found.st_mode):04o}) and so could pose as your "
            f"daemon; close it with chmod 700.",
            "socket",
        )
