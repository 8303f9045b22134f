"""Presses: each once, none from before, and what needs the dead man held."""

from dataclasses import replace

from bentod.config_joystick import Button
from bentod.contracts import Pad
from bentod.control.joystick_buttons import Buttons

STOP = Button(button=0, action="stop")
HOME = Button(button=1, action="home")
NEXT = Button(button=2, action="toggle", group="arm")


def pad(*presses: int, openings: int = 1) -> Pad:
    return Pad(connected=True, presses=presses, openings=openings)


def test_a_press_counts_once_however_long_it_lasts() -> None:
    buttons = Buttons([STOP])
    assert buttons.step(pad(1), held=False, hushed=False).heard == (STOP,)
    assert buttons.step(pad(1), held=False, hushed=False).heard == ()


def test_two_presses_within_a_tick_are_one_since_contacts_bounce() -> None:
    buttons = Buttons([NEXT])
    assert buttons.step(pad(0, 0, 3), held=False, hushed=False).heard == (NEXT,)


def test_what_was_pressed_before_the_pad_was_opened_anew_does_not_count() -> None:
    buttons = Buttons([STOP])
    buttons.step(pad(5), held=False, hushed=False)
    again = pad(0, openings=2)
    assert buttons.step(again, held=False, hushed=False).heard == ()
    assert buttons.step(replace(again, presses=(1,)), held=False, hushed=False).heard == (STOP,)


def test_what_may_set_the_arm_in_motion_needs_the_dead_man() -> None:
    buttons = Buttons([STOP, HOME])
    pressed = buttons.step(pad(1, 1), held=False, hushed=False)
    assert (pressed.heard, pressed.unheld) == ((STOP,), (HOME,))
    assert buttons.step(pad(1, 2), held=True, hushed=False).heard == (HOME,)


def test_restraint_is_always_heard_and_nothing_else_is_kept_for_later() -> None:
    buttons = Buttons([STOP, HOME, NEXT])
    assert buttons.step(pad(1, 1, 1), held=True, hushed=True).heard == (STOP,)
    assert buttons.step(pad(1, 1, 1), held=True, hushed=False).heard == ()


def test_a_button_that_the_pad_does_not_have_is_never_pressed() -> None:
    assert Buttons([NEXT]).step(pad(1), held=True, hushed=False).heard == ()
