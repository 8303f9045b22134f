"""Who comes in through the Unix socket: the kernel says which user it is, and the config what that allows."""

import asyncio
import grp
import logging
import os
import pwd
import socket
import struct
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from bentod.config_tables import Access
from bentod.errors import Refused
from bentod.serve.line import Line, opened, send_away
from bentod.serve.peers import Peer, Role

log = logging.getLogger(__name__)

SO_PEERGROUPS = 59
"""Linux (asm-generic/socket.h): the supplementary groups of the process at the other end, as gid_t[]."""

MOST_BYTES = 1024
"""That Python reads of one socket option: 256 groups."""

ROOT = 0

OVERFLOW = (Path("/proc/sys/kernel/overflowuid"), Path("/proc/sys/kernel/overflowgid"))
"""The user and the group that stand for all whom the kernel cannot name here (man 7 user_namespaces)."""

UNNAMED = 65_534
"""Both of them, unless somebody changed that."""

_STRANGER = (
    "uid {} may not look at this arm: it is in no group that access.observers or access.operators names in "
    "the daemon's config. Be put into one, then log in again."
)

_CREDENTIALS = struct.Struct("iII")  # struct ucred: pid, uid, gid (man 7 unix)


@dataclass(frozen=True, slots=True)
class Credentials:
    """The process at the other end, as it was when it connected."""

    pid: int
    uid: int
    groups: frozenset[int]  # all of them, by number


class UnixDoor:
    """Tells roles by Unix group. Their names are looked up at the start only: that may hold up a tick."""

    pace = None

    def __init__(self, access: Access, masters: Iterable[int] | None = None) -> None:
        """`masters`: user numbers that may do everything; without: root and our own."""
        nobody, no_group = map(_overflow, OVERFLOW)  # whoever has these may be anybody
        self._masters = frozenset((ROOT, os.getuid()) if masters is None else masters) - {nobody}
        if masters is None and os.getuid() == nobody:
            log.warning("The daemon runs as uid %d, which may be anybody: only root is its master.", nobody)
        self._operators = _numbers(access.operators, "operators") - {no_group}
        self._observers = _numbers(access.observers or (), "observers") - {no_group}
        self._open = access.observers is None
        self._remedy = _remedy(access.operators)

    async def admit(self, connection: socket.socket) -> tuple[Line, Peer]:
        """The line to a user who may look at least. Raises as any door does."""
        line = await opened(connection)
        try:
            found = await credentials(connection)
            role = self._role(found)
            if role is None:
                await send_away(
                    line, f"uid {found.uid}", f"uid {found.uid}", Refused(_STRANGER.format(found.uid))
                )
        except BaseException:
            line.writer.transport.abort()
            raise
        remedy = f"uid {found.uid} is {role.value}. {self._remedy}"
        return line, Peer(f"pid {found.pid}", f"uid {found.uid}", role, remedy, found.uid in self._masters)

    def _role(self, found: Credentials) -> Role | None:
        if found.uid in self._masters or found.groups & self._operators:
            return Role.OPERATOR
        return Role.OBSERVER if self._open or found.groups & self._observers else None


async def credentials(connection: socket.socket) -> Credentials:
    """Who is at the other end of a Unix socket. Raises OSError: the kernel does not say."""
    raw = connection.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, _CREDENTIALS.size)
    pid, uid, gid = _CREDENTIALS.unpack(raw)
    groups = _peer_groups(connection)
    if groups is None:  # a look into the user database may wait for a network
        groups = await asyncio.to_thread(_listed_groups, uid, gid)
    return Credentials(pid, uid, frozenset((gid, *groups)))


def _peer_groups(connection: socket.socket) -> Sequence[int] | None:
    """None: this kernel does not know, or they are too many."""
    try:
        raw = connection.getsockopt(socket.SOL_SOCKET, SO_PEERGROUPS, MOST_BYTES)
    except OSError:
        return None
    return struct.unpack(f"{len(raw) // 4}I", raw)


def _listed_groups(uid: int, gid: int) -> Sequence[int]:
    try:
        return os.getgrouplist(pwd.getpwuid(uid).pw_name, gid)
    except KeyError:  # a user without a name is in no group but its own
        return ()


def _overflow(file: Path) -> int:
    try:
        return int(file.read_text())
    except (OSError, ValueError):  # no such file outside Linux, or in a sandbox
        return UNNAMED


def _numbers(names: Iterable[str], key: str) -> frozenset[int]:
    """Numbers of the groups that exist; the others let nobody in."""
    numbers = set()
    for name in names:
        try:
            numbers.add(grp.getgrnam(name).gr_gid)
        except KeyError:
            log.warning("access.%s: there is no group '%s' on this machine; it lets nobody in.", key, name)
    return frozenset(numbers)


def _remedy(operators: Sequence[str]) -> str:
    if not operators:
        return "Only the daemon's own user and root are operators, because access.operators is empty."
    return (
        f"Operators are in one of these groups (access.operators) when they connect: {', '.join(operators)}."
    )
