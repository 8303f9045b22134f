"""A token is read only from a file that nobody else can read, and no error says what is in it."""

import os
from pathlib import Path

import pytest

from bentod.errors import ConfigError
from bentod.token_file import SHORTEST, read_token

TOKEN = "t" * SHORTEST


def written(folder: Path, content: bytes, mode: int = 0o600) -> Path:
    path = folder / "token"
    path.write_bytes(content)
    path.chmod(mode)
    return path


@pytest.mark.parametrize("content", [TOKEN, TOKEN + "\n", f"  {TOKEN}\r\n\n"])
@pytest.mark.parametrize("mode", [0o600, 0o400])
def test_a_token_is_a_word_with_or_without_a_line_end(tmp_path: Path, content: str, mode: int) -> None:
    assert read_token(written(tmp_path, content.encode(), mode), "tcp.operator_token") == TOKEN


@pytest.mark.parametrize("mode", [0o640, 0o604, 0o620, 0o602, 0o610, 0o666])
def test_a_file_that_is_open_to_others_is_refused(tmp_path: Path, mode: int) -> None:
    with pytest.raises(ConfigError, match=rf"open to others \(mode {mode:04o}\); close it with chmod 600"):
        read_token(written(tmp_path, TOKEN.encode(), mode), "tcp.operator_token")


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "has 0 characters, and must have 32 to 1024"),
        (b"short-secret\n", "has 12 characters, and must have 32 to 1024"),
        (b"x" * 1025, "has 1025 characters"),
        (b"x" * 100_000, "has 1025 characters"),
        (b"two-words " + b"x" * 30, "must be one word"),
        (b"x" * 20 + b"\n" + b"x" * 20, "must be one word"),
        (b"x" * 40 + b"\x00", "must be one word"),
        (b"\xff" * 40, "is not plain text"),
    ],
)
def test_a_token_that_will_not_do_is_refused_without_a_word_of_it(
    tmp_path: Path, content: bytes, words: str
) -> None:
    with pytest.raises(ConfigError, match=words) as caught:
        read_token(written(tmp_path, content), "tcp.operator_token")
    assert "xxx" not in str(caught.value)
    assert "secret" not in str(caught.value)


def test_what_is_no_regular_file_is_refused(tmp_path: Path) -> None:
    pipe, link = tmp_path / "pipe", tmp_path / "link"
    os.mkfifo(pipe, 0o600)
    link.symlink_to(written(tmp_path, TOKEN.encode()))
    for path, words in (
        (pipe, "not a regular file"),
        (tmp_path, "not a regular file"),
        (link, "cannot be read"),
    ):
        with pytest.raises(ConfigError, match=words):
            read_token(path, "tcp.operator_token")


def test_a_file_that_is_not_there_is_a_config_error(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"tcp\.operator_token: .*none cannot be read: No such file"):
        read_token(tmp_path / "none", "tcp.operator_token")


@pytest.mark.skipif(os.getuid() != 0, reason="only root can give a file away")
def test_a_file_of_another_user_is_refused(tmp_path: Path) -> None:
    path = written(tmp_path, TOKEN.encode())
    os.chown(path, 54321, -1)
    with pytest.raises(ConfigError, match="belongs to user 54321"):
        read_token(path, "tcp.operator_token")


def test_a_name_alone_is_looked_for_among_the_credentials_of_the_service(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    written(tmp_path, TOKEN.encode(), 0o440)  # as systemd shows a file with an access list
    monkeypatch.setenv("CREDENTIALS_DIRECTORY", str(tmp_path))
    assert read_token(Path("token"), "tcp.operator_token") == TOKEN
    written(tmp_path, TOKEN.encode(), 0o444)
    with pytest.raises(ConfigError, match="open to others"):
        read_token(Path("token"), "tcp.operator_token")
    with pytest.raises(ConfigError, match="cannot be read"):
        read_token(Path("another"), "tcp.operator_token")
