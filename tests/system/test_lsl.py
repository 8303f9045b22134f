"""`bentod lsl` as a process: what others on the network record is what a client of the socket gets."""

import json
import os
import signal
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType
from typing import cast

import numpy as np
import pytest

from tests.rig import Table, joint
from tests.system.processes import BENTOD, Child, DaemonProcess, daemon, environment, eventually, started

pytestmark = [pytest.mark.real_time, pytest.mark.timeout(180)]

SIM = ("--config", "sim.toml")
ARM = "Bento Arm (simulated)"


class Inlet:
    """A stream as a recorder keeps it."""

    def __init__(self, pylsl: ModuleType, source_id: str) -> None:
        found = eventually(lambda: pylsl.resolve_byprop("source_id", source_id, 1, 1.0))
        self._inlet = pylsl.StreamInlet(found[0])
        self._inlet.open_stream(10)
        self.rows: list[list[float] | list[str]] = []
        self.times: list[float] = []

    def pull(self) -> int:
        """Take what has come; how many samples there are so far."""
        rows, times = self._inlet.pull_chunk(0.0, 100_000)
        self.rows += rows
        self.times += times
        return len(self.rows)

    def described(self, key: str) -> list[str]:
        """A value of every channel's description."""
        found = []
        channel = self._inlet.info().desc().child("channels").child("channel")
        while not channel.empty():
            found.append(channel.child_value(key))
            channel = channel.next_sibling("channel")
        return found

    def values(self) -> "np.ndarray[tuple[int, int], np.dtype[np.float64]]":
        return np.array(self.rows, dtype=float)

    def at(self, time: float) -> int:
        """The sample nearest to `time` (s of LSL's clock)."""
        return int(np.abs(np.array(self.times) - time).argmin())


@contextmanager
def streaming(folder: Path) -> Iterator[Child]:
    """`bentod lsl` under way."""
    command = [*BENTOD, "lsl", "--socket", str(folder / "bentod.sock")]
    variables = environment(folder, LSLAPICFG=os.environ["LSLAPICFG"])
    with (folder / "lsl.log").open("ab") as log, started(command, variables, log) as child:
        yield child


def heard(process: DaemonProcess, seconds: float) -> dict[str, list[Table]]:
    """What the socket tells meanwhile, by topic; a trial is started in it."""
    told: dict[str, list[Table]] = {"state": [], "emg": [], "event": []}
    with process.client() as arm:
        for topic in ("state", "emg", "events"):
            arm.call("subscribe", topic=topic, rate_hz=500)
        arm.call("trial_start", name="circuit", condition="dpcc")
        end = time.monotonic() + seconds
        for notification in arm.notifications(5):
            told[notification.method] += cast("list[Table]", notification.params)
            if time.monotonic() > end:
                break
        arm.call("trial_stop")
    return told


def test_what_is_recorded_from_the_network_is_what_the_socket_tells(
    pylsl: ModuleType, tmp_path: Path
) -> None:
    with streaming(tmp_path) as child:
        with daemon(tmp_path, *SIM) as process:
            state, emg, events = (Inlet(pylsl, f"{ARM}/{name}") for name in ("state", "emg", "events"))
            told = heard(process, 2.0)
            last = max(cast("float", entry["time"]) for entry in told["state"])
            eventually(lambda: state.pull() and state.times[-1] > last)
            eventually(lambda: emg.pull() and emg.times[-1] > last)
            eventually(lambda: events.pull() >= len(told["event"]))
            frames_agree(state, told["state"])
            samples_agree(emg, told["emg"])
            markers_agree(events, told["event"])
            assert emg.described("unit") == ["volts"] * 3
            ticks = state.values()[:, 0]
            assert process.ends(signal.SIGTERM) == 0
        with daemon(tmp_path, *SIM):  # the same inlet goes on
            eventually(lambda: state.pull() and state.values()[-1, 0] < ticks[-1], 60)
        child.send_signal(signal.SIGTERM)
        assert child.wait(20) == 0, (tmp_path / "lsl.log").read_text()


def frames_agree(inlet: Inlet, frames: list[Table]) -> None:
    labels, values = inlet.described("label"), inlet.values()
    rows = {
        row[0]: (time, dict(zip(labels, row, strict=True)))
        for time, row in zip(inlet.times, values, strict=True)
    }
    assert len(frames) > 20
    for frame in frames:
        time, row = rows[cast("float", frame["tick"])]
        assert time == pytest.approx(cast("float", frame["time"]), abs=1e-4)
        for name in ("shoulder_rotation", "elbow_flexion", "gripper"):
            for key in ("position", "velocity", "load"):
                assert row[f"{name}.{key}"] == joint(frame, name)[key]
    assert inlet.described("unit")[labels.index("gripper.position")] == "radians"


def samples_agree(inlet: Inlet, blocks: list[Table]) -> None:
    values = inlet.values()
    assert len(blocks) > 20
    for block in blocks:
        time, samples = cast("float", block["time"]), cast("list[list[float]]", block["samples"])
        first = inlet.at(time)
        assert values[first : first + len(samples)].tolist() == samples
        expected = [time + index / 200 for index in range(len(samples))]
        assert inlet.times[first : first + len(samples)] == pytest.approx(expected, abs=1e-4)


def markers_agree(inlet: Inlet, events: list[Table]) -> None:
    trials = [event for event in events if event["kind"] == "trial"]
    assert trials
    for event in trials:
        row = inlet.rows[inlet.at(cast("float", event["time"]))]
        told = json.loads(cast("str", row[0]))
        assert told == {key: event[key] for key in ("kind", "text", "data")}
