"""The shipped udev rule."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest

RULES = Path(__file__).parents[3] / "config" / "99-bentod-dynamixel.rules"
TERM = re.compile(r'(?P<key>[A-Z]+(\{[A-Za-z_]+\})?)(?P<sign>==|=)"(?P<value>[^"]*)"')


def terms() -> dict[str, tuple[str, str]]:
    """Of the one rule: sign and value by key."""
    lines = RULES.read_text(encoding="utf-8").splitlines()
    (rule,) = [line for line in lines if line and not line.startswith("#")]
    matches = [TERM.fullmatch(part) for part in rule.split(", ")]
    assert all(matches)
    return {match["key"]: (match["sign"], match["value"]) for match in matches if match}


def test_the_rule_sets_one_thing_and_only_for_ftdi_adapters() -> None:
    found = terms()
    assert [key for key, (sign, _) in found.items() if sign == "="] == ["ATTR{latency_timer}"]
    assert found["ATTR{latency_timer}"] == ("=", "1")
    assert found["ATTRS{idVendor}"] == ("==", "0403")
    assert found["DRIVER"] == ("==", "ftdi_sio")


def test_the_rule_knows_the_u2d2() -> None:
    assert "6014" in terms()["ATTRS{idProduct}"][1].split("|")


@pytest.mark.skipif(shutil.which("udevadm") is None, reason="udevadm is not installed")
def test_udev_finds_nothing_wrong_with_the_rule() -> None:
    done = subprocess.run(["udevadm", "verify", str(RULES)], capture_output=True, text=True, timeout=30)
    if "Unknown command" in done.stderr:
        pytest.skip("this udevadm cannot verify")
    assert done.returncode == 0, done.stdout + done.stderr
