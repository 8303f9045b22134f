"""The live view as text: what a person sees of a frame, in no more columns than were promised."""

import re
from collections.abc import Mapping
from dataclasses import replace

import pytest

from bentod.cli.show import state_text
from bentod.cli.view import WIDTH, Aside, lines, screen
from bentod.cli.view_joints import Range
from bentod.frames import (
    AssistFrame,
    Costs,
    EmgFrame,
    Frame,
    Freshness,
    GoalFrame,
    GroupFrame,
    JointFrame,
    LearnFrame,
    Mode,
    Trial,
)
from bentod.framing import Limits
from bentod.messages import Decoder, Notification, encode_notification
from tests.rig import Table, table

ESCAPE = re.compile(r"\x1b\[[0-9;]*m")
RANGES = {"shoulder_rotation": Range(-1.0, 1.0), "elbow_flexion": Range(0.0, 2.0)}
RED = "\x1b[31;1m"


JOINT = JointFrame(
    name="shoulder_rotation",
    mode=Mode.ACTIVE,
    torque=True,
    position=0.0,
    velocity=0.0,
    load=0.0,
    voltage=12.0,
    temperature=30.0,
    age=0.0,
    freshness=Freshness.FRESH,
    errors=(),
    stop=None,
    asked={},
    holder="emg",
    sent=None,
    limited="",
    predictions={"10": 0.1, "20": 0.5},
)

FRAME = Frame(
    tick=1234,
    time=41.0,
    wall=0.0,
    lateness=0.00042,
    missed=3,
    costs=Costs(0.0, 0.0, 0.0, 0.0),
    shed=0,
    rate_hz=30.0,
    mode=Mode.ACTIVE,
    fault="",
    joints=(JOINT, replace(JOINT, name="elbow_flexion")),
    emg=EmgFrame(True, False, "", 800, 0.005, 0, {"flexor": 0.62, "extensor": 0.0}, 4),
    groups=(GroupFrame("arm", ("shoulder_rotation", "elbow_flexion"), "shoulder_rotation", 0.6, "emg"),),
    assist=AssistFrame("dpcc", True, "Moves elbow_flexion to where the operator usually has it."),
    goal=None,
    meta=None,
)


def received(frame: Frame) -> Table:
    """The frame as a client gets it."""
    decoder = Decoder(Limits(size=2**20, items=2**16))
    decoder.feed(encode_notification("state", [frame]))
    message = next(decoder)
    assert isinstance(message, Notification)
    assert isinstance(message.params, list)
    return table(message.params[0])


def drawn(frame: Frame, *events: str, ranges: Mapping[str, Range] = RANGES) -> list[str]:
    return lines(received(frame), ranges, events)


def seen(frame: Frame, *events: str, ranges: Mapping[str, Range] = RANGES) -> list[str]:
    """What is left of the lines on a screen."""
    return [ESCAPE.sub("", line) for line in drawn(frame, *events, ranges=ranges)]


def row(joint: JointFrame, ranges: Mapping[str, Range] = RANGES) -> str:
    """The line of one joint."""
    return seen(replace(FRAME, joints=(joint,)), ranges=ranges)[3]


def bar(joint: JointFrame, ranges: Mapping[str, Range] = RANGES) -> str:
    found = re.search(r"[·●○]{17}", row(joint, ranges))
    assert found
    return found[0]


def line_of(frame: Frame, word: str) -> str:
    """The only line that begins with `word`; empty if there is none."""
    found = [line for line in seen(frame) if line.split()[:1] == [word]]
    assert len(found) <= 1
    return "".join(found)


def test_the_first_line_says_how_the_arm_and_its_tick_are() -> None:
    assert seen(FRAME)[0] == "  ACTIVE     tick 1234   30 Hz   late  0.42 ms   missed 3"


def test_each_joint_has_angle_velocity_mode_expectation_and_mover_in_degrees() -> None:
    moving = replace(JOINT, position=0.5, velocity=-0.25, holder="client:ctl")
    assert row(moving).split() == [
        "▸", "shoulder_rotation", "+28.6°", bar(moving), "-14.3°/s", "active", "+28.6°", "client:ctl",
    ]  # fmt: skip


def test_only_the_joint_that_the_wearer_has_selected_is_marked() -> None:
    assert [line.startswith("  ▸ ") for line in seen(FRAME)[3:5]] == [True, False]
    assert "▸" not in "".join(seen(replace(FRAME, groups=())))


def test_all_joints_are_marked_while_they_are_selected_together_and_the_offer_is_told() -> None:
    together = replace(FRAME, groups=(replace(FRAME.groups[0], together=True),))
    assert [line.startswith("  ▸ ") for line in seen(together)[3:5]] == [True, True]
    assert line_of(together, "together") == "  together  push to go on, pull to go back, toggle to leave"
    offered = replace(FRAME, assist=replace(FRAME.assist, offers_together=True))
    assert line_of(offered, "together") == "  together  may be selected"
    assert line_of(FRAME, "together") == ""


