"""Every value of a tick has a column, and each column holds what its name says."""

from collections.abc import Sequence
from dataclasses import replace

import pytest

from bentod.analysis import words
from bentod.analysis.columns import RESERVED, Cell, TickColumns, as_json
from bentod.frames import Frame, Freshness, GoalFrame, JointFrame, Mode, Position, Stop, StopReport, Velocity
from tests.analysis.helpers import frames, one_frame, session

JOINTS = ["shoulder_rotation", "elbow_flexion", "wrist_rotation", "wrist_flexion", "gripper"]


def cells(
    *given: Frame, joints: Sequence[str] = JOINTS, examples: Sequence[Frame] = ()
) -> dict[str, list[Cell]]:
    columns = TickColumns(joints, examples or given)
    return {c.name: list(v) for c, v in zip(columns.columns, columns.cells(given), strict=True)}


def test_no_two_columns_have_one_name() -> None:
    names = [column.name for column in TickColumns(JOINTS, frames(session())).columns]
    assert len(names) == len(set(names))


def test_every_value_is_described_and_quantities_carry_their_unit() -> None:
    for column in TickColumns(JOINTS, frames(session())).columns:
        assert column.meaning != words.UNKNOWN.meaning, column.name
        if column.kind == "float" and column.unit and ".prediction." not in column.name:
            assert column.name.endswith(words.SUFFIXES[column.unit]), column.name


def test_a_tick_is_one_flat_row() -> None:
    frame = one_frame()
    elbow = frame.joints[1]
    row = {name: values[0] for name, values in cells(frame).items()}
    assert row["tick"] == frame.tick
    assert row["lateness_s"] == frame.lateness
    assert row["costs.read_s"] == frame.costs.read
    assert row["elbow_flexion.position_rad"] == elbow.position
    assert row["elbow_flexion.prediction.20"] == elbow.predictions["20"]
    assert row["emg.effort.flexor"] == frame.emg.effort["flexor"]
    assert row["group.arm.active"] == frame.groups[0].active
    assert row["meta"] == '{"participant": "P7", "session": 2}'


@pytest.mark.parametrize(
    ("command", "expected"),
    [
        (None, (None, None, None, None)),
        (Stop(), ("stop", None, None, None)),
        (Velocity(-0.25), ("velocity", None, -0.25, None)),
        (Position(0.5, 0.1), ("position", 0.5, None, 0.1)),
    ],
)
def test_commands_have_a_column_for_each_of_their_numbers(
    command: Stop | Velocity | Position | None, expected: tuple[Cell, ...]
) -> None:
    frame = one_frame()
    joint = replace(frame.joints[0], sent=command, asked={"emg": command} if command else {})
    found = cells(replace(frame, joints=(joint, *frame.joints[1:])), frame)
    for start in ("shoulder_rotation.sent.", "shoulder_rotation.asked.emg."):
        named = ("kind", "position_rad", "velocity_rad_s", "speed_rad_s")
        assert tuple(found[f"{start}{name}"][0] for name in named) == expected


def test_what_is_not_there_is_none_and_what_is_empty_is_empty() -> None:
    frame = replace(one_frame(), goal=None, trial=None)
    found = cells(frame, replace(frame, goal=GoalFrame(7, "go_home", "moving", 0.5)))
    assert found["goal.id"] == [None, 7]
    assert found["goal.reason"] == [None, ""]
    assert found["trial.number"] == [None, None]
    assert found["fault"] == ["", ""]


def test_stops_and_errors_of_servos_are_told() -> None:
    frame = one_frame()
    stop = StopReport("full", 12.5, 0.03, 0.001)
    joint = replace(frame.joints[0], stop=stop, errors=("Overload", "Überhitzung"))
    found = cells(replace(frame, joints=(joint, *frame.joints[1:])))
    assert found["shoulder_rotation.stop.bounce_rad"] == [0.001]
    assert found["shoulder_rotation.errors"] == ['["Overload", "Überhitzung"]']


def test_what_has_no_column_of_its_own_is_kept_beside() -> None:
    frame = one_frame()
    joint = replace(frame.joints[0], asked={"brain": Velocity(1.0)}, predictions={"99": 0.5})
    strange = replace(frame, joints=(joint, *frame.joints[1:]), groups=())
    found = cells(frame, strange, examples=[frame])
    assert found["other"][0] == ""
    assert '"brain": ["velocity", null, 1.0, null]' in str(found["other"][1])
    assert '"shoulder_rotation.prediction": {"99": 0.5}' in str(found["other"][1])
    assert found["group.arm.active"][1] is None


def test_a_joint_may_be_called_emg() -> None:
    assert "emg" in RESERVED
    frame = one_frame()
    emg: JointFrame = replace(
        frame.joints[0], name="emg", age=0.125, mode=Mode.LIMP, freshness=Freshness.LOST
    )
    found = cells(replace(frame, joints=(emg,)), joints=["emg"])
    assert found["joint.emg.age_s"] == [0.125]
    assert found["emg.age_s"] == [frame.emg.age]


def test_bytes_and_numbers_that_are_none_can_be_json() -> None:
    assert as_json({"a": b"\x01\xff", "b": float("nan")}) == '{"a": "01ff", "b": NaN}'
