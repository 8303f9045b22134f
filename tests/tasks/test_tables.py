"""Files of tasks: what they mean, and what is said of their mistakes."""

import random

import pytest

from bentod.cli.configs import read
from bentod.dashboard.task_files import own_folder, read_shelf, read_task
from bentod.errors import ConfigError
from bentod.tasks.engine import Engine
from bentod.tasks.tables import parse
from bentod.tasks.task import Task, misfits
from sim.studies.maze import Maze
from sim.studies.waypoints import Waypoints
from tests.rig import CONFIGS

FOLDER = CONFIGS / "tasks"
POINTS = (FOLDER / "waypoints.toml").read_text()
MAZE = (FOLDER / "maze.toml").read_text()
TICK = 1 / 30


def mistakes(text: str, *changes: tuple[str, str]) -> list[str]:
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new)
    with pytest.raises(ConfigError) as raised:
        parse(text, "x", "x.toml")
    return str(raised.value).splitlines()


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("dwell_s", "dwel_s", "dwell_s: is missing"),
        ("dwell_s", "dwel_s", "dwel_s: unknown key; did you mean 'dwell_s'?"),
        ("dwell_s = 3.0", "dwell_s = 61", "dwell_s = 61: input should be less than or equal to 60"),
        ('"2", "3"', '"2", "4"', "order: there is no way point '4' (known: 1, 2, 3)"),
        ('"2", "1"]', '"2"]', "order: it begins at '1' and must end there, not at '2'"),
        ('"2", "3", "2"', '"2", "2"', "order: '2' comes twice running"),
        ('name = "3"', 'name = "2"', "waypoints: there are two called '2'"),
        ("0.52]", "0.63]", "waypoint '3' = 0.63 of elbow_flexion is outside bounds_rad (-0.1 to 0.62)"),
        (
            '"elbow_flexion"]',
            '"shoulder_rotation"]',
            "joints: 'shoulder_rotation' cannot go across and up at once",
        ),
        (
            '= "waypoints"',
            '= "waypoint"',
            "kind = 'waypoint': there is no such kind; did you mean 'waypoints'?",
        ),
        (
            "[-0.23, 0.23]",
            "[0.23, -0.23]",
            "bounds_rad: those of shoulder_rotation, 0.23 and -0.23, must rise",
        ),
    ],
)
def test_a_mistake_in_way_points_is_told_with_key_and_bound(old: str, new: str, said: str) -> None:
    assert f"x.toml: {said}" in mistakes(POINTS, (old, new))


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("= 0.025", "= 0.06", "exposed_rad = 0.06 must be at most half_width_rad = 0.058"),
        ('"yellow"]', '"green"]', "barriers: both are called 'green'"),
        ("[0.0, 0.06]", "[0.0, 0.0]", "centre_rad: [0.0, 0.0] comes twice running"),
        ("bounce_s = 0.3", "bounce_s = -1", "bounce_s = -1: input should be greater than or equal to 0"),
        (
            "half_width_rad = 0.058",
            "half_width_rad = inf",
            "half_width_rad = inf: input should be a finite number",
        ),
    ],
)
def test_a_mistake_in_a_maze_is_told_with_key_and_bound(old: str, new: str, said: str) -> None:
    assert f"x.toml: {said}" in mistakes(MAZE, (old, new))


def test_what_is_no_toml_or_no_task_is_told(tmp_path_factory: pytest.TempPathFactory) -> None:
    assert mistakes("kind =")[0].startswith("x.toml: not valid TOML")
    assert mistakes("")[0] == "x.toml: kind = None: there is no such kind (known: maze, waypoints)"
    binary = tmp_path_factory.mktemp("t") / "b.toml"
    binary.write_bytes(b"\xff\xfe")
    with pytest.raises(ConfigError, match="cannot be read"):
        read_task(binary)
    binary.write_bytes(b"#" * 200_000)
    with pytest.raises(ConfigError, match="longer than"):
        read_task(binary)


def test_own_tasks_stand_beside_shipped_ones_and_a_broken_one_hides_no_other(
    monkeypatch: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory
) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path_factory.mktemp("config")))
    assert sorted(read_shelf().tasks) == ["maze", "waypoints"]
    own_folder().mkdir(parents=True)
    (own_folder() / "waypoints.toml").write_text(POINTS.replace('"Way points"', '"Mine"'))
    (own_folder() / "broken.toml").write_text("kind = 3")
    shelf = read_shelf()
    assert sorted(shelf.tasks) == ["maze", "waypoints"]
    assert shelf.tasks["waypoints"].title == "Mine"
    assert ["broken.toml" in problem for problem in shelf.problems] == [True]


@pytest.mark.parametrize("config", ["sim.toml", "bento.toml"])
@pytest.mark.parametrize("name", ["waypoints", "maze"])
def test_a_shipped_task_fits_the_shipped_arms(config: str, name: str) -> None:
    limits = {joint.name: (joint.min_rad, joint.max_rad) for joint in read(CONFIGS / config).joints}
    task = read_task(FOLDER / f"{name}.toml")
    assert misfits(task, limits) == []
    assert [len(misfits(task, limits | {joint: (-0.01, 0.01)})) for joint in task.joints] == [1, 1]
    assert misfits(task, {"elbow_flexion": (-1, 1)})[0] == (
        "the arm has no joint 'shoulder_rotation' (known: elbow_flexion)"
    )


def walk(task: Task, seed: int) -> list[tuple[float, float]]:
    """From place to place by way of the corridor, with rests, detours and a hand that trembles."""
    chance, found = random.Random(seed), []
    stops = list(task.corridor.centre) if task.corridor else [p.centre for p in task.places]
    stops = [*stops[1:], *stops[-2::-1]] * 3
    x, y = task.start.centre
    for stop in stops:
        for goal in ((stop[0] + chance.choice((0.0, 0.1)), stop[1]), stop):
            for step in range(1, 31):
                share = step / 30
                found.append((x + (goal[0] - x) * share, y + (goal[1] - y) * share))
            x, y = goal
        found += [(x + chance.gauss(0, 0.004), y + chance.gauss(0, 0.004)) for _ in range(180)]
        found.append((x, y))
    return found


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize(("name", "simulated"), [("waypoints", Waypoints), ("maze", Maze)])
def test_simulated_people_do_the_shipped_tasks(
    name: str, simulated: type[Waypoints | Maze], seed: int
) -> None:
    task, theirs = read_task(FOLDER / f"{name}.toml"), simulated()
    engine = Engine(task)
    engine.begin(0.0)
    for tick, position in enumerate(walk(task, seed)):
        engine.step(tick * TICK, position)
        theirs.step(tick * TICK, position)
        leg = engine.leg + (engine.resting and task.corridor is not None)  # theirs is the next one already
        assert (leg, engine.resting) == (theirs.leg, theirs.resting)
        assert (len(engine.laps), engine.contacts) == (theirs.circuits, theirs.contacts)
    assert engine.laps
    assert (engine.contacts > 0) is (task.corridor is not None)
    assert task.bounds == theirs.limits
