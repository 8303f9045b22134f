"""Listening on TCP: which addresses, with which certificate, and how a dead peer is noticed."""

import ipaddress
import logging
import re
import socket
import ssl
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

from bentod.config_tables import Tcp
from bentod.errors import ConfigError

log = logging.getLogger(__name__)

BACKLOG = 16

HANDSHAKES_PER_S = 20.0
"""With elliptic curves TLS costs the loop less than a millisecond, with RSA of 2048 bits about one."""

SLOW_HANDSHAKES_PER_S = 2.0

LONG_KEY = 1850
"""Bytes. A private key of RSA with 3072 bits takes 1770 to 1800 (RFC 8017, A.1.2), with 4096 bits 2350."""

KEEPALIVE = {"TCP_KEEPIDLE": 10, "TCP_KEEPINTVL": 5, "TCP_KEEPCNT": 3, "TCP_USER_TIMEOUT": 15_000}
"""Options and values: s, s, times, ms. A cable that is pulled ends the connection within half a minute."""


@contextmanager
def listening(tcp: Tcp) -> Iterator[list[socket.socket]]:
    """Sockets that listen on every address of the host.

    Raises:
        ConfigError: the host has no address, one that others reach although there is no certificate, or
            something else listens there.
    """
    with ExitStack() as stack:
        yield [stack.enter_context(_bound(*found, tcp)) for found in _addresses(tcp)]


def _addresses(tcp: Tcp) -> list[tuple[socket.AddressFamily, tuple[str, int]]]:
    try:
        found = socket.getaddrinfo(tcp.host, tcp.port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)
    except OSError as error:
        raise ConfigError(f"tcp.host = {tcp.host}: has no address: {error.strerror}.", "tcp.host") from error
    addresses = {(family, (str(where[0]), int(where[1]))) for family, _, _, _, where in found}
    for _, (address, _) in addresses:
        if tcp.certificate is None and not ipaddress.ip_address(address).is_loopback:
            raise ConfigError(
                f"tcp.host = {tcp.host} is {address}, which others can reach: that needs "
                "tcp.certificate and tcp.key.",
                "tcp.host",
            )
    return sorted(addresses)


def _bound(family: socket.AddressFamily, where: tuple[str, int], tcp: Tcp) -> socket.socket:
    listener = socket.socket(family, socket.SOCK_STREAM)
    try:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        if family == socket.AF_INET6:  # else it would take the place of the IPv4 socket, too
            listener.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_V6ONLY, 1)
        listener.bind(where)
        listener.listen(BACKLOG)
    except OSError as error:
        listener.close()
        raise ConfigError(
            f"tcp: cannot listen on {where[0]} port {tcp.port}: {error.strerror}.", "tcp.port"
        ) from error
    return listener


def kept_alive(connection: socket.socket) -> None:
    """Have the kernel notice that the other machine is gone, and send what is small at once."""
    # asyncio does so only for sockets that it has made itself.
    connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    for name, value in KEEPALIVE.items():
        if hasattr(socket, name):
            connection.setsockopt(socket.IPPROTO_TCP, getattr(socket, name), value)


def server_tls(tcp: Tcp) -> ssl.SSLContext | None:
    """TLS 1.2 or later with the configured certificate; None without one.

    Raises:
        ConfigError: the certificate or its key cannot be used.
    """
    if tcp.certificate is None or tcp.key is None:
        return None
    _check_key(tcp.key)
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.minimum_version = ssl.TLSVersion.TLSv1_2
    context.options |= ssl.OP_NO_RENEGOTIATION  # else one connection could cost a handshake after the other
    try:
        context.load_cert_chain(tcp.certificate, tcp.key, password=_no_password)
    except OSError as error:  # an ssl.SSLError is one, too
        reason = error.strerror or str(error)
        raise ConfigError(f"tcp.certificate = {tcp.certificate}: no TLS with it: {reason}.", "tcp") from error
    return context


def handshakes_per_s(tcp: Tcp) -> float:
    """How often a client may begin TLS. Each time costs the loop what the key's signature costs."""
    if tcp.key is None or _key_size(tcp.key) <= LONG_KEY:
        return HANDSHAKES_PER_S
    log.warning(
        "tcp.key = %s: is longer than RSA with 3072 bits. To sign with it takes a tick's time, so only %g "
        "connections a second are taken. A key of elliptic curves (openssl ecparam -name prime256v1 -genkey) "
        "is as good, and twenty times quicker.",
        tcp.key,
        SLOW_HANDSHAKES_PER_S,
    )
    return SLOW_HANDSHAKES_PER_S


def _key_size(path: Path) -> int:
    """Bytes of the longest thing in the key's file, which is the key."""
    blocks = re.findall(
        r"-----BEGIN [A-Z ]+-----(.*?)-----END", path.read_text("ascii", "replace"), re.DOTALL
    )
    return max((len("".join(block.split())) * 3 // 4 for block in blocks), default=0)


def _no_password() -> str:
    raise ConfigError("tcp.key: is encrypted; the daemon has nobody to ask for its password.", "tcp.key")


def _check_key(key: Path) -> None:
    try:
        mode = key.stat().st_mode
    except OSError as error:
        raise ConfigError(f"tcp.key = {key}: cannot be read: {error.strerror}.", "tcp.key") from error
    if mode & 0o007:
        raise ConfigError(f"tcp.key = {key}: everybody can read it; close it with chmod 640.", "tcp.key")
