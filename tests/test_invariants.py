"""What holds at every tick, whatever clients ask, whatever breaks, and however much time passes.

In the suite a few sequences, the same each time. Many more, others each time, and as long as it takes:
`make test ARGS="tests/test_invariants.py --hypothesis-profile=long"`.
"""

from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from bentod.config import Config
from bentod.control.clients import Clients
from bentod.control.grips import Grips
from bentod.frames import Command
from bentod.serve.session import Session
from drivers.dynamixel.motion import Goal, JointMotion
from tests.invariants.steps import Api, Call, Let, Recover, Step, Vanish, steps
from tests.invariants.watch import Watch
from tests.invariants.world import learn_api, play
from tests.rig import PLAIN, sim_config

USUAL = 100
"""Examples of hypothesis' own profile, whose eighth is enough for the suite."""

LONG = settings().max_examples > USUAL

WEIGHTLESS = ("[driver]\n", "[driver]\ngravity_nm = { elbow_flexion = 0.0, wrist_flexion = 0.0 }\n")
"""A joint without torque falls; here it must not, so that whatever moves was moved."""

FIRMWARE_2 = [(f'model = "{model}"', f'model = "{model}(2.0)"') for model in ("MX-28", "MX-64", "MX-106")]

CHANGES = {"servo models": [PLAIN], "firmware 1": [], "firmware 2": FIRMWARE_2}

pytestmark = pytest.mark.timeout(0 if LONG else 60)


@cache
def _config(arm: str) -> Config:
    return sim_config(WEIGHTLESS, *CHANGES[arm])


@cache
def _api(arm: str) -> Api:
    with TemporaryDirectory() as folder:
        return learn_api(_config(arm), Path(folder, "bentod.sock"))


def _played(arm: str, happens: list[Step], worn: bool = False) -> Watch:
    config = _config(arm) if worn else _config(arm).model_copy(update={"emg": None})
    with TemporaryDirectory() as folder:
        return play(config, Path(folder, "bentod.sock"), _api(arm), happens)


@pytest.mark.parametrize("arm", CHANGES)
def test_nothing_moves_that_nobody_moves_whatever_happens(arm: str) -> None:
    @settings(
        max_examples=settings().max_examples // 8,
        derandomize=not LONG,
        deadline=None,
        suppress_health_check=list(HealthCheck),
        phases=[phase for phase in Phase if phase is not Phase.explain],
    )
    @given(happens=steps(_api(arm)), worn=st.booleans())
    def holds(happens: list[Step], worn: bool) -> None:
        watch = _played(arm, happens, worn)
        assert not watch.broken, "\n".join(["", *watch.broken])

    holds()


MOTION = Call(0, "move", {"joint": "shoulder_rotation", "velocity": 0.8, "lease_s": 1.0}, wait=True)


def test_a_joint_that_is_about_to_be_limp_is_sent_nowhere() -> None:
    at_once: list[Step] = [
        Call(0, "torque", {"on": False}),
        Call(0, "go_home", {}),
        Call(0, "pause", {"on": False}),
    ]
    watch = _played("firmware 1", [MOTION, Let(0.5), *at_once, Let(1.0)])
    assert not watch.broken


def test_a_day_in_the_life_of_an_arm_breaks_nothing() -> None:
    limp, stiff = (Call(1, "torque", {"on": on}, wait=True) for on in (False, True))
    release = Call(1, "pause", {"on": False}, wait=True)
    day: list[Step] = [
        MOTION,
        Let(0.5),
        limp,
        Let(0.5),
        stiff,
        Let(0.5),
        release,
        MOTION,
        Let(0.4),
        Vanish(0),
        Let(1.0),
    ]
    watch = _played("firmware 1", [*day, Recover(), MOTION], worn=True)
    assert not watch.broken
    assert watch.seen["shoulder_rotation"].moved, "nothing was tried if nothing moved"


# The watch itself: what it must notice.


def test_it_is_noticed_when_a_wish_outlives_its_lease(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Clients, "expire", lambda self, now: None)
    watch = _played("servo models", [MOTION, Let(2.0)])
    assert any("no live source" in what for what in watch.broken)


def test_it_is_noticed_when_a_homing_outlives_its_lease(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Grips, "expire", lambda self, now: [])
    away: list[Step] = [MOTION, Let(1.2)]
    watch = _played("servo models", [*away, Call(0, "go_home", {"lease_s": 0.1}, wait=True), Let(1.0)])
    assert any("for 'home': no live source" in what for what in watch.broken)


def test_it_is_noticed_when_a_joint_is_not_pinned_where_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    pin = JointMotion.pin

    def elsewhere(self: JointMotion, position: float) -> Goal:
        return pin(self, position + 0.05)

    monkeypatch.setattr(JointMotion, "pin", elsewhere)
    watch = _played("firmware 1", [Call(0, "torque", {"on": on}, wait=True) for on in (False, True)])
    assert any("was armed with its goal" in what for what in watch.broken)


def test_it_is_noticed_when_a_request_is_answered_twice(monkeypatch: pytest.MonkeyPatch) -> None:
    send = Session.send

    def again(self: Session, response: bytes) -> None:
        send(self, response)
        send(self, response)

    monkeypatch.setattr(Session, "send", again)
    watch = _played("servo models", [MOTION, Let(0.1)])
    assert any("which was not open" in what for what in watch.broken)


def test_it_is_noticed_when_a_joint_creeps(monkeypatch: pytest.MonkeyPatch) -> None:
    command = JointMotion.command

    def creeping(self: JointMotion, asked: Command, *rest: object) -> Goal:
        goal = command(self, asked, *rest)  # type: ignore[arg-type]
        return Goal(goal.position + 0.05, 0.05)

    monkeypatch.setattr(JointMotion, "command", creeping)
    watch = _played("servo models", [Let(2.0)])
    assert any("unasked" in what or "went on for" in what for what in watch.broken)
