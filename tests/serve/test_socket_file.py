"""One daemon to a path, and nothing of anybody else's touched."""

import os
import socket
import stat
from collections.abc import Callable
from pathlib import Path

import pytest

from bentod.errors import ConfigError, Refused
from bentod.serve.socket_file import adopted, claimed

STRANGER = 54_321
"""A user and a group that are nobody's."""


def refused(path: Path) -> None:
    """Claim `path`, and leave nothing there."""
    try:
        with claimed(path):
            pass
    finally:
        assert not os.path.lexists(path)
        assert not os.path.lexists(f"{path}.lock")


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


@pytest.fixture
def foreign(monkeypatch: pytest.MonkeyPatch) -> Callable[[Path], None]:
    """Gives a file or folder to somebody who is neither we nor root."""

    def give(path: Path) -> None:
        if os.geteuid() == 0:
            os.chown(path, STRANGER, STRANGER, follow_symlinks=False)
        else:  # the same seen from the other side
            monkeypatch.setattr(os, "geteuid", lambda: STRANGER)

    return give


def test_a_folder_that_a_stranger_made_first_is_not_used(
    tmp_path: Path, foreign: Callable[[Path], None]
) -> None:
    folder = tmp_path / "bentod-1000"
    folder.mkdir(mode=0o700)
    foreign(folder)
    with pytest.raises(ConfigError, match=r"others could replace it: .* belongs to user"):
        refused(folder / "bentod.sock")


@pytest.mark.parametrize(
    ("mode", "whom"), [(0o777, "everybody"), (0o1777, "everybody"), (0o770, "its group")]
)
def test_a_folder_that_others_may_write_to_is_not_used(tmp_path: Path, mode: int, whom: str) -> None:
    folder = tmp_path / "open"
    folder.mkdir()
    folder.chmod(mode)
    with pytest.raises(ConfigError, match=rf"{whom} may write to .*open \(mode {mode:04o}\)"):
        refused(folder / "bentod.sock")


def test_a_private_folder_within_one_that_others_may_write_to_is_not_used(tmp_path: Path) -> None:
    folder = tmp_path / "open" / "private"
    folder.mkdir(parents=True, mode=0o700)
    folder.parent.chmod(0o777)
    with pytest.raises(ConfigError, match=r"everybody may write to .*open \(mode 0777\)"):
        refused(folder / "bentod.sock")


def test_a_private_folder_within_a_sticky_one_is_used(tmp_path: Path) -> None:
    (tmp_path / "shared").mkdir()
    (tmp_path / "shared").chmod(0o1777)
    path = tmp_path / "shared" / "bentod-1000" / "bentod.sock"
    with claimed(path):
        assert path.is_socket()


def test_a_link_to_a_private_folder_is_followed_when_it_is_ours(tmp_path: Path) -> None:
    (tmp_path / "private").mkdir(mode=0o700)
    (tmp_path / "link").symlink_to("private")
    (tmp_path / "far").symlink_to(tmp_path / "link" / ".." / "link")
    with claimed(tmp_path / "far" / "bentod.sock"):
        assert (tmp_path / "private" / "bentod.sock").is_socket()


def test_a_link_that_a_stranger_made_is_not_followed(tmp_path: Path, foreign: Callable[[Path], None]) -> None:
    (tmp_path / "private").mkdir(mode=0o700)
    (tmp_path / "link").symlink_to("private")
    foreign(tmp_path / "link")
    with pytest.raises(ConfigError, match="belongs to user"):
        refused(tmp_path / "link" / "bentod.sock")


def test_a_link_into_a_folder_that_others_may_write_to_is_not_followed(tmp_path: Path) -> None:
    (tmp_path / "open").mkdir()
    (tmp_path / "open").chmod(0o777)
    (tmp_path / "private").mkdir(mode=0o700)
    (tmp_path / "open" / "hop").symlink_to(tmp_path / "private")
    (tmp_path / "link").symlink_to("open/hop")
    with pytest.raises(ConfigError, match=r"everybody may write to .*open \(mode 0777\)"):
        refused(tmp_path / "link" / "bentod.sock")


def test_links_that_go_round_are_told(tmp_path: Path) -> None:
    (tmp_path / "one").symlink_to("two")
    (tmp_path / "two").symlink_to("one")
    with pytest.raises(ConfigError, match="goes round"):
        refused(tmp_path / "one" / "bentod.sock")


def test_every_folder_that_is_made_is_its_owners_only_whatever_the_umask(tmp_path: Path) -> None:
    before = os.umask(0)
    try:
        with claimed(tmp_path / "a" / "b" / "bentod.sock"):
            modes = [stat.S_IMODE((tmp_path / name).stat().st_mode) for name in ("a", "a/b")]
    finally:
        os.umask(before)
    assert modes == [0o700, 0o700]


def listening(path: Path, mode: int = 0o660) -> socket.socket:
    """What a socket unit makes."""
    made = socket.socket(socket.AF_UNIX)
    made.bind(os.fspath(path))
    path.chmod(mode)
    made.listen()
    return made


def test_a_socket_that_was_passed_is_closed_but_not_removed(tmp_path: Path) -> None:
    path = tmp_path / "bentod.sock"
    with adopted(listening(path)) as listener, socket.socket(socket.AF_UNIX) as client:
        client.connect(os.fspath(path))
    assert listener.fileno() == -1
    assert path.is_socket()


def test_a_socket_that_everybody_may_connect_to_is_not_served(tmp_path: Path) -> None:
    path = tmp_path / "bentod.sock"
    with pytest.raises(ConfigError, match="Everybody may connect"), adopted(listening(path, 0o666)):
        pass


def test_a_socket_that_was_passed_from_an_open_folder_is_not_served(tmp_path: Path) -> None:
    tmp_path.chmod(0o777)
    with (
        pytest.raises(ConfigError, match="everybody may write"),
        adopted(listening(tmp_path / "bentod.sock")),
    ):
        pass


def test_a_socket_whose_file_is_gone_is_not_served(tmp_path: Path) -> None:
    listener = listening(tmp_path / "bentod.sock")
    (tmp_path / "bentod.sock").unlink()
    with pytest.raises(ConfigError, match="out of reach"), adopted(listener):
        pass
