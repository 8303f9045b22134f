"""`bentod bench`: what it shows and writes, and what it refuses; how late anything is decides no test."""

import json
import os
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from bentod.cli.bench import bench, idle_arm
from bentod.lateness.trial import CLOCK, DAEMON, SLEEP

pytestmark = pytest.mark.real_time


@pytest.fixture(autouse=True)
def short(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("bentod.lateness.trial.WARM_UP", 0.1)
    monkeypatch.setattr("bentod.cli.bench.ROUNDS", 1)


def measured(*words: str) -> Result:
    return CliRunner().invoke(bench, ["--seconds", "0.2", *words])


def test_every_way_to_tick_is_measured_idle_and_under_load(tmp_path: Path) -> None:
    file = tmp_path / "bench.json"
    result = measured("--rate", "100", "--load", "--json", str(file))
    assert result.exit_code == 0, result.output
    assert "100 Hz, idle" in result.output
    assert "100 Hz, under load" in result.output
    data = json.loads(file.read_text())
    assert {(run["way"], run["loaded"]) for run in data["runs"]} == {
        (way, loaded) for way in (DAEMON, CLOCK, SLEEP) for loaded in (False, True)
    }
    assert all(run["ticks"] > 0 for run in data["runs"])
    assert data["verdict"] in result.output


def test_a_core_that_there_is_not_is_refused_in_a_sentence() -> None:
    result = measured("--rate", "100", "--cpu", "1023")
    assert result.exit_code == 1
    assert "realtime.cpus = [1023] is refused" in result.output


def test_the_scheduling_is_as_it_was_afterwards() -> None:
    before = os.sched_getaffinity(0), os.sched_getscheduler(0)
    assert measured("--rate", "100", "--cpu", str(min(before[0]))).exit_code == 0
    assert (os.sched_getaffinity(0), os.sched_getscheduler(0)) == before


def test_nothing_real_is_ever_measured_with() -> None:
    config = idle_arm()
    assert config.driver is not None
    assert (config.driver.name, config.emg) == ("sim", None)
