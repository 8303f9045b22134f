"""Who may come in: by token, and only with a page that this server itself has served."""

import hmac
import secrets
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from urllib.parse import urlsplit

LOOPBACK = frozenset({"127.0.0.1", "localhost", "[::1]"})
"""Names that always mean this machine."""

CHECKED_BYTES = 32
"""Randomness of a token."""

_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; connect-src 'self'; "
    "manifest-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)

HEADERS: Mapping[str, str] = {
    "Content-Security-Policy": _POLICY,
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Permissions-Policy": "camera=(), geolocation=(), microphone=(), payment=(), usb=()",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
}
"""Of every answer: the page loads nothing from elsewhere, and is shown in nobody else's page."""


@dataclass(frozen=True, slots=True)
class Tokens:
    """What makes an operator or an observer. They are in the URL's fragment, which browsers do not send."""

    operator: str
    observer: str

    @classmethod
    def new(cls) -> "Tokens":
        """Two that nobody guesses."""
        return cls(secrets.token_urlsafe(CHECKED_BYTES), secrets.token_urlsafe(CHECKED_BYTES))

    def role(self, token: str) -> str:
        """What a token makes: operator, observer, or nothing."""
        given = token.encode()
        roles = {"operator": self.operator, "observer": self.observer}
        return next((role for role, own in roles.items() if hmac.compare_digest(own.encode(), given)), "")


class Doorkeeper:
    """Judges requests by the names that they give for this server."""

    def __init__(self, hosts: Collection[str], port: int, tls: bool) -> None:
        """`hosts`: names, besides those of this machine, under which the server may be asked for."""
        self._port = port
        self._scheme = "https" if tls else "http"
        self._hosts = LOOPBACK | frozenset(host.lower() for host in hosts)

    def knows(self, host: str) -> bool:
        """Whether a Host header means this server; another name may be a stranger's that points here."""
        try:
            parts = urlsplit(f"//{host}")
            port = parts.port or (443 if self._scheme == "https" else 80)
        except ValueError:
            return False
        name = (parts.hostname or "").lower()
        return port == self._port and (name in self._hosts or f"[{name}]" in self._hosts)

    def is_own(self, origin: str, host: str) -> bool:
        """Whether a page of this server asks, and not one of somebody else in the same browser."""
        return self.knows(host) and origin.lower() == f"{self._scheme}://{host.lower()}"
