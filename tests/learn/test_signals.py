from dataclasses import replace

import numpy as np
import pytest

from bentod.errors import ConfigError
from bentod.frames import EmgFrame, Freshness, GroupFrame, JointSpec, JointState, State
from bentod.learn.signals import Percept, Signals, starred

SPECS = (JointSpec("shoulder", -1.0, 1.5, 0.5, 0.0, {}), JointSpec("elbow", 0.0, 2.0, 0.7, 0.0, {}))
JOINTS = (
    JointState(0.1, 0.2, 0.3, 12.0, 40.0, 0.01, Freshness.FRESH),
    JointState(1.1, -0.2, -0.3, 11.9, 41.0, 0.01, Freshness.FRESH),
)
EMG = EmgFrame(True, False, "", 0, 0.0, 0, {"biceps": 0.4}, 0)
GROUP = GroupFrame("arm", ("shoulder", "elbow"), "shoulder", -0.5, "emg")
SEEN = Percept(7, 1.0, False, State(1.0, JOINTS), EMG, (GROUP,))


def signals() -> Signals:
    return Signals(SPECS, ["biceps"], {"arm": ["shoulder", "elbow"]})


def read(percept: Percept, reader: Signals | None = None) -> dict[str, float]:
    reader = reader or signals()
    return dict(zip(reader.names, reader.read(percept).tolist(), strict=True))


def active(joint: str) -> Percept:
    return replace(SEEN, groups=(replace(GROUP, active=joint),))


def test_everything_that_is_perceived_has_a_name_and_its_value() -> None:
    assert read(SEEN) == {
        "shoulder.position": 0.1,
        "shoulder.velocity": 0.2,
        "shoulder.load": 0.3,
        "shoulder.voltage": 12.0,
        "shoulder.temperature": 40.0,
        "elbow.position": 1.1,
        "elbow.velocity": -0.2,
        "elbow.load": -0.3,
        "elbow.voltage": 11.9,
        "elbow.temperature": 41.0,
        "emg.biceps": 0.4,
        "arm.effort": -0.5,
        "arm.active.shoulder": 1.0,
        "arm.active.elbow": 0.0,
        "arm.toggled": 0.0,
        "arm.together": 0.0,
        "arm.reward": 0.0,
    }


def test_a_reward_is_a_signal_of_the_group_that_it_is_given_to() -> None:
    assert read(replace(SEEN, rewards={"arm": -1.5, "leg": 1.0}))["arm.reward"] == -1.5


@pytest.mark.parametrize("freshness", [Freshness.STALE, Freshness.LOST])
def test_a_joint_that_was_not_read_in_this_tick_is_not_known(freshness: Freshness) -> None:
    joints = (replace(JOINTS[0], freshness=freshness), JOINTS[1])
    found = read(replace(SEEN, state=State(1.0, joints)))
    assert {name for name, value in found.items() if np.isnan(value)} == {
        name for name in signals().names if name.startswith("shoulder.")
    }


def test_a_muscle_that_is_not_alive_is_not_known_rather_than_at_rest() -> None:
    assert np.isnan(read(replace(SEEN, emg=replace(EMG, alive=False)))["emg.biceps"])
    assert np.isnan(read(replace(SEEN, emg=replace(EMG, effort={})))["emg.biceps"])


def test_a_group_that_nobody_tells_of_is_not_known() -> None:
    found = read(replace(SEEN, groups=()))
    assert all(np.isnan(found[name]) for name in found if name.startswith("arm."))


def test_a_toggle_is_seen_in_the_tick_whose_active_joint_is_another() -> None:
    reader = signals()
    told = [
        read(active(joint), reader)["arm.toggled"] for joint in ("elbow", "elbow", "shoulder", "shoulder")
    ]
    assert told == [0.0, 0.0, 1.0, 0.0]
    reader.restart()
    assert read(active("elbow"), reader)["arm.toggled"] == 0.0


def test_selecting_all_joints_at_once_and_leaving_them_are_toggles_too() -> None:
    reader = signals()
    together = replace(SEEN, groups=(replace(GROUP, active="elbow", together=True),))
    told = [read(percept, reader) for percept in (active("elbow"), together, together, active("elbow"))]
    assert [found["arm.toggled"] for found in told] == [0.0, 1.0, 0.0, 1.0]
    assert [found["arm.together"] for found in told] == [0.0, 1.0, 1.0, 0.0]
    before, after = signals(), signals()
    read(together, before)
    after.recall(before.memory())
    assert read(active("elbow"), after)["arm.toggled"] == 1.0


def test_the_active_joint_is_remembered_from_one_session_to_the_next() -> None:
    before, after = signals(), signals()
    read(active("elbow"), before)
    after.recall(before.memory())
    assert read(active("shoulder"), after)["arm.toggled"] == 1.0
    after.recall(signals().memory())
    assert read(active("shoulder"), after)["arm.toggled"] == 0.0


@pytest.mark.parametrize("memory", [{}, {"active": np.zeros(2)}, {"active": np.array([2.0])}])
def test_a_memory_of_other_groups_is_refused(memory: dict[str, np.ndarray]) -> None:
    with pytest.raises(ValueError, match="active joint"):
        signals().recall(memory)


def test_ranges_are_those_of_the_config_and_of_the_units() -> None:
    found = {name: signals().range(name) for name in signals().names}
    assert found["shoulder.position"] == (-1.0, 1.5)
    assert found["elbow.velocity"] == (-0.7, 0.7)
    assert found["elbow.load"] == found["arm.effort"] == (-1.0, 1.0)
    assert found["emg.biceps"] == found["arm.active.elbow"] == found["arm.toggled"] == (0.0, 1.0)
    assert found["elbow.voltage"] is None


def test_two_signals_of_one_name_are_refused() -> None:
    with pytest.raises(ConfigError, match=r"'emg\.effort': rename"):
        Signals(SPECS, ["effort"], {"emg": ["elbow"]})


def test_a_state_of_too_few_joints_is_refused() -> None:
    with pytest.raises(ValueError, match="17 signals were declared, and 12 were read"):
        signals().read(replace(SEEN, state=State(1.0, JOINTS[:1])))


def test_a_star_stands_for_all_names_that_fit_in_their_order() -> None:
    names = signals().names
    assert starred("*.velocity", names) == ("shoulder.velocity", "elbow.velocity")
    assert starred("arm.*.elbow", names) == ("arm.active.elbow",)
    assert starred("*", names) == names
    assert starred("2*elbow.load", names) == ("2*elbow.load",)
    with pytest.raises(ConfigError, match=r"'\*\.speed' stands for no signal"):
        starred("*.speed", names)
