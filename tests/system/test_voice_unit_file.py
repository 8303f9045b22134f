"""The unit of the voice: systemd accepts it, and the voice has no hold on the daemon."""

import configparser
import shutil
import subprocess
from pathlib import Path

import pytest

UNIT = Path(__file__).parents[2] / "config" / "bentod-voice.service"


def section(name: str) -> configparser.SectionProxy:
    parser = configparser.ConfigParser(strict=False, interpolation=None)
    parser.optionxform = str  # type: ignore[assignment, method-assign]  # the documented way to keep case
    parser.read(UNIT)
    return parser[name]


@pytest.mark.skipif(shutil.which("systemd-analyze") is None, reason="systemd-analyze is not installed")
def test_systemd_finds_nothing_wrong_with_the_unit(tmp_path: Path) -> None:
    shutil.copy(UNIT, tmp_path)
    command = ["systemd-analyze", "--user", "verify", str(tmp_path / UNIT.name)]
    variables = {"PATH": "/usr/bin:/bin", "XDG_RUNTIME_DIR": str(tmp_path), "HOME": str(tmp_path)}
    done = subprocess.run(command, capture_output=True, text=True, timeout=50, env=variables)
    assert (done.returncode, done.stderr) == (0, "")


def test_the_voice_is_no_part_of_the_daemon() -> None:
    assert not {"Requires", "BindsTo", "PartOf"} & set(section("Unit"))
    assert int(section("Service")["Nice"]) > 0
    assert section("Service")["Restart"] == "on-failure"
    assert section("Service")["NoNewPrivileges"] == "yes"


def test_the_voice_finds_the_daemon_where_its_socket_unit_has_it() -> None:
    assert section("Service")["Environment"] == "BENTOD_SOCKET=/run/bentod/bentod.sock"
    assert section("Service")["ExecStart"].endswith("bentod voice")