def test_a_state_in_words_says_what_is_selected_and_what_the_assist_does() -> None:
    moving = replace(FRAME.assist, group="arm", moving={"elbow_flexion": -0.5})
    told = state_text(dict(received(replace(FRAME, assist=moving)))).splitlines()
    assert "arm: shoulder_rotation" in told[0]
    assert told[-1] == f"  assist dpcc arm: {FRAME.assist.reason}   elbow_flexion -28.6°/s"
    group, offering = (
        replace(FRAME.groups[0], together=True),
        replace(moving, moving={}, offers_together=True),
    )
    told = state_text(dict(received(replace(FRAME, groups=(group,), assist=offering)))).splitlines()
    assert "arm: all together" in told[0]
    assert told[-1].endswith("   (all together may be selected)")


@pytest.mark.parametrize(
    ("position", "expected", "cells"),
    [
        (-1.0, 1.0, "●···············○"),
        (0.0, 0.1, "········●○·······"),
        (0.5, 0.5, "············●····"),
        (-7.0, 7.0, "●···············○"),
        (0.0, float("nan"), "········●········"),
        (float("nan"), 0.0, "········○········"),
    ],
)
def test_the_bar_shows_where_a_joint_is_and_is_expected_between_its_limits(
    position: float, expected: float, cells: str
) -> None:
    assert bar(replace(JOINT, position=position, predictions={"20": expected})) == cells


def test_the_bar_of_a_joint_of_unknown_limits_is_empty() -> None:
    assert bar(JOINT, ranges={}) == "·" * 17


def test_a_joint_that_is_not_predicted_has_a_dash() -> None:
    assert row(replace(JOINT, predictions={})).split()[-2:] == ["–", "emg"]


def test_the_farthest_prediction_is_the_one_that_is_shown() -> None:
    assert "+28.6°" in row(replace(JOINT, predictions={"10": 0.1, "20": 0.5}))


@pytest.mark.parametrize(
    ("freshness", "age", "told"),
    [
        (Freshness.STALE, 0.34, "stale 0.3 s"),
        (Freshness.LOST, 12.0, "lost 12.0 s"),
        (Freshness.LOST, float("inf"), "lost inf s"),
    ],
)
def test_a_joint_that_does_not_answer_says_for_how_long_instead_of_who_moves_it(
    freshness: Freshness, age: float, told: str
) -> None:
    assert row(replace(JOINT, freshness=freshness, age=age)).endswith(f"  {told}")


def test_a_fault_is_told_in_red_below_the_first_line() -> None:
    faulted = replace(FRAME, mode=Mode.FAULT, fault="no answer from any joint: the cable is pulled")
    assert seen(faulted)[:2][1] == "  no answer from any joint: the cable is pulled"
    assert [line.startswith(f"  {RED}") for line in drawn(faulted)[:2]] == [True, True]
    assert seen(FRAME)[1] == ""
    assert RED not in "".join(drawn(FRAME))


def test_a_fault_is_whole_in_a_small_window_and_says_the_way_back() -> None:
    why = (
        "no answer for more than 0.5 s from any joint (0.53 s): Serial port /dev/ttyUSB0: is the adapter in?"
    )
    shown = window(
        replace(FRAME, mode=Mode.FAULT, fault=why), aside=Aside(group="arm", foot=["said", "keys"])
    )
    assert f"{shown[1].strip()} {shown[2].strip()}" == why
    assert shown[3] == "  → bentod ctl clear-fault, then p"
    assert max(map(len, shown)) <= 80
    assert shown[-1] == "keys"


def test_a_fault_that_never_ends_takes_two_lines() -> None:
    shown = window(replace(FRAME, fault="it burns and " * 40))
    assert shown[2].endswith(" …")
    assert shown[3] == "  → bentod ctl clear-fault, then bentod ctl pause off"


def test_efforts_are_gauges_beside_the_count_of_toggles() -> None:
    assert line_of(FRAME, "muscles") == "  muscles   flexor ██████░░░░   extensor ░░░░░░░░░░   toggles 4"


def test_paused_muscles_are_marked() -> None:
    paused = replace(FRAME, emg=replace(FRAME.emg, paused=True))
    assert line_of(paused, "muscles").endswith("   (paused)")


def test_muscles_that_cannot_be_heard_are_a_sentence() -> None:
    without = replace(FRAME, emg=EmgFrame(False, False, "The config has no [emg] table.", 0, 0.0, 0, {}, 0))
    assert line_of(without, "muscles") == "  muscles   The config has no [emg] table."


def test_what_the_assist_does_is_a_sentence() -> None:
    assert line_of(FRAME, "assist") == "  assist    " + FRAME.assist.reason


@pytest.mark.parametrize(
    ("goal", "told"),
    [
        (None, ""),
        (GoalFrame(1, "go_home", "moving", 0.456), "  go_home   moving 46%"),
        (GoalFrame(1, "go_home", "done", 1.0), "  go_home   done 100%"),
        (GoalFrame(2, "go_home", "cancelled", 0.5, "a sign"), "  go_home   cancelled 50%: a sign"),
    ],
)
def test_a_goal_is_shown_with_its_progress_and_the_reason_of_its_end(
    goal: GoalFrame | None, told: str
) -> None:
    assert line_of(replace(FRAME, goal=goal), "go_home") == told


