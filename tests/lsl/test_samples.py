import json
import math
from collections.abc import Iterator

import numpy as np
import pytest

from bentod.frames import Mode
from bentod.lsl.markers import events_stream, marker
from bentod.lsl.muscles import emg_stream, rate_of, samples_of, times_of
from bentod.lsl.state import HOLDERS, MODES, Layout, layout_of, state_stream
from bentod.lsl.stream import Table
from bentod.lsl.times import Clocks

ABOUT = {"manufacturer": "bentod"}
SITES: Table = {
    "rate_hz": 200.0,
    "sites": [
        {"name": "flexor", "channel": 0},
        {"name": "toggle", "channel": 2},
        {"name": "strong", "channel": 2},
    ],
}


def joint(name: str, **more: object) -> Table:
    told: dict[str, object] = {
        "name": name,
        "mode": "active",
        "torque": True,
        "position": 0.25,
        "velocity": -0.5,
        "load": 0.125,
        "age": 0.002,
        "freshness": "stale",
        "asked": {},
        "holder": "",
        "sent": {"kind": "stop"},
        "predictions": {"20": 0.5, "5": 0.375},
    }
    return told | more  # type: ignore[return-value]


def frame(*joints: Table) -> Table:
    return {
        "tick": 70,
        "time": 10.0,
        "read_at": 10.25,
        "lateness": 0.001,
        "mode": "paused",
        "whole": True,
        "assist": {"engaged": True},
        "trial": {"number": 3},
        "joints": list(joints),
    }


def sample(told: Table) -> dict[str, float]:
    """By label, as a recorder of the stream would have it."""
    layout = layout_of(told)
    labels = [channel.label for channel in layout.channels()]
    assert len(set(labels)) == len(labels)
    return dict(zip(labels, layout.sample(told)[0].tolist(), strict=True))


def test_a_sample_tells_what_the_frame_tells_of_the_arm_and_of_each_joint() -> None:
    told = sample(frame(joint("elbow"), joint("wrist", position=-1.0, torque=False)))
    assert told["tick"] == 70
    assert told["read_after"] == 0.25
    assert told["trial"] == 3
    assert MODES[int(told["mode"])] == "paused"
    assert told["whole"] == told["assist"] == 1
    assert (told["elbow.position"], told["wrist.position"]) == (0.25, -1.0)
    assert (told["elbow.torque"], told["wrist.torque"]) == (1, 0)
    assert (told["elbow.velocity"], told["elbow.load"], told["elbow.age"]) == (-0.5, 0.125, 0.002)
    assert (told["elbow.prediction_5"], told["elbow.prediction_20"]) == (0.375, 0.5)


def test_what_the_winner_asks_is_told_and_not_what_others_ask() -> None:
    asked = {
        "client": {"kind": "position", "position": 0.75, "speed": 0.5},
        "emg": {"kind": "velocity", "velocity": -0.25},
    }
    client = sample(frame(joint("elbow", asked=asked, holder="client:somebody: else")))
    assert (client["elbow.asked_position"], client["elbow.asked_speed"]) == (0.75, 0.5)
    assert math.isnan(client["elbow.asked_velocity"])
    assert HOLDERS[int(client["elbow.holder"])] == "client"
    emg = sample(frame(joint("elbow", asked=asked, holder="emg")))
    assert emg["elbow.asked_velocity"] == -0.25
    assert math.isnan(emg["elbow.asked_position"])


def test_where_nobody_asks_the_wish_is_no_number_and_a_stop_is_no_velocity() -> None:
    told = sample(frame(joint("elbow", holder="paused"), joint("wrist", sent=None)))
    assert math.isnan(told["elbow.asked_velocity"])
    assert HOLDERS[int(told["elbow.holder"])] == "paused"
    assert HOLDERS[int(told["wrist.holder"])] == "nobody"
    assert told["elbow.sent_velocity"] == 0
    assert math.isnan(told["wrist.sent_velocity"])


def test_every_mode_of_the_arm_has_a_code() -> None:
    codes = [sample(frame(joint("elbow", mode=mode.value)))["elbow.mode"] for mode in Mode]
    assert codes == list(range(len(Mode)))


