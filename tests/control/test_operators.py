"""Two operators on one group: one of them drives, and nothing jumps when they change."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bentod.control.operators import REST, Asked, Operators

PERIOD = 1 / 30
EMG, STICK = "emg", "joystick"


class Two:
    """A wearer's muscles, a joystick and a client, all of whom want the same group."""

    def __init__(self) -> None:
        self.operators = Operators(["arm"], [EMG, STICK])
        self.now = 10.0

    def tick(
        self, emg: float = 0.0, stick: float = 0.0, client: str = "", seconds: float = PERIOD
    ) -> tuple[float, float]:
        """What each of the two may have of what they ask, after so long of asking it."""
        granted: dict[str, Asked] = {}
        for _ in range(max(round(seconds / PERIOD), 1)):
            self.now += PERIOD
            asked = {EMG: Asked({"arm": emg}), STICK: Asked({"arm": stick})}
            granted = self.operators.decide(asked, ["arm"] * bool(client), self.now)
        return granted[EMG].efforts.get("arm", 0.0), granted[STICK].efforts.get("arm", 0.0)

    def toggles(self, name: str, client: str = "") -> bool:
        """Whether a toggle of theirs counts now, while both are at rest."""
        asked = {one: Asked({"arm": 0.0}, ["arm"] * (one == name)) for one in (EMG, STICK)}
        return bool(self.operators.decide(asked, ["arm"] * bool(client), self.now)[name].toggles)

    @property
    def driver(self) -> str:
        return self.operators.driver("arm")


@pytest.fixture
def two() -> Two:
    return Two()


def test_who_is_alone_drives_at_once_and_as_they_like(two: Two) -> None:
    assert two.tick(emg=0.4) == (0.4, 0.0)
    assert two.tick(emg=-1.0) == (-1.0, 0.0)
    assert (two.driver, two.operators.effort("arm")) == (EMG, -1.0)


def test_of_equals_the_first_keeps_the_group(two: Two) -> None:
    two.tick(stick=0.4)
    assert two.tick(emg=-1.0, stick=0.4) == (0.0, 0.4)
    assert two.driver == STICK


def test_a_short_rest_does_not_lose_the_group_and_a_longer_one_does(two: Two) -> None:
    two.tick(emg=0.4)
    two.tick(seconds=0.8 * REST)
    assert two.driver == EMG
    two.tick(seconds=0.4 * REST)
    assert two.driver == ""
    assert two.tick(stick=0.3) == (0.0, 0.3)


def test_who_asks_while_another_drives_must_rest_before_they_may(two: Two) -> None:
    two.tick(emg=0.4)
    two.tick(emg=0.4, stick=0.7)
    assert two.tick(stick=0.7, seconds=2 * REST) == (0.0, 0.0)
    two.tick()
    assert two.tick(stick=0.7) == (0.0, 0.7)


def test_a_client_takes_the_group_at_once_and_nothing_jumps_when_it_leaves(two: Two) -> None:
    two.tick(emg=0.9)
    assert two.tick(emg=0.9, client="ann") == (0.0, 0.0)
    assert two.driver == ""
    assert two.tick(emg=0.9, seconds=1.0) == (0.0, 0.0)
    two.tick(emg=0.0)
    assert two.tick(emg=0.9) == (0.9, 0.0)


def test_who_rests_while_a_client_drives_may_drive_right_after(two: Two) -> None:
    two.tick(emg=0.9)
    two.tick(emg=0.9, client="ann")
    two.tick(client="ann")
    assert two.tick(emg=0.5) == (0.5, 0.0)


def test_toggles_count_for_the_driver_and_for_a_free_group(two: Two) -> None:
    assert two.toggles(EMG)
    assert two.toggles(STICK)
    two.tick(emg=0.4)
    assert two.toggles(EMG)
    assert not two.toggles(STICK)
    assert not two.toggles(EMG, client="ann")


def test_toggles_of_who_is_suspended_do_not_count(two: Two) -> None:
    two.tick(emg=0.4)
    two.tick(emg=0.4, client="ann")
    asked = {EMG: Asked({"arm": 0.4}, ["arm"], ["arm"])}
    assert two.operators.decide(asked, {}, two.now)[EMG] == Asked({}, [], [])


def test_after_somebody_stronger_switched_the_joint_everybody_rests_first(two: Two) -> None:
    two.tick(emg=0.9)
    two.operators.suspend("arm")
    assert two.tick(emg=0.9, seconds=1.0) == (0.0, 0.0)
    two.tick()
    assert two.tick(emg=0.9) == (0.9, 0.0)


def test_an_operator_that_is_not_there_has_not_been_seen_at_rest(two: Two) -> None:
    two.operators.suspend("arm")
    for asked in (Asked({}), Asked({"arm": math.nan})):
        two.operators.decide({EMG: asked}, {}, two.now)
    assert two.tick(emg=0.9) == (0.0, 0.0)


def test_what_is_no_number_asks_for_nothing(two: Two) -> None:
    assert two.tick(emg=math.nan) == (0.0, 0.0)
    assert two.driver == ""


def test_groups_are_driven_apart() -> None:
    operators = Operators(["arm", "hand"], [EMG, STICK])
    asked = {EMG: Asked({"arm": 0.4}), STICK: Asked({"hand": 0.5})}
    assert operators.decide(asked, {}, 1.0) == {
        EMG: Asked({"arm": 0.4}, [], []),
        STICK: Asked({"hand": 0.5}, [], []),
    }


EFFORTS = st.sampled_from([0.0, 0.0, 0.5, -1.0])


@given(st.lists(st.tuples(EFFORTS, EFFORTS, st.sampled_from(["", "", "ann"])), max_size=60))
def test_never_do_two_drive_and_nobody_drives_who_lost_the_group_without_a_rest(
    story: list[tuple[float, float, str]],
) -> None:
    two = Two()
    drove = {EMG: True, STICK: True}  # or was seen at rest since
    for emg, stick, client in story:
        granted = dict(zip((EMG, STICK), two.tick(emg, stick, client), strict=True))
        asked = {EMG: emg, STICK: stick}
        assert sum(effort != 0 for effort in granted.values()) + bool(client) <= 1
        for name, effort in granted.items():
            assert effort in (0.0, asked[name])
            assert not effort or drove[name]
            drove[name] = asked[name] == 0 or effort != 0


def test_who_is_contracted_but_asks_for_nothing_is_not_at_rest(two: Two) -> None:
    two.operators.suspend_all()
    squeezed = {EMG: Asked({"arm": 0.0}, ["arm"], tense=["arm"])}
    assert two.operators.decide(squeezed, {}, 20.0)[EMG] == Asked({}, [], [])
    assert two.operators.decide(squeezed, {}, 20.1)[EMG] == Asked({}, [], [])
    assert two.tick(emg=0.4) == (0.0, 0.0)
    two.tick()
    assert two.operators.decide(squeezed, {}, two.now)[EMG].toggles == ["arm"]


def test_toggles_back_count_like_those_that_go_on(two: Two) -> None:
    asked = {EMG: Asked({"arm": 0.0}, [], ["arm"]), STICK: Asked({"arm": 0.4})}
    assert two.operators.decide(asked, {}, 20.0)[EMG].toggles_back == ["arm"]
    assert two.operators.decide(asked, {}, 20.1)[EMG].toggles_back == []
