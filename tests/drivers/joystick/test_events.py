"""Linux' joystick events, as the bytes that the kernel gives."""

import struct

from hypothesis import given
from hypothesis import strategies as st

from drivers.joystick.events import Controls

PRESSED = bytes.fromhex("10 27 00 00 01 00 01 05")  # at 10 s: button 5 is down
LET_GO = bytes.fromhex("20 27 00 00 00 00 01 05")
HELD_AT_FIRST = bytes.fromhex("10 27 00 00 01 00 81 05")
PUSHED = bytes.fromhex("10 27 00 00 ff 7f 02 01")  # axis 1 at 32767
PULLED = bytes.fromhex("10 27 00 00 01 80 02 01")  # at -32767
BEYOND = bytes.fromhex("10 27 00 00 00 80 02 01")  # at -32768
HALF_AT_FIRST = bytes.fromhex("10 27 00 00 00 40 82 00")  # axis 0 at 16384


def told(*data: bytes) -> Controls:
    controls = Controls()
    for piece in data:
        controls.feed(piece)
    return controls


def test_an_axis_goes_from_minus_one_to_one() -> None:
    assert told(PUSHED).axes == (0.0, 1.0)
    assert told(PULLED).axes == told(BEYOND).axes == (0.0, -1.0)
    assert told(HALF_AT_FIRST, PUSHED).axes == (16384 / 32767, 1.0)


def test_a_press_is_counted_when_the_button_goes_down() -> None:
    controls = told(PRESSED, LET_GO, PRESSED, LET_GO)
    assert (controls.buttons[5], controls.presses[5]) == (False, 2)
    assert told(PRESSED, PRESSED).presses[5] == 1


def test_a_button_that_was_down_when_the_device_was_opened_is_no_press() -> None:
    controls = told(HELD_AT_FIRST)
    assert (controls.buttons[5], controls.presses[5]) == (True, 0)
    controls.feed(LET_GO + PRESSED)
    assert controls.presses[5] == 1


def test_records_that_come_in_pieces_are_put_together() -> None:
    whole = HALF_AT_FIRST + PRESSED + PULLED
    controls = told(*[bytes([byte]) for byte in whole])
    assert (controls.axes, controls.buttons[5]) == ((16384 / 32767, -1.0), True)


def test_records_of_no_known_kind_and_of_absurd_numbers_are_passed_over() -> None:
    strange = [struct.pack("<IhBB", 1, 1, kind, 0) for kind in (0, 3, 4, 0x80, 0x83)]
    absurd = [struct.pack("<IhBB", 1, 1, kind, 200) for kind in (1, 2)]
    controls = told(*strange, *absurd)
    assert (controls.axes, controls.buttons, controls.presses) == ((), (), ())


@given(st.lists(st.binary(max_size=40), max_size=20))
def test_garbage_never_breaks_it_and_stays_within_bounds(pieces: list[bytes]) -> None:
    controls = told(*pieces)
    assert all(-1 <= value <= 1 for value in controls.axes)
    assert len(controls.buttons) == len(controls.presses) <= 128
    in_one = told(b"".join(pieces))
    assert (controls.axes, controls.presses) == (in_one.axes, in_one.presses)
