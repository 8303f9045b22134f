"""`bentod ctl` against a real socket: what it asks, what it shows, and how it ends."""

import asyncio
import json
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Annotated

import pytest
from click.testing import CliRunner, Result

from bentod.cli.ctl import ctl
from bentod.errors import Refused
from bentod.frames import Event, Frame, Value
from bentod.serve.params import Free, Number, Text
from bentod.serve.server import Server
from bentod.serve.session import Session
from bentod.serve.spec import Handler, table
from tests.serve.helpers import event, frame

pytestmark = pytest.mark.real_time

Joints = Annotated[str | list[str] | None, Text("joints")]
Optional = Annotated[float | None, Number()]
Ctl = Callable[..., Result]


class Arm:
    """Remembers what it was asked; goes home in two steps."""

    def __init__(self, path: Path) -> None:
        self.asked: list[tuple[object, ...]] = []
        self.left = threading.Event()
        self.end = "done"
        self.methods = table(observer=self._handlers())
        self.server = Server(self.methods, path)

    def _handlers(self) -> tuple[Handler, ...]:
        queries = (self.list_methods, self.hello, self.get_state, self.get_info)
        joints = (self.pause, self.torque, self.stop, self.go_home, self.move, self.group_command)
        return (*queries, self.subscribe, *joints, self.emg_set, self.set_meta, self.inject)

    async def list_methods(self, session: Session) -> Value:
        """Describe every method."""
        return [entry.describe() for entry in self.methods.values()]

    async def hello(self, session: Session, name: Annotated[str, Text("who")]) -> Value:
        """Say who."""
        session.on_close(self.left.set)
        return None

    async def get_state(self, session: Session) -> Frame:
        """The state."""
        return frame(7, meta=float("nan"))

    async def get_info(self, session: Session) -> Value:
        """What never changes."""
        return {
            "arm": "Bento",
            "joints": [{"name": "wrist", "max_rad": 1.5}],
            "groups": {"a": ["wrist", "hand"]},
        }

    async def subscribe(
        self,
        session: Session,
        topic: Annotated[str, Text("topic")],
        rate_hz: Annotated[float, Number("Hz")] = 30.0,
    ) -> Value:
        """Send one notification; after a frame, hang up."""
        session.subscribe("state" if topic == "state" else "events", rate_hz)
        if topic == "state":
            self.server.publish_state(frame(1))
            self.server.publish_event(event(1))
            asyncio.get_running_loop().call_later(0.1, session.drop)
        return None

    async def pause(self, session: Session, joints: Joints = None, on: bool = True) -> Value:
        """Pause joints."""
        self.asked.append(("pause", joints, on))
        return None

    async def torque(self, session: Session, joints: Joints, on: bool) -> Value:
        """Switch torque."""
        self.asked.append(("torque", joints, on))
        return None

    async def stop(self, session: Session) -> Value:
        """Stop."""
        raise Refused("The arm is in fault; clear it first.")

    async def go_home(self, session: Session, joints: Joints = None) -> Value:
        """Go home."""
        for goal, status, progress in ((2, "done", 1.0), (3, "moving", 0.5), (3, self.end, 1.0)):
            data: dict[str, Value] = {"id": goal, "status": status, "progress": progress, "reason": "a sign"}
            self.server.publish_event(Event(0.0, "goal", "Going home.", data))
        return {"goal": 3}

    async def move(
        self,
        session: Session,
        joint: Annotated[str, Text("joint")],
        velocity: Annotated[float | None, Number("rad/s", -10, 10)] = None,
        position: Optional = None,
        lease_s: Annotated[float, Number("s", 0.05, 2)] = 0.2,
    ) -> Value:
        """Move."""
        self.asked.append(("move", joint, velocity, position, lease_s))
        return None

    async def group_command(
        self,
        session: Session,
        group: Annotated[str, Text("group")],
        effort: Annotated[float, Number("", -1, 1)],
        lease_s: Annotated[float, Number("s", 0.05, 2)] = 0.2,
    ) -> Value:
        """Move a group."""
        self.asked.append(("group_command", group, effort))
        return None

    async def emg_set(
        self,
        session: Session,
        site: Annotated[str, Text("site")],
        gain: Optional = None,
        max_v: Optional = None,
    ) -> Value:
        """Change a site."""
        self.asked.append(("emg_set", site, gain, max_v))
        return None

    async def set_meta(self, session: Session, meta: Annotated[Value, Free("note")]) -> Value:
        """Note."""
        self.asked.append(("set_meta", meta))
        return None

    async def inject(
        self,
        session: Session,
        fault: Annotated[str, Text("fault")],
        joint: Annotated[str | None, Text("joint")] = None,
        on: bool = True,
    ) -> Value:
        """Break."""
        self.asked.append(("inject", fault, joint, on))
        return None


@pytest.fixture
def arm(tmp_path: Path) -> Iterator[Arm]:
    arm = Arm(tmp_path / "bentod.sock")
    ready, end = threading.Event(), asyncio.Event()
    loops: list[asyncio.AbstractEventLoop] = []

    async def serve() -> None:
        async with arm.server:
            loops.append(asyncio.get_running_loop())
            ready.set()
            await end.wait()

    thread = threading.Thread(target=asyncio.run, args=(serve(),))
    thread.start()
    assert ready.wait(5)
    yield arm
    loops[0].call_soon_threadsafe(end.set)
    thread.join(5)


