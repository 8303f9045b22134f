from hypothesis import given
from hypothesis import strategies as st

from bentod.control.arbiter import PRIORITY, arbitrate, asked_of, attended
from bentod.control.modes import Modes
from bentod.frames import Mode, Position, Stop, Velocity, Wishes


def _modes(*modes: Mode) -> Modes:
    found = Modes([f"j{i}" for i in range(len(modes))], [mode is not Mode.LIMP for mode in modes])
    for joint, mode in enumerate(modes):
        if mode in (Mode.ACTIVE, Mode.PAUSED):
            found.pause([joint], False)
        if mode is Mode.PAUSED:
            found.pause([joint], True)
    return found


def test_a_joint_that_nobody_asks_is_told_to_stop() -> None:
    (decision,) = arbitrate({}, _modes(Mode.ACTIVE), 1)
    assert (decision.command, decision.holder) == (Stop(), "")


def test_a_limp_joint_is_not_touched_whoever_asks() -> None:
    (decision,) = arbitrate({"client": {0: Velocity(1.0)}}, _modes(Mode.LIMP), 1)
    assert decision.command is None


def test_holding_and_paused_joints_are_stopped_whoever_asks() -> None:
    wishes: dict[str, Wishes] = {"client": {0: Velocity(1.0), 1: Velocity(1.0)}}
    holding, paused = arbitrate(wishes, _modes(Mode.HOLDING, Mode.PAUSED), 2)
    assert (holding.command, holding.holder) == (Stop(), "holding")
    assert (paused.command, paused.holder) == (Stop(), "paused")


def test_a_fault_stops_every_joint_with_torque() -> None:
    modes = _modes(Mode.ACTIVE, Mode.LIMP)
    modes.enter_fault("cable", limp=False)
    moving, limp = arbitrate({"emg": {0: Velocity(1.0), 1: Velocity(1.0)}}, modes, 2)
    assert moving.command == Stop()
    assert limp.command is None


@given(st.sets(st.sampled_from(PRIORITY), min_size=1))
def test_the_strongest_source_wins(sources: set[str]) -> None:
    wishes: dict[str, Wishes] = {source: {0: Velocity(1.0 + PRIORITY.index(source))} for source in sources}
    (decision,) = arbitrate(wishes, _modes(Mode.ACTIVE), 1)
    assert decision.holder == min(sources, key=PRIORITY.index)


def test_sources_share_the_arm_joint_by_joint() -> None:
    wishes: dict[str, Wishes] = {"emg": {0: Velocity(0.5)}, "assist": {0: Velocity(9.0), 1: Velocity(0.1)}}
    first, second = arbitrate(wishes, _modes(Mode.ACTIVE, Mode.ACTIVE), 2)
    assert (first.holder, second.holder) == ("emg", "assist")


def test_everything_asked_of_a_joint_is_kept_for_the_record() -> None:
    wishes: dict[str, Wishes] = {"emg": {0: Velocity(0.5)}, "home": {0: Position(0.0, 0.3)}}
    assert asked_of(0, wishes) == {"home": Position(0.0, 0.3), "emg": Velocity(0.5)}
    assert asked_of(1, wishes) == {}


def test_a_joint_counts_as_attended_only_while_it_may_move() -> None:
    wishes: dict[str, Wishes] = {"emg": {0: Velocity(0.5), 1: Velocity(0.5)}, "assist": {2: Velocity(0.1)}}
    assert attended(("emg",), wishes, _modes(Mode.ACTIVE, Mode.PAUSED, Mode.ACTIVE)) == {0}
