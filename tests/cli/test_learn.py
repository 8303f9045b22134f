"""`bentod learn`: what it says of snapshots and recordings, and how it ends."""

import asyncio
import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result
from numpy.typing import NDArray

from bentod.analysis.extras import MissingExtra, load_extra
from bentod.cli import learn as command
from bentod.config_tables import Record
from bentod.frames import Value
from bentod.learn.snapshot import read, taken, write
from bentod.record.reader import Recording
from bentod.replay.sweep import Outcome, Point
from sim.clock import VirtualLoop
from tests.cli.results import refused
from tests.rig import PLAIN, running, sim_config


class Counting:
    """Learners that know how many ticks they have seen, and the sum of a joint's angles."""

    def __init__(self, lam: float = 0.95) -> None:
        self.lam, self.known = lam, np.zeros(2)

    def spec(self) -> dict[str, Value]:
        asked: Value = {"name": "elbow@20", "cumulant": "elbow.position", "lam": self.lam}
        return {"questions": [asked], "representations": {"arm": {"tilings": 100}}, "precision": "float64"}

    def memory(self) -> dict[str, NDArray[np.float64]]:
        return {"known": self.known.copy()}

    def recall(self, spec: Mapping[str, Value], memory: Mapping[str, NDArray[np.float64]]) -> list[str]:
        raise NotImplementedError


