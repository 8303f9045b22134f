"""What a supervisor passes is taken when it is one listening Unix socket, and refused in words otherwise."""

import os
import socket
from collections.abc import Iterator
from pathlib import Path

import pytest

from bentod.activation import passed_socket, path_of
from bentod.errors import ConfigError


@pytest.fixture
def listening(tmp_path: Path) -> Iterator[socket.socket]:
    with socket.socket(socket.AF_UNIX) as made:
        made.bind(str(tmp_path / "bentod.sock"))
        made.listen()
        yield made


def environment(count: str = "1", pid: int | None = None, names: str = "bentod.socket") -> dict[str, str]:
    meant_for = os.getpid() if pid is None else pid
    return {"LISTEN_FDS": count, "LISTEN_PID": str(meant_for), "LISTEN_FDNAMES": names, "HOME": "/"}


def passed(made: socket.socket) -> socket.socket | None:
    """What becomes of `made`; the daemon owns what it is passed, so it gets a copy."""
    return passed_socket(environment(), os.dup(made.fileno()))


def test_a_listening_socket_is_taken_and_its_path_is_known(listening: socket.socket, tmp_path: Path) -> None:
    taken = passed(listening)
    assert taken
    with taken:
        assert path_of(taken) == tmp_path / "bentod.sock"
        assert not taken.get_inheritable()


def test_the_variables_are_gone_for_children_whether_or_not_they_were_for_this_process() -> None:
    for pid in (os.getpid(), 1):
        variables = environment(count="0", pid=pid)
        assert passed_socket(variables) is None
        assert variables == {"HOME": "/"}


@pytest.mark.parametrize("variables", [{}, environment(pid=1), environment("0"), {"LISTEN_FDS": "1"}])
def test_without_a_socket_for_this_process_none_is_taken(variables: dict[str, str]) -> None:
    assert passed_socket(variables) is None


@pytest.mark.parametrize("count", ["2", "-1", "many"])
def test_anything_but_one_socket_is_refused(count: str) -> None:
    with pytest.raises(ConfigError, match=f"passed {count} sockets \\(a:b\\); bentod takes one"):
        passed_socket(environment(count, names="a:b"))


def test_a_file_is_refused() -> None:
    descriptor = os.open("/dev/null", os.O_RDONLY)
    try:
        with pytest.raises(ConfigError, match=r"'bentod.socket', which is no socket"):
            passed_socket(environment(), descriptor)
    finally:
        os.close(descriptor)


def test_a_descriptor_that_is_not_there_is_refused() -> None:
    with pytest.raises(ConfigError, match="descriptor 999, which is no socket"):
        passed_socket(environment(names=""), 999)


@pytest.mark.parametrize(
    ("family", "kind", "why"),
    [
        (socket.AF_INET, socket.SOCK_STREAM, "family AF_INET, not AF_UNIX"),
        (socket.AF_UNIX, socket.SOCK_DGRAM, "type SOCK_DGRAM, not SOCK_STREAM"),
        (socket.AF_UNIX, socket.SOCK_STREAM, "does not listen"),
    ],
)
def test_a_socket_of_another_kind_is_refused(
    family: socket.AddressFamily, kind: socket.SocketKind, why: str
) -> None:
    with socket.socket(family, kind) as made, pytest.raises(ConfigError, match=why):
        passed(made)


@pytest.mark.parametrize("name", ["\0bentod-test", ""])
def test_a_socket_without_a_file_is_refused_because_it_has_no_permissions(name: str) -> None:
    with socket.socket(socket.AF_UNIX) as made:
        made.bind(f"{name}-{os.getpid()}" if name else "")
        made.listen()
        with pytest.raises(ConfigError, match="not a file in a folder"):
            passed(made)