def test_events_stand_at_the_end_oldest_first() -> None:
    assert seen(FRAME, "10:00  first", "10:01  second")[-2:] == ["  10:00  first", "  10:01  second"]


def test_no_line_is_wider_than_the_view_whatever_is_told_about_the_arm() -> None:
    long = "x" * 300
    joints = tuple(
        replace(
            JOINT,
            name=name,
            mode=mode,
            position=-3.1,
            velocity=-9.9,
            predictions={"20": -3.1},
            holder="client:ctl",
        )
        for name, mode in (("shoulder_rotation", Mode.HOLDING), ("elbow_flexion", Mode.FAULT))
    )
    crowded = replace(
        FRAME,
        tick=10**8,
        missed=10**6,
        lateness=123.0,
        mode=Mode.HOLDING,
        fault=long,
        joints=joints,
        goal=GoalFrame(9, "go_home", "cancelled", 0.999, "not there in time, 0.123 rad are left"),
    )
    assert max(len(line) for line in seen(crowded, long, long)) <= WIDTH


def window(
    frame: Frame, *events: str, aside: Aside | None = None, width: int = 80, height: int = 24
) -> list[str]:
    """What is left of a window's lines on a screen."""
    shown = screen(received(frame), RANGES, events, aside or Aside(foot=["said", "keys"]), width, height)
    return [ESCAPE.sub("", line) for line in shown]


def test_how_sure_an_expectation_is_stands_beside_it() -> None:
    sure = LearnFrame(
        confidence={"shoulder_rotation.position@20": 0.774, "shoulder_rotation.position@10": 0.9}
    )
    shown = seen(replace(FRAME, joints=(JOINT,), learn=sure))[3]
    assert "+28.6°  77%  emg" in shown


def test_each_group_says_what_is_active_in_it_and_who_moves_it_how_much() -> None:
    assert line_of(FRAME, "arm") == "  arm       shoulder rotation   +60% by emg"
    idle = replace(FRAME, groups=(replace(FRAME.groups[0], operator="", effort=0.0),))
    assert line_of(idle, "arm") == "  arm       shoulder rotation   nobody moves it"


def test_the_hottest_joint_and_whoever_is_silent_are_told() -> None:
    hot = replace(JOINT, name="gripper", temperature=61.4, voltage=11.6, freshness=Freshness.LOST)
    told = line_of(replace(FRAME, joints=(JOINT, hot)), "health")
    assert told == "  health    hottest gripper 61 °C   supply 11.6 V   silent: gripper"


def test_the_trial_that_runs_is_shown_with_its_time() -> None:
    running = replace(FRAME, trial=Trial(3, "circuit", "dpcc", FRAME.time - 83.0))
    assert line_of(running, "trial") == "  trial     3 (circuit, dpcc)   1:23"


@pytest.mark.parametrize(
    ("told", "shown"),
    [
        ({}, ""),
        ({"recording": False, "problem": ""}, "  recording ■ nothing is recorded"),
        ({"recording": False, "problem": "The disk is full."}, "  recording ■ The disk is full."),
        (
            {
                "recording": True,
                "problem": "",
                "file": "/a/b.mcap",
                "bytes": 2.5e6,
                "dropped": 0,
                "duration_s": 3725.0,
            },
            "  recording ● 1:02:05   2.5 MB   nothing lost   b.mcap",
        ),
        (
            {"recording": True, "problem": "", "file": "b.mcap", "bytes": 0, "dropped": 7, "duration_s": 5.0},
            "  recording ● 0:05   0.0 MB   7 entries lost   b.mcap",
        ),
    ],
)
def test_the_recording_is_told_with_what_is_missing_from_it(told: Table, shown: str) -> None:
    found = [line for line in window(FRAME, aside=Aside(recording=told)) if line.startswith("  recording")]
    assert "".join(found) == shown


def test_a_small_window_keeps_the_joints_and_the_keys_and_the_newest_events() -> None:
    five = replace(
        FRAME, joints=tuple(replace(JOINT, name=f"joint_{n}", holder="client:page") for n in range(5))
    )
    shown = window(five, *(f"event {n}" for n in range(30)), width=80, height=24)
    assert len(shown) == 24
    assert max(map(len, shown)) <= 80
    assert shown[-3:] == ["  event 29", "said", "keys"]
    assert sum("client:pag" in line for line in shown) == 5


@pytest.mark.parametrize(("width", "height"), [(20, 5), (1, 1), (40, 10), (200, 60)])
def test_a_window_of_any_size_is_filled_and_not_more(width: int, height: int) -> None:
    shown = window(FRAME, "event", width=width, height=height)
    assert len(shown) == height
    assert max(map(len, shown)) <= width
