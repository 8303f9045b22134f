"""Where browsers find the page, and on which terms."""

import socket as sockets
import ssl
from dataclasses import dataclass
from pathlib import Path

from bentod.dashboard.doorkeeper import LOOPBACK
from bentod.errors import ConfigError


@dataclass(frozen=True, slots=True)
class Place:
    """What the user chose."""

    host: str
    port: int
    names: tuple[str, ...] = ()  # under which it may be asked for, besides those of this machine
    certificate: Path | None = None  # PEM
    key: Path | None = None  # PEM
    urdf: Path | None = None  # of another arm

    @property
    def address(self) -> str:
        """Of the page, without a token."""
        scheme = "https" if self.certificate else "http"
        name = self.names[0] if self.names else self.host
        return f"{scheme}://{f'[{name}]' if ':' in name else name}:{self.port}/"

    def checked(self) -> ssl.SSLContext | None:
        """How the connection is secured; None on this machine alone.

        Raises:
            ConfigError: other machines would see it in clear, or the certificate cannot be used.
        """
        if self.certificate is None:
            if self.host not in LOOPBACK | {"::1"}:
                raise ConfigError(
                    f"--host {self.host} is for other machines too, so it needs TLS: "
                    "give --certificate and --key"
                )
            return None
        context = ssl.create_default_context(ssl.Purpose.CLIENT_AUTH)
        try:
            context.load_cert_chain(self.certificate, self.key)
        except (OSError, ssl.SSLError) as error:
            raise ConfigError(f"--certificate {self.certificate} cannot be used: {error}.") from error
        return context


def listener(host: str, port: int | None, usual: int) -> sockets.socket:
    """Listens on `port`, or else on the usual one, or else on one that is free.

    The keeper holds it, so a server that is started again has the same one, and browsers wait meanwhile.

    Raises:
        ConfigError: the host is not of this machine, or the port is taken.
    """
    problem = ""
    for wanted in [port] if port else [usual, 0]:
        try:
            return _listening(host, wanted)
        except OSError as error:
            problem = error.strerror or str(error)
    raise ConfigError(f"Nothing can listen on {host}{f', port {port}' if port else ''}: {problem}.")


def _listening(host: str, port: int) -> sockets.socket:
    family = sockets.AF_INET6 if ":" in host else sockets.AF_INET
    return sockets.create_server((host, port), family=family, backlog=128)
