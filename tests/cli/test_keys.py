"""Bytes of a terminal as keys, and keys as what is asked of the arm."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bentod.cli.keys import Keys
from bentod.cli.keys_verbs import HELP, SURE, Ask, Hands
from bentod.frames import AssistFrame, Frame, GoalFrame, GroupFrame, Mode
from tests.cli.test_view import FRAME, JOINT, received

HAND = GroupFrame("hand", ("gripper",), "gripper", 0.0, "")
TWO = replace(FRAME, groups=(*FRAME.groups, HAND), assist=AssistFrame("dpcc", False, "", group="arm"))
PAUSED = replace(TWO, mode=Mode.PAUSED)


def keys(*pieces: bytes) -> list[str]:
    """Keys in `pieces`, with a rest after the last."""
    parser = Keys()
    return [key for piece in pieces for key in parser.feed(piece)] + parser.flush()


@pytest.mark.parametrize(
    ("data", "found"),
    [
        (b"p", ["p"]),
        (b" s\t\r", ["space", "s", "tab", "enter"]),
        (b"\x1b[C\x1bOD", ["right", "left"]),
        (b"\x1b[1;5C", ["right"]),
        (b"\x1b", ["escape"]),
        (b"\x1b\x1b[D", ["escape", "left"]),
        (b"\x1bp", ["escape", "p"]),
        (b"\x1b[", ["escape"]),
        (b"\x1b[3~", []),
        (b"\xc3\xa9\x00\x7f", []),
        (b"\x1b[200~pyq\x1b[201~m", ["m"]),
    ],
)
def test_bytes_are_keys(data: bytes, found: list[str]) -> None:
    assert keys(data) == found


def test_a_sequence_that_never_ends_is_given_up_and_stops_the_arm() -> None:
    assert Keys().feed(b"\x1b[" + b"1" * 100)[0] == "escape"


@given(st.lists(st.sampled_from([b"\x1b[C", b"p", b"\x1b[200~x\x1b[201~", b"\x1bOA", b"\t"])), st.data())
def test_keys_are_the_same_however_their_bytes_are_cut(whole: list[bytes], data: st.DataObject) -> None:
    joined = b"".join(whole)
    cuts = sorted(data.draw(st.lists(st.integers(0, len(joined)), max_size=6)))
    pieces = [joined[a:b] for a, b in zip([0, *cuts], [*cuts, len(joined)], strict=True)]
    assert keys(*pieces) == keys(joined)


@given(st.binary(max_size=80))
def test_no_bytes_break_the_parser_or_stay_in_it_for_ever(noise: bytes) -> None:
    parser = Keys()
    parser.feed(noise)
    parser.flush()
    parser.feed(b"\x1b[201~")
    parser.flush()
    assert parser.feed(b"s") == ["s"]


def hands(frame: Frame | None = TWO, operator: bool = True) -> Hands:
    at = Hands(operator=operator)
    if frame:
        at.see(received(frame))
    return at


@pytest.mark.parametrize("operator", [True, False])
@pytest.mark.parametrize("frame", [TWO, PAUSED, None])
@pytest.mark.parametrize("key", ["s", "space", "escape"])
def test_three_keys_stop_the_arm_for_anybody_at_any_time(
    key: str, frame: Frame | None, operator: bool
) -> None:
    assert hands(frame, operator).press(key, 1.0) == [Ask("stop")]


@pytest.mark.parametrize("key", ["p", "t", "h", "left", "right", "tab", "a", "r", "m", "y"])
def test_who_only_looks_does_nothing_else_by_keys(key: str) -> None:
    at = hands(operator=False)
    assert at.press(key, 1.0) == []
    assert key == "y" or at.said == "you may look, and stop the arm"
    assert hands(None).press(key, 1.0) == []


def test_an_arm_that_may_move_is_paused_at_once() -> None:
    assert hands().press("p", 1.0) == [Ask("pause", {"on": True})]


@pytest.mark.parametrize(
    ("key", "ask"),
    [("p", Ask("pause", {"on": False})), ("t", Ask("torque", {"on": False})), ("r", Ask("recording_stop"))],
)
def test_what_lets_the_arm_move_or_fall_is_asked_back(key: str, ask: Ask) -> None:
    at = hands(PAUSED)
    at.recording = True
    assert at.press(key, 1.0) == []
    assert "press y" in at.said
    assert at.press("y", 1.0 + SURE) == [ask]
    assert at.press("y", 1.1 + SURE) == [], "once is once"


def test_a_key_that_is_held_never_confirms_itself_nor_does_another_or_a_late_one() -> None:
    at = hands(PAUSED)
    assert [at.press("p", 1.0 + 0.03 * step) for step in range(200)] == [[]] * 200
    assert at.press("y", 8.0 + SURE) == []
    at.press("p", 20.0)
    at.press("g", 20.1)
    assert at.press("y", 20.2) == []


def test_limp_joints_get_torque_at_once() -> None:
    limp = replace(TWO, mode=Mode.LIMP, joints=(replace(JOINT, torque=False),))
    assert hands(limp).press("t", 1.0) == [Ask("torque", {"on": True})]


def test_arrows_and_tab_are_for_the_chosen_group() -> None:
    at = hands()
    assert at.press("right", 1.0) == [Ask("group_command", {"group": "arm", "effort": 0.5, "lease_s": 0.15})]
    assert at.press("g", 2.0) == []
    assert at.press("left", 3.0) == [Ask("group_command", {"group": "hand", "effort": -0.5, "lease_s": 0.15})]
    assert at.press("tab", 4.0) == [Ask("group_toggle", {"group": "hand"})]
    assert at.press("tab", 4.03) == [], "a key that is held toggles once"
    assert at.press("left", 4.05), "and an arrow that is held goes on"


def goal(number: int, status: str, reason: str = "") -> Frame:
    return replace(TWO, goal=GoalFrame(number, "go_home", status, 0.5, reason))  # type: ignore[arg-type]


def test_a_homing_is_renewed_until_it_ends() -> None:
    at = hands()
    asked = at.press("h", 1.0)
    assert [ask.method for ask in asked] == ["go_home"]
    at.answered(asked[0], {"goal": 7})
    at.see(received(goal(6, "cancelled")))
    at.see(received(goal(7, "moving")))
    assert at.renewals() == asked
    at.see(received(goal(7, "cancelled", "the wearer moved")))
    assert at.renewals() == []
    assert at.said == "homing cancelled: the wearer moved"


@pytest.mark.parametrize("key", ["x", "p", "h", "right", "enter", "q"])
def test_any_key_cancels_a_homing_and_does_nothing_else(key: str) -> None:
    at = hands()
    at.press("h", 1.0)
    assert at.press("h", 1.5) == [], "the key is still held"
    assert at.press(key, 9.0) == [Ask("go_home_cancel")]
    assert at.renewals() == []
    assert at.quits is (key == "q")


def test_a_homing_that_is_refused_or_stopped_or_loses_its_daemon_is_not_renewed() -> None:
    refused, stopped, lost = hands(), hands(), hands()
    for at in (refused, stopped, lost):
        at.press("h", 1.0)
        assert at.renewals()
    refused.refused(Ask("go_home"), "torque is off")
    stopped.press("space", 2.0)
    lost.lose("gone")
    assert [at.renewals() for at in (refused, stopped, lost)] == [[], [], []]


def test_the_assist_is_switched_off_and_on_again_as_it_was() -> None:
    at = hands()
    assert at.press("a", 1.0) == [Ask("assist_set", {"group": "arm", "mode": "off"})]
    at.see(received(replace(TWO, assist=replace(TWO.assist, mode="off"))))
    assert at.press("a", 2.0) == [Ask("assist_set", {"group": "arm", "mode": "dpcc"})]
    at.press("g", 3.0)
    assert at.press("a", 4.0) == []
    assert at.said == "nothing helps with hand"


def test_recordings_marks_help_and_the_end() -> None:
    at = hands()
    assert at.press("r", 1.0) == [Ask("recording_start")]
    assert at.press("m", 2.0) == [Ask("mark", {"mark": "note"})]
    at.press("?", 3.0)
    shown = at.help
    at.press("q", 4.0)
    assert (shown, at.help, at.quits) == (True, False, False)
    at.press("q", 5.0)
    assert at.quits


@pytest.mark.parametrize("key", ["p", "y", "h", "t", "a", "right", "tab", "q", "?", "z"])
def test_a_key_that_closes_the_help_does_only_that_also_while_it_is_held(key: str) -> None:
    at = hands(PAUSED)
    at.press("t", 1.0)
    at.press("?", 2.0)
    assert [at.press(key, 2.5 + 0.5 * step) for step in range(9)] == [[]] * 9
    assert (at.help, at.homing, at.quits) == (False, False, False)


@pytest.mark.parametrize("key", ["s", "space", "escape"])
def test_stop_keys_stop_beneath_the_help_and_close_it(key: str) -> None:
    at = hands()
    at.press("?", 1.0)
    assert at.press(key, 2.0) == [Ask("stop")]
    assert not at.help


def test_the_help_hides_no_daemon_that_is_gone() -> None:
    at = hands()
    at.press("?", 1.0)
    at.lose("gone")
    assert not at.help


def test_a_key_that_means_nothing_says_so() -> None:
    at = hands()
    assert at.press("z", 1.0) == []
    assert at.said == "no such key: ? lists them"


def test_the_help_fits_a_small_window() -> None:
    assert len(HELP) < 22
    assert max(len(what) for _, what in HELP) < 60