def test_what_a_frame_lacks_is_no_number_and_nothing_moves_out_of_its_place() -> None:
    layout = layout_of(frame(joint("elbow"), joint("wrist")))
    values = layout.sample(
        {"tick": 71, "joints": [joint("wrist", position="?", mode="new", predictions={})]}
    )[0]
    told = dict(zip([channel.label for channel in layout.channels()], values.tolist(), strict=True))
    assert told["tick"] == 71
    assert told["wrist.velocity"] == -0.5
    for label in ("elbow.position", "wrist.position", "wrist.mode", "wrist.prediction_5", "trial", "mode"):
        assert math.isnan(told[label]), label


def test_a_layout_holds_frames_with_fewer_predictions_and_no_other_joints() -> None:
    layout = Layout(("elbow",), ("5", "20"))
    assert layout.holds(Layout(("elbow",), ("20",)))
    assert not layout.holds(Layout(("elbow",), ("20", "40")))
    assert not layout.holds(Layout(("wrist",), ("20",)))


def test_channels_say_their_unit_joint_and_codes() -> None:
    stream = state_stream(layout_of(frame(joint("elbow"))), "Arm", 30.0, ABOUT)
    told = {channel.label: channel for channel in stream.channels}
    assert (stream.source_id, stream.rate_hz, stream.format) == ("Arm/state", 30.0, "double64")
    assert (told["elbow.position"].unit, told["elbow.position"].joint) == ("radians", "elbow")
    assert told["elbow.velocity"].unit == "radians/second"
    assert told["elbow.mode"].codes == tuple(Mode)


def test_each_sample_of_a_block_has_the_time_of_its_block_whatever_was_lost_before() -> None:
    first: Table = {"first_index": 0, "time": 5.0, "samples": [[0.1, 0.2], [0.3, 0.4]]}
    second: Table = {"first_index": 90, "time": 5.5, "samples": [[0.5, 0.6]], "dropped": 88}
    times = [time for block in (first, second) for time in times_of(block, len(samples_of(block)), 200.0)]
    assert times == [5.0, 5.005, 5.5]
    assert np.array_equal(samples_of(first), np.array([[0.1, 0.2], [0.3, 0.4]], np.float32))


@pytest.mark.parametrize("block", [{}, {"samples": []}, {"samples": None}])
def test_a_block_without_samples_is_nothing(block: Table) -> None:
    assert samples_of(block).shape == (0, 0)


def test_muscles_have_the_names_of_their_sites_and_volts() -> None:
    stream = emg_stream(SITES, 3, "Arm", ABOUT)
    assert [channel.label for channel in stream.channels] == ["flexor", "channel_1", "toggle+strong"]
    assert {channel.unit for channel in stream.channels} == {"volts"}
    assert (stream.rate_hz, stream.format, stream.type) == (200.0, "float32", "EMG")


@pytest.mark.parametrize("sites", [None, {}, {"rate_hz": 0.0}, {"rate_hz": "fast"}])
def test_a_daemon_that_tells_no_rate_of_its_muscles_has_none(sites: Table | None) -> None:
    assert rate_of(sites) == 0


def test_a_marker_holds_all_of_an_event_but_its_time() -> None:
    event: Table = {
        "time": 3.0,
        "kind": "trial",
        "text": "α started\n",
        "data": {"number": 1, "raw": b"\x00"},
    }
    assert json.loads(marker(event)) == {
        "kind": "trial",
        "text": "α started\n",
        "data": {"number": 1, "raw": "b'\\x00'"},
    }
    assert events_stream("Arm", ABOUT).rate_hz == 0


def test_of_several_readings_of_the_clocks_the_quickest_counts() -> None:
    monotonic = iter([0.0, 1.0, 2.0, 2.01, 3.0, 3.5, 4.0, 4.5, 5.0, 5.5])
    lsl = iter([900.0, 102.105, 900.0, 900.0, 900.0])
    assert Clocks(lambda: next(lsl), lambda: next(monotonic)).offset() == pytest.approx(100.1)
    assert _is_empty(monotonic)


def _is_empty(left: Iterator[float]) -> bool:
    return next(left, None) is None