def run(path: Path, *words: str) -> Result:
    return CliRunner().invoke(ctl, ["--socket", str(path), *words])


@pytest.fixture
def ask(arm: Arm) -> Ctl:
    return lambda *words: run(arm.server.path, *words)


@pytest.mark.parametrize(
    ("words", "asked"),
    [
        (["pause"], ("pause", None, True)),
        (["pause", "off"], ("pause", None, False)),
        (["pause", "wrist"], ("pause", ["wrist"], True)),
        (["pause", "off", "wrist", "hand"], ("pause", ["wrist", "hand"], False)),
        (["torque", "off"], ("torque", None, False)),
        (["torque", "on", "wrist"], ("torque", ["wrist"], True)),
        (["set-meta", "trial 3"], ("set_meta", "trial 3")),
        (["emg-set", "flexor", "gain=2", "max_v=0.5"], ("emg_set", "flexor", 2.0, 0.5)),
        (["emg-set", "flexor", "smax_v=0.5"], ("emg_set", "flexor", None, 0.5)),  # as in brachIOplexus
        (["inject", "cable"], ("inject", "cable", None, True)),
        (["inject", "stuck", "wrist", "off"], ("inject", "stuck", "wrist", False)),
        (["call", "pause", 'joints=["a"]', "on=off"], ("pause", ["a"], False)),
    ],
)
def test_a_command_asks_for_what_it_says(
    arm: Arm, ask: Ctl, words: list[str], asked: tuple[Value, ...]
) -> None:
    result = ask(*words)
    assert (result.exit_code, result.output) == (0, "")
    assert arm.asked == [asked]


def test_a_refusal_is_one_line_and_exit_code_1(ask: Ctl) -> None:
    result = ask("stop")
    assert (result.exit_code, result.stderr) == (1, "Error: The arm is in fault; clear it first.\n")


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (["move", "wrist", "--velocity", "-12"], "velocity = -12 rad/s is below its minimum, -10 rad/s."),
        (["call", "puase"], "did you mean 'pause'?"),
        (["call", "pause", "on"], "'on' is not of the form name=value."),
        (["move", "wrist"], "Give --velocity, --position or both."),
        (["inject", "stuck", "wrist", "hand"], "Give one joint at most, then on or off."),
        (["torque", "perhaps"], "'perhaps' is not one of"),
    ],
)
def test_wrong_usage_is_exit_code_2(ask: Ctl, words: list[str], line: str) -> None:
    result = ask(*words)
    assert result.exit_code == 2
    assert line in result.stderr
    assert "Traceback" not in result.output


def test_without_a_daemon_the_exit_code_is_3(tmp_path: Path) -> None:
    result = run(tmp_path / "none.sock", "stop")
    assert result.exit_code == 3
    assert result.stderr.startswith("Error: No daemon answers at ")


def test_a_move_is_renewed_until_its_time_is_over_and_then_let_go(arm: Arm, ask: Ctl) -> None:
    assert ask("move", "wrist", "--velocity", "-0.5", "--for", "0.3", "--lease", "0.1").exit_code == 0
    assert set(arm.asked) == {("move", "wrist", -0.5, None, 0.1)}
    assert len(arm.asked) >= 4
    assert arm.left.wait(5)


def test_a_negative_effort_is_not_an_option(arm: Arm, ask: Ctl) -> None:
    assert ask("group", "grasp", "-0.5", "--for", "0.05").exit_code == 0
    assert arm.asked[0] == ("group_command", "grasp", -0.5)


def test_going_home_shows_its_progress_until_it_is_done(ask: Ctl) -> None:
    result = ask("go-home")
    assert (result.exit_code, result.output) == (0, "moving 50%\ndone 100%\n")


def test_going_home_in_vain_is_exit_code_1(arm: Arm, ask: Ctl) -> None:
    arm.end = "cancelled"
    result = ask("go-home", "wrist")
    assert (result.exit_code, result.stderr) == (1, "Error: cancelled at 100%: a sign\n")


def test_going_home_need_not_be_waited_for(ask: Ctl) -> None:
    assert ask("go-home", "--no-wait").output == "goal: 3\n"


def test_the_state_is_a_table_for_people_and_json_for_programs(ask: Ctl) -> None:
    assert ask("state").output.startswith("tick 7   ACTIVE")
    state = json.loads(ask("--json", "state").output)
    assert (state["tick"], state["meta"]) == (7, None)


def test_watching_goes_on_until_the_daemon_ends(ask: Ctl) -> None:
    result = ask("--json", "state", "--watch", "--rate", "10")
    assert json.loads(result.stdout)["tick"] == 1
    assert (result.exit_code, result.stderr.startswith("Error: The ")) == (3, True)


def test_answers_are_indented_lines(ask: Ctl) -> None:
    assert ask("info").output.splitlines() == [
        "arm: Bento",
        "joints:",
        "  -",
        "    name: wrist",
        "    max_rad: 1.5",
        "groups:",
        "  a: wrist, hand",
    ]


def test_the_help_lists_what_the_running_daemon_offers(ask: Ctl) -> None:
    result = ask("--help")
    assert result.exit_code == 0
    assert "pause [joints=-] [on=yes]\n      Pause joints." in result.output
    assert "Exit codes: 0 done; 1 refused or cancelled" in " ".join(result.output.split())


def test_the_help_is_there_without_a_daemon(tmp_path: Path) -> None:
    result = run(tmp_path / "none.sock", "--help")
    assert result.exit_code == 0
    assert "No daemon answers" in result.output
