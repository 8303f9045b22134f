"""The socket in the file system: one daemon to a path, nothing of anybody else's touched."""

import fcntl
import os
import socket
import stat
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

from bentod.activation import path_of
from bentod.errors import ConfigError, Refused
from bentod.serve.private_path import check_private, make_folder

LONGEST_PATH = 107
"""Bytes; the kernel's `sun_path` holds 108 with the final zero."""


@contextmanager
def claimed(path: Path) -> Iterator[socket.socket]:
    """A bound socket at `path`, mode 0660, removed at the end; not yet listening.

    `<path>.lock` stays behind: to remove it would let two daemons hold locks on two files of one name.

    Raises:
        ConfigError: the path is too long, not writable, in a folder that is not private, or something
            else lives there.
        Refused: a daemon already serves this path.
    """
    _check_length(path)
    with ExitStack() as stack:
        try:
            make_folder(path.parent)
            check_private(path.parent)
            stack.enter_context(_locked(path))
            _clear(path)
            listener = stack.enter_context(_bound(path))
        except OSError as error:
            raise ConfigError(f"No socket can be made at {path}: {error.strerror}.", "socket") from error
        yield listener


@contextmanager
def adopted(listener: socket.socket) -> Iterator[socket.socket]:
    """A socket that a supervisor made and listens on; its file stays, because it is not ours.

    It needs no lock: whoever else wants its path finds it answered.

    Raises:
        ConfigError: others could replace it, or everybody may connect to it.
    """
    path = path_of(listener)
    with listener:
        try:
            check_private(path.parent)
            open_to_all = path.stat().st_mode & stat.S_IWOTH
        except OSError as error:
            raise ConfigError(
                f"The passed socket {path} is out of reach: {error.strerror}.", "socket"
            ) from error
        if open_to_all:
            raise ConfigError(f"Everybody may connect to {path}; set SocketMode=0660 in its unit.", "socket")
        yield listener


def _check_length(path: Path) -> None:
    length = len(os.fsencode(path))
    if length > LONGEST_PATH:
        raise ConfigError(
            f"The socket path {path} has {length} bytes; the kernel takes {LONGEST_PATH}.", "socket"
        )


@contextmanager
def _locked(path: Path) -> Iterator[None]:
    flags = os.O_RDWR | os.O_CREAT | os.O_CLOEXEC | os.O_NOFOLLOW
    descriptor = os.open(f"{path}.lock", flags, 0o600)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise _taken(path) from None
    else:
        yield
    finally:
        os.close(descriptor)


def _taken(path: Path) -> Refused:
    return Refused(f"A daemon already serves {path}; stop it first, or choose another socket.", "socket")


def _clear(path: Path) -> None:
    """Remove a socket that nobody listens on."""
    try:
        mode = path.lstat().st_mode
    except FileNotFoundError:
        return
    if not stat.S_ISSOCK(mode):
        raise ConfigError(f"{path} exists and is not a socket; it is left alone.", "socket")
    if _is_answered(path):
        raise _taken(path)
    path.unlink()


def _is_answered(path: Path) -> bool:
    with socket.socket(socket.AF_UNIX) as probe:
        probe.setblocking(False)
        try:
            probe.connect(os.fspath(path))
        except ConnectionRefusedError:
            return False
        except BlockingIOError:  # alive, but its backlog is full
            return True
    return True


@contextmanager
def _bound(path: Path) -> Iterator[socket.socket]:
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind(os.fspath(path))
        made = path.lstat()
        try:
            path.chmod(0o660)  # in time: nobody can connect before listen()
            yield listener
        finally:
            _remove(path, made)


def _remove(path: Path, made: os.stat_result) -> None:
    try:
        found = path.lstat()
    except FileNotFoundError:
        return
    if (found.st_dev, found.st_ino) == (made.st_dev, made.st_ino):
        path.unlink()
