"""The units: systemd accepts them, and finds them as closed as they say they are."""

import configparser
import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from bentod.config_tables import HIGHEST_PRIORITY

CONFIG = Path(__file__).parents[2] / "config"
UNIT, SOCKET = CONFIG / "bentod.service", CONFIG / "bentod.socket"
DROP_INS = sorted((CONFIG / "drop-ins").glob("*.conf"))

needs_systemd = pytest.mark.skipif(
    shutil.which("systemd-analyze") is None, reason="systemd-analyze is not installed"
)
with_each_drop_in = pytest.mark.parametrize(
    "drop_in", [None, *DROP_INS], ids=lambda path: getattr(path, "stem", "none")
)


def section(path: Path, name: str) -> configparser.SectionProxy:
    parser = configparser.ConfigParser(strict=False, interpolation=None)
    parser.optionxform = str  # type: ignore[assignment, method-assign]  # the documented way to keep case
    parser.read(path)
    return parser[name]


def service() -> configparser.SectionProxy:
    return section(UNIT, "Service")


def installed(folder: Path, drop_in: Path | None) -> Path:
    """The units as an administrator puts them, with a drop-in or without; the service's path."""
    for unit in (UNIT, SOCKET):
        shutil.copy(unit, folder)
    if drop_in:
        (folder / "bentod.service.d").mkdir()
        shutil.copy(drop_in, folder / "bentod.service.d")
    return folder / UNIT.name


def systemd_analyze(*words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(["systemd-analyze", *words], capture_output=True, text=True, timeout=50)


def promised(path: Path) -> float:
    """The exposure that a unit's or a drop-in's own comment gives."""
    found = re.search(r"an exposure of (\d+\.\d)", path.read_text())
    assert found, f"{path} promises nothing"
    return float(found[1])


@needs_systemd
@with_each_drop_in
def test_systemd_finds_nothing_wrong_with_the_units(tmp_path: Path, drop_in: Path | None) -> None:
    unit = installed(tmp_path, drop_in)
    done = systemd_analyze("verify", str(unit), str(tmp_path / SOCKET.name))
    assert (done.returncode, done.stderr) == (0, "")


@needs_systemd
@with_each_drop_in
def test_the_daemon_is_no_more_exposed_than_the_unit_says(tmp_path: Path, drop_in: Path | None) -> None:
    exposure = promised(drop_in or UNIT)
    unit = installed(tmp_path, drop_in)
    threshold = f"--threshold={exposure * 10:.0f}"  # in tenths
    done = systemd_analyze("security", "--offline=yes", threshold, "--no-pager", str(unit))
    assert done.returncode == 0, done.stdout + done.stderr


@needs_systemd
def test_what_is_left_open_is_what_the_unit_names(tmp_path: Path) -> None:
    unit = installed(tmp_path, None)
    done = systemd_analyze("security", "--offline=yes", "--json=short", "--no-pager", str(unit))
    left = {entry["json_field"] for entry in json.loads(done.stdout) if not entry["set"]}
    assert left <= LEFT_OPEN, sorted(left - LEFT_OPEN)


LEFT_OPEN = {
    "PrivateDevices",
    "DeviceAllow",
    "PrivateUsers",
    "RestrictAddressFamilies_AF_UNIX",
    "RootDirectoryOrRootImage",
}


def test_the_readme_tells_the_same_exposure() -> None:
    readme = (CONFIG.parent / "README.md").read_text()
    assert f"exposure of {promised(UNIT)}" in readme


def test_the_unit_waits_for_readiness_and_watches_the_tick() -> None:
    assert service()["Type"] == "notify"
    assert 0 < int(service()["WatchdogSec"]) <= 10
    assert service()["Restart"] == "on-failure"


def test_the_unit_gives_the_daemon_a_place_for_its_state() -> None:
    assert service()["StateDirectory"] == "bentod"


def test_the_unit_lets_the_daemon_reach_unix_sockets_and_nothing_further() -> None:
    assert service()["RestrictAddressFamilies"] == "AF_UNIX"
    assert service()["PrivateNetwork"] == "yes"


def test_clients_can_be_told_apart_because_their_users_are_the_hosts() -> None:
    assert "PrivateUsers" not in service()


def test_the_socket_is_for_its_group_and_ends_with_the_service() -> None:
    socket = section(SOCKET, "Socket")
    assert (socket["SocketMode"], socket["SocketGroup"]) == ("0660", service()["Group"])
    assert int(socket["DirectoryMode"], 8) & 0o022 == 0
    assert section(SOCKET, "Unit")["PartOf"] == UNIT.name
    assert section(UNIT, "Unit")["Requires"] == SOCKET.name
    assert section(UNIT, "Install")["Also"] == SOCKET.name


def test_a_config_with_realtime_may_have_what_it_asks_for() -> None:
    settings = section(CONFIG / "drop-ins" / "realtime.conf", "Service")
    assert settings["RestrictRealtime"] == "no"
    assert settings["LimitMEMLOCK"] == "infinity"
    assert int(settings["LimitRTPRIO"]) == HIGHEST_PRIORITY
    assert words(settings["SystemCallFilter"]) >= {"sched_setscheduler", "sched_setaffinity"}


def words(setting: str) -> set[str]:
    return set(setting.split())
