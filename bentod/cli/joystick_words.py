"""What the axes and buttons of a joystick do, in sentences."""

from collections.abc import Iterator

from bentod.config_joystick import Axis, Button, Joystick

_DOES = {
    "toggle": "selects the next joint of the group {group}",
    "toggle_back": "selects the previous joint of the group {group}",
    "pause": "pauses {what}",
    "release": "releases {what}",
    "home": "sends {what} home, for as long as the dead man is held",
    "stop": "stops the arm",
    "own_pause": "pauses and releases the joystick itself",
    "mark": "marks '{mark}'",
}


def explain_joystick(table: Joystick) -> Iterator[str]:
    """The table in sentences."""
    button = table.dead_man_button
    needs = "with no dead man's button" if button is None else f"while button {button} is held"
    yield f"Joystick through '{table.source.name}', {needs}."
    yield from (f"  {_axis(axis)}." for axis in table.axes)
    yield from (f"  Button {button.button} {_button(button)}." for button in table.buttons)


def _axis(axis: Axis) -> str:
    target = f"the active joint of {axis.group}" if axis.group else axis.joint
    way = "one way, from its lower end" if axis.one_sided else f"beyond {axis.dead_zone:.0%} of its way"
    turned = ", inverted" if axis.invert else ""
    return f"Axis {axis.axis} drives {target} at up to {axis.max:.0%} of its speed, {way}{turned}"


def _button(button: Button) -> str:
    what = f"the group {button.group}" if button.group else button.joint or "the arm"
    if button.action == "torque":
        return f"switches torque {'on' if button.on else 'off'} for {what}"
    return _DOES[button.action].format(group=button.group, mark=button.mark, what=what)
