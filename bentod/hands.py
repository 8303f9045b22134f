"""What operators ask in a tick, muscles and joystick; what a button does is done first, and so in time."""

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress

from bentod.config_joystick import Button
from bentod.control.grips import Hold
from bentod.control.leases import Holder, Lease
from bentod.desk import Desk
from bentod.errors import BentodError, Refused
from bentod.frames import Wishes
from bentod.muscles import Look

NAME = "the joystick"

HOLDER = Holder(-1, NAME)
"""Of the lease on a goal; sessions of clients have numbers from 1."""

HOME_LEASE = 0.1
"""s after the last tick in which somebody held on, should ticks fail to come."""


def operate(desk: Desk, look: Look, now: float) -> dict[str, Wishes]:
    """What each operator may have of what they ask at `now` (monotonic s)."""
    if desk.joystick is None:
        return desk.operate({"emg": look.asked})
    push = desk.joystick.look(now, bool(desk.recency.doubt()))
    for button in push.pressed:
        _press(desk, button)
    _keep_home(desk, push.home)
    return desk.operate({"emg": look.asked, "joystick": push.asked}, {"joystick": push.joints})


def _press(desk: Desk, button: Button) -> None:
    """Do what a button is for, as if a client had asked; a refusal is told and stops nothing."""
    try:
        _VERBS[button.action](desk, button)
    except BentodError as error:
        desk.journal.note("joystick", f"not done: '{button.action}': {error}", {"action": button.action})


def _keep_home(desk: Desk, button: Button | None) -> None:
    """A way home goes on only as long as somebody holds on; what was stopped does not begin anew."""
    if button is None:
        desk.goals.let_go(HOLDER.session, f"{NAME} let go of it")
        return
    with suppress(Refused):
        desk.goals.renew(Lease(HOLDER, frozenset(_joints(desk, button)), desk.now + HOME_LEASE))


def _joints(desk: Desk, button: Button) -> Sequence[int]:
    """Those that a button is about: one, a group's, or all."""
    return desk.groups.group(button.group).joints if button.group else desk.select(button.joint)


_VERBS: Mapping[str, Callable[[Desk, Button], object]] = {
    "pause": lambda desk, button: desk.pause(_joints(desk, button), True),
    "release": lambda desk, button: desk.pause(_joints(desk, button), False),
    "torque": lambda desk, button: desk.torque(_joints(desk, button), button.on),
    "home": lambda desk, button: desk.go_home(_joints(desk, button), Hold(HOLDER, HOME_LEASE)),
    "stop": lambda desk, button: desk.stop(NAME),
    "mark": lambda desk, button: desk.mark(button.mark, NAME),
}
