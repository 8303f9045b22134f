"""One way to write where a daemon is, and no talking to whoever may pose as it."""

import os
import ssl
from pathlib import Path

import pytest

from bentod import address
from bentod.address import Address, parse
from bentod.blocking import BlockingClient
from bentod.client import Client
from bentod.endpoint import Disconnected, default_socket_path
from bentod.errors import BadRequest, ConfigError


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("/run/bentod.sock", Address("/run/bentod.sock", path="/run/bentod.sock")),
        ("bentod.sock", Address("bentod.sock", path="bentod.sock")),
        ("tls://arm.lab", Address("tls://arm.lab", host="arm.lab", port=4776, tls=True)),
        ("tls://arm.lab:99/", Address("tls://arm.lab:99/", host="arm.lab", port=99, tls=True)),
        ("tls://[2001:db8::1]:99", Address("tls://[2001:db8::1]:99", host="2001:db8::1", port=99, tls=True)),
        ("tcp://127.0.0.1:99", Address("tcp://127.0.0.1:99", host="127.0.0.1", port=99)),
        ("tcp://[::1]", Address("tcp://[::1]", host="::1")),
        ("tcp://localhost", Address("tcp://localhost", host="localhost")),
    ],
)
def test_an_address_is_a_path_or_a_port_of_a_host(text: str, found: Address) -> None:
    assert parse(text) == found


def test_a_path_is_a_path_whatever_it_looks_like() -> None:
    assert parse(Path("tls://x")).path == "tls:/x"


@pytest.mark.parametrize(
    "text",
    [
        "http://arm.lab",
        "tls://",
        "tls://arm.lab:port",
        "tls://arm.lab:99999",
        "tls://me:secret@arm.lab",
        "tls://arm.lab/x",
        "tls://arm.lab?token=x",
        "tls://[::1",
        "tcp://arm.lab",
        "tcp://192.0.2.1",
    ],
)
def test_what_is_neither_or_not_safe_is_refused(text: str) -> None:
    with pytest.raises(BadRequest):
        parse(text)


@pytest.fixture
def shared(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder that anybody could have made first."""
    folder = tmp_path / "shared"
    monkeypatch.setattr(address, "shared_folder", lambda: folder)
    monkeypatch.setattr("bentod.endpoint.shared_folder", lambda: folder)
    for name in ("RUNTIME_DIRECTORY", "XDG_RUNTIME_DIR"):
        monkeypatch.delenv(name, raising=False)
    folder.mkdir(mode=0o700)
    return folder


async def test_in_a_shared_place_a_folder_of_our_own_will_do(shared: Path) -> None:
    assert default_socket_path() == shared / "bentod.sock"
    with pytest.raises(Disconnected, match="No such file"):
        async with Client.connect():
            pass
    with pytest.raises(Disconnected, match="No such file"):
        BlockingClient()


@pytest.mark.parametrize("mode", [0o770, 0o707, 0o1777])
async def test_in_a_shared_place_a_folder_that_others_write_to_is_not_trusted(
    shared: Path, mode: int
) -> None:
    shared.chmod(mode)
    with pytest.raises(ConfigError, match="could pose as your daemon"):
        async with Client.connect():
            pass
    with pytest.raises(ConfigError, match="could pose as your daemon"):
        BlockingClient(shared / "bentod.sock")


@pytest.mark.parametrize("which", ["folder", "socket"])
def test_in_a_shared_place_nothing_of_another_user_is_trusted(
    shared: Path, which: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    (shared / "bentod.sock").touch()
    stranger = shared if which == "folder" else shared / "bentod.sock"
    honest = Path.lstat

    def lstat(self: Path) -> os.stat_result:
        found = honest(self)
        return os.stat_result((*found[:4], 54321, *found[5:10])) if self == stranger else found

    monkeypatch.setattr(Path, "lstat", lstat)
    with pytest.raises(ConfigError, match=f"{stranger} belongs to user 54321, who may only pose"):
        BlockingClient()


def test_in_a_shared_place_a_link_is_not_followed(shared: Path, tmp_path: Path) -> None:
    (shared / "bentod.sock").symlink_to(tmp_path / "elsewhere")
    with pytest.raises(ConfigError, match="is a link"):
        BlockingClient()


def test_elsewhere_the_system_sees_to_it_that_folders_are_private(shared: Path, tmp_path: Path) -> None:
    tmp_path.chmod(0o770)
    with pytest.raises(Disconnected, match="No such file"):
        BlockingClient(tmp_path / "bentod.sock")


def test_a_file_without_a_certificate_is_a_config_error(tmp_path: Path) -> None:
    (tmp_path / "empty").touch()
    for name in ("empty", "none"):
        with pytest.raises(ConfigError, match="holds no certificate"):
            parse("tls://arm.lab").tls_context(tmp_path / name)


def test_a_client_checks_certificate_and_name() -> None:
    context = parse("tls://arm.lab").tls_context(None)
    assert context is not None
    assert (context.verify_mode, context.check_hostname) == (ssl.CERT_REQUIRED, True)
    assert context.minimum_version >= ssl.TLSVersion.TLSv1_2
    assert parse("tcp://127.0.0.1").tls_context(None) is None
