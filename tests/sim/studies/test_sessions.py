"""Simulated operators at the daemon's own controller, in virtual time."""

import pytest

from bentod.frames import Frame
from bentod.learn.confidence.visits import Visit
from sim.people.scene import Act
from sim.people.traits import AUTHOR
from sim.studies.maze import Maze
from sim.studies.maze_table import HEAD, THESIS, row
from sim.studies.session import run_session
from sim.studies.session_config import SPEED, WAYPOINTS_HELP, Help
from sim.studies.stage import CircuitResult, Circuits, Task
from sim.studies.waypoints import Waypoints


def test_an_operator_goes_through_the_maze_alone_about_as_fast_as_its_author() -> None:
    frames: list[Frame] = []

    def watch(frame: Frame, task: Task, act: Act, visit: Visit | None) -> None:
        frames.append(frame)

    (circuit,) = run_session(AUTHOR, Maze(), Circuits(1, 0), seed=1, watch=watch)
    assert circuit.whole
    assert 17 < circuit.time < 24
    assert 8 <= circuit.toggles <= 16
    assert not any(frame.fault for frame in frames)
    asked = [abs(joint.velocity) for frame in frames for joint in frame.joints]
    assert max(asked) < 1.5 * SPEED


def test_the_arm_helps_in_assisted_circuits_only_and_the_same_seed_gives_the_same_session() -> None:
    def session(helped: Circuits) -> tuple[list[CircuitResult], list[bool]]:
        engaged: list[bool] = []
        found = run_session(
            AUTHOR,
            Maze(),
            helped,
            Help(20.0),
            2,
            watch=lambda frame, *_: engaged.append(frame.assist.engaged),
        )
        return found, engaged

    first, engaged = session(Circuits(1, 1))
    ticks = round(first[0].time * 30)
    assert not any(engaged[:ticks])
    assert any(engaged[ticks:])
    assert session(Circuits(1, 0))[0] == first[:1]


def test_way_points_are_reached_and_held() -> None:
    (circuit,) = run_session(AUTHOR, Waypoints(), Circuits(1, 0), WAYPOINTS_HELP, seed=1)
    assert circuit.whole
    assert 18 < circuit.time < 30
    assert 3 <= circuit.toggles <= 8


def test_muscles_and_servos_byte_by_byte_take_an_operator_through_the_maze() -> None:
    (circuit,) = run_session(AUTHOR, Maze(), Circuits(1, 0), driver="sim-dynamixel", through="emg", seed=1)
    assert circuit.whole
    assert circuit.time > 17


def test_a_session_in_the_columns_of_the_thesis_table() -> None:
    results = [
        CircuitResult(1, "solo", 20.0, 10, 0, 1.3),
        CircuitResult(2, "solo", 22.0, 10, 1, 1.4),
        CircuitResult(1, "assisted", 18.0, 4, 0, 1.2),
        CircuitResult(2, "assisted", 16.0, 2, 0, 1.2),
    ]
    cells = row("X", 10, results)
    assert len(cells) == len(HEAD) == len(THESIS[0])
    assert cells[:8] == ("X", "10", "10 (0)", "10 (2)", "10", "21 (1.41)", "20.0", "22.0")
    assert cells[8:] == ("3 (1.41)", "2 (1)", "4", "4", "17 (1.41)", "16.0", "18.0", "18.0")


@pytest.mark.parametrize("cells", THESIS)
def test_the_thesis_has_a_cell_in_every_column(cells: tuple[str, ...]) -> None:
    assert len(cells) == len(HEAD)
