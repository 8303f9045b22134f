import itertools

from hypothesis import given
from hypothesis import strategies as st

from drivers.dynamixel.rounds import LONGEST_PAUSE, Roll

TICK = 1 / 30


def play(roll: Roll, now: float, dead: set[int]) -> tuple[list[list[int]], set[int]]:
    """One round on a bus where `dead` do not reply: what was asked, and who was heard."""
    asked, heard = [], set()
    roll.begin(now)
    while chain := roll.chain() or roll.straggler():
        silent_from = next((i for i, id_ in enumerate(chain) if id_ in dead), len(chain))
        roll.note(chain, chain[:silent_from], now)
        asked.append(chain)
        heard.update(chain[:silent_from])
    return asked, heard


def test_when_all_is_well_all_are_asked_at_once_in_order() -> None:
    assert play(Roll([3, 1, 2], 0.0), TICK, set()) == ([[3, 1, 2]], {1, 2, 3})


def test_who_stands_behind_a_silent_servo_is_asked_again_in_the_same_round() -> None:
    assert play(Roll([1, 2, 3, 4], 0.0), TICK, {2}) == ([[1, 2, 3, 4], [3, 4]], {1, 3, 4})


def test_a_silent_servo_is_asked_last_from_then_on() -> None:
    roll = Roll([1, 2, 3], 0.0)
    play(roll, TICK, {1})
    assert play(roll, 2 * TICK, {1}) == ([[2, 3], [1]], {2, 3})


def test_a_servo_that_is_back_takes_its_old_place() -> None:
    roll = Roll([1, 2, 3], 0.0)
    play(roll, TICK, {1})
    play(roll, 2 * TICK, set())
    assert play(roll, 3 * TICK, set())[0] == [[1, 2, 3]]


def test_a_damaged_reply_in_the_middle_is_asked_for_once_more() -> None:
    roll = Roll([1, 2, 3], 0.0)
    roll.begin(TICK)
    roll.note(roll.chain(), {1, 3}, TICK)
    assert roll.chain() == [2]
    roll.note([2], {2}, TICK)
    assert roll.chain() == []


def test_a_dead_servo_is_asked_ever_more_rarely_but_never_forgotten() -> None:
    roll = Roll([1, 2], 0.0)
    asked_at = []
    for tick in range(300):
        now = tick * TICK
        if any(1 in chain for chain in play(roll, now, {1})[0]):
            asked_at.append(now)
    pauses = [later - earlier for earlier, later in itertools.pairwise(asked_at)]
    assert len(asked_at) < 60
    assert max(pauses) <= LONGEST_PAUSE + TICK + 1e-9


@given(st.sets(st.integers(1, 6)), st.integers(1, 5))
def test_whoever_can_speak_is_heard_in_every_round(dead: set[int], rounds: int) -> None:
    roll = Roll([1, 2, 3, 4, 5, 6], 0.0)
    for tick in range(1, rounds + 1):
        assert play(roll, tick * TICK, dead)[1] == {1, 2, 3, 4, 5, 6} - dead


@given(st.sets(st.integers(1, 6)))
def test_when_the_cable_is_back_everyone_is_heard_within_the_longest_pause(dead: set[int]) -> None:
    roll = Roll([1, 2, 3, 4, 5, 6], 0.0)
    for tick in range(100):
        play(roll, tick * TICK, dead)
    heard: set[int] = set()
    for tick in range(100, 100 + int(LONGEST_PAUSE / TICK) + 2):
        heard |= play(roll, tick * TICK, set())[1]
    assert heard == {1, 2, 3, 4, 5, 6}
