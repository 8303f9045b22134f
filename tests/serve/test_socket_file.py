"""One daemon to a path, and nothing of anybody else's touched."""

import os
import socket
import stat
from pathlib import Path

import pytest

from bentod.errors import ConfigError, Refused
from bentod.serve.socket_file import claimed


def test_the_socket_is_for_owner_and_group_in_a_private_folder(tmp_path: Path) -> None:
    path = tmp_path / "new" / "bentod.sock"
    with claimed(path):
        assert stat.S_IMODE(path.stat().st_mode) == 0o660
        assert stat.S_IMODE(path.parent.stat().st_mode) == 0o700


def test_the_socket_is_removed_at_the_end(tmp_path: Path) -> None:
    path = tmp_path / "bentod.sock"
    with claimed(path):
        assert path.is_socket()
    assert not path.exists()


def test_a_second_daemon_is_refused_and_disturbs_nothing(tmp_path: Path) -> None:
    path = tmp_path / "bentod.sock"
    with claimed(path):
        with pytest.raises(Refused, match="already serves"), claimed(path):
            pass
        assert path.is_socket()


def test_a_stale_socket_is_replaced(tmp_path: Path) -> None:
    path = tmp_path / "bentod.sock"
    with socket.socket(socket.AF_UNIX) as crashed:
        crashed.bind(os.fspath(path))
    with claimed(path) as listener:
        listener.listen()
        with socket.socket(socket.AF_UNIX) as client:
            client.connect(os.fspath(path))


def test_a_socket_that_someone_else_listens_on_is_left_alone(tmp_path: Path) -> None:
    path = tmp_path / "bentod.sock"
    with socket.socket(socket.AF_UNIX) as stranger:
        stranger.bind(os.fspath(path))
        stranger.listen()
        with pytest.raises(Refused), claimed(path):
            pass
        assert path.is_socket()


@pytest.mark.parametrize("kind", ["file", "link", "folder"])
def test_what_is_not_a_socket_is_left_alone(tmp_path: Path, kind: str) -> None:
    path = tmp_path / "bentod.sock"
    if kind == "file":
        path.write_text("precious")
    elif kind == "link":
        path.symlink_to(tmp_path / "elsewhere")
    else:
        path.mkdir()
    with pytest.raises(ConfigError, match="not a socket"), claimed(path):
        pass
    assert path.is_symlink() or path.exists()


def test_a_successors_socket_is_not_removed(tmp_path: Path) -> None:
    path = tmp_path / "bentod.sock"
    with socket.socket(socket.AF_UNIX) as successor:
        with claimed(path):
            path.unlink()
            successor.bind(os.fspath(path))
        assert path.is_socket()


def test_a_path_of_108_bytes_is_too_long(tmp_path: Path) -> None:
    path = tmp_path / "x"
    path = path.with_name("x" * (108 - len(os.fsencode(path)) + 1))
    with pytest.raises(ConfigError, match="108 bytes"), claimed(path):
        pass


def test_a_folder_that_cannot_be_made_is_a_config_error(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with (
        pytest.raises(ConfigError, match="No socket can be made"),
        claimed(tmp_path / "file" / "bentod.sock"),
    ):
        pass
