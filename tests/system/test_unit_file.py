import configparser
import shutil
import subprocess
from pathlib import Path

import pytest

UNIT = Path(__file__).parents[2] / "config" / "bentod.service"


def service() -> configparser.SectionProxy:
    parser = configparser.ConfigParser(strict=False, interpolation=None)
    parser.optionxform = str  # type: ignore[assignment, method-assign]  # the documented way to keep case
    parser.read(UNIT)
    return parser["Service"]


@pytest.mark.skipif(shutil.which("systemd-analyze") is None, reason="systemd-analyze is not installed")
def test_systemd_finds_nothing_wrong_with_the_unit() -> None:
    command = ["systemd-analyze", "verify", str(UNIT)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=50)
    assert (done.returncode, done.stderr) == (0, "")


def test_the_unit_waits_for_readiness_and_watches_the_tick() -> None:
    assert service()["Type"] == "notify"
    assert 0 < int(service()["WatchdogSec"]) <= 10
    assert service()["Restart"] == "on-failure"


def test_the_unit_gives_the_daemon_its_directories() -> None:
    assert service()["RuntimeDirectory"] == "bentod"
    assert service()["StateDirectory"] == "bentod"


def test_the_unit_lets_the_daemon_reach_unix_sockets_and_nothing_further() -> None:
    assert service()["RestrictAddressFamilies"] == "AF_UNIX"