def run(*arguments: object) -> Result:
    return CliRunner().invoke(command.learn, [str(argument) for argument in arguments])


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Six seconds of the simulated arm."""
    folder = tmp_path_factory.mktemp("learn")
    config = sim_config(PLAIN).model_copy(update={"record": Record(folder=folder / "recordings")})

    async def act() -> None:
        async with running(config, folder / "live.sock"):
            await asyncio.sleep(6)

    with asyncio.Runner(loop_factory=VirtualLoop) as runner:
        runner.run(act())
    return folder / "recordings"


@pytest.fixture
def snapshot(tmp_path: Path) -> Path:
    write(tmp_path / "one", taken(Counting(), "Bento Arm", 1_700_000_000.0, 900))
    return tmp_path / "one"


def test_show_tells_what_a_snapshot_answers_and_when_it_was_taken(snapshot: Path) -> None:
    text = run("show", snapshot).output
    assert "taken    2023-11-14 22:13:20 UTC, tick 900, of Bento Arm, by bentod" in text
    assert "holds    1 questions, 1 arrays of 2 numbers" in text
    assert "representation arm: tilings 100" in text
    assert "precision: float64" in text
    rows = [line.split() for line in text.splitlines()]
    assert ["question", "cumulant", "lam"] in rows
    assert ["elbow@20", "elbow.position", "0.95"] in rows
    assert ["known", "float64", "2", "16", "0", "0", "0"] in rows
    told = json.loads(run("show", snapshot, "--json").stdout)
    assert told["arrays"] == {"known": [2]}
    assert told["header"]["arm"] == "Bento Arm"


def test_show_lists_thousands_only_if_asked(tmp_path: Path) -> None:
    learners = Counting()
    arrays = {f"a{i}": np.zeros(1) for i in range(100)}
    learners.memory = lambda: arrays  # type: ignore[method-assign]
    write(tmp_path / "s", taken(learners, "Bento", 0.0, 0))
    assert "… and 60 more; --all lists them" in run("show", tmp_path / "s").output
    assert "a99" in run("show", tmp_path / "s", "--all").output


def test_show_refuses_what_is_broken_in_a_sentence(snapshot: Path) -> None:
    snapshot.write_bytes(snapshot.read_bytes()[:-1])
    assert "it is cut off: 1 of 16 bytes" in refused(run("show", snapshot))


def test_diff_names_what_differs_and_ends_like_diff(snapshot: Path, tmp_path: Path) -> None:
    same = run("diff", snapshot, snapshot)
    assert (same.exit_code, "equal bit for bit" in same.output) == (0, True)
    other = Counting(0.9)
    other.known[1] = 0.25
    write(tmp_path / "other", taken(other, "Bento Arm", 0.0, 900))
    found = run("diff", snapshot, tmp_path / "other")
    assert found.exit_code == 1
    assert found.output.splitlines() == [
        f"the question elbow@20 is asked with λ 0.95 in {snapshot}, 0.9 in {tmp_path / 'other'}",
        "the array known: 1 of 2 numbers differ, by at most 0.25",
    ]


def test_replay_says_whether_all_was_thought_as_it_was_live(recording: Path) -> None:
    same = run("replay", recording)
    assert same.output.startswith("Bit for bit what was thought live.\n")
    assert "root mean square error" in same.output
    other = run("replay", recording, "--set", "learn.step_size=0.1")
    assert other.output.startswith("Not what was thought live.\n")


def test_what_is_learned_from_a_recording_is_kept_the_same_each_time_and_gone_on_from(
    recording: Path, tmp_path: Path
) -> None:
    one, two, three = (tmp_path / name for name in ("one", "two", "three"))
    for path in (one, two):
        done = run("replay", recording, "--snapshot", path)
        assert done.exit_code == 0, done.output
    assert one.read_bytes() == two.read_bytes()
    with Recording(recording) as found:
        assert read(one).header["tick"] == list(found.frames())[-1].tick
    again = run("replay", recording, "--from", one, "--snapshot", three)
    assert "Not what was thought live." in again.output
    assert "begin anew" not in again.output
    assert "numbers differ" in run("diff", one, three).output
    other = run("replay", recording, "--set", "learn.trace_lambda=0.9", "--from", one)
    assert other.output.splitlines()[:2] == [
        "These begin anew:",
        "the question shoulder_rotation.position@10 is asked with λ 0.9 here, 0.95 in the snapshot",
    ]
    told = refused(run("replay", recording, "--set", "learn.tilings=64", "--from", one))
    assert f"{one} cannot be gone on with: " in told
    assert "representation arm" in told


@pytest.fixture
def here(monkeypatch: pytest.MonkeyPatch) -> None:
    """The pool does its work in this process."""

    def run_here(
        jobs: int, work: Callable[[Point], Outcome], tried: Sequence[Point], told: Callable[[Outcome], None]
    ) -> list[Outcome]:
        found = [work(point) for point in tried]
        for outcome in reversed(found):
            told(outcome)
        return found

    monkeypatch.setattr(
        command, "load_extra", lambda target, *_: run_here if "pool" in target else load_extra(target)
    )


@pytest.mark.usefixtures("here")
def test_a_sweep_is_a_table_a_csv_and_a_figure(recording: Path, tmp_path: Path) -> None:
    arguments = ("--set", "learn.step_size=0.1,0.3", "--out", tmp_path / "out")
    done = run("sweep", recording, *arguments)
    assert done.exit_code == 0, done.output
    rows = [line.split() for line in done.stdout.splitlines()]
    assert rows[0][:4] == ["learn.step_size", "of", "live", "shoulder_rotation@10"]
    assert rows[2][:2] == ["0.3", "1.0000"]
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"sweep.csv", "sweep.png"}
    assert "1 of 2: learn.step_size=0.1" in done.stderr


@pytest.mark.usefixtures("here")
def test_a_sweep_that_cannot_be_is_refused_before_anything_runs(recording: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    assert "learn.step_size" in refused(
        run("sweep", recording, "--set", "learn.step_size=0.1,7", "--out", out)
    )
    assert not out.exists()
    assert "stands twice" in refused(run("sweep", recording, "--set", "a.b=1", "--set", "a.b=2"))


def test_what_is_not_installed_is_named(recording: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(target: str, extra: str = "analysis") -> object:
        raise MissingExtra(f"{target} needs {extra}")

    monkeypatch.setattr(command, "load_extra", missing)
    tried = ("--set", "learn.step_size=0.1")
    assert "sweep_pool:run needs sweep" in refused(run("sweep", recording, *tried))
    assert "sweep_cluster:run needs" in refused(run("sweep", recording, *tried, "--scheduler", "tcp://c:1"))
