"""Who moves a joint when several want to: stop before client, before home, before operator, before assist."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from bentod.control.modes import Modes
from bentod.frames import Command, Mode, Stop, Wishes

OPERATORS = ("emg", "joystick")
"""Those who drive groups of joints by effort. Of each group one of them does, which `Operators` decides."""

PRIORITY = ("client", "home", *OPERATORS, "assist")
"""Sources of wishes, strongest first. Pause, fault and missing torque stand before all of them."""


@dataclass(frozen=True, slots=True)
class Decision:
    """What one joint will be told, and by whom."""

    command: Command | None  # None: the joint is limp and is not touched
    holder: str  # the source that won; the mode, if that is what stops the joint; "" if nobody asks


def arbitrate(wishes: Mapping[str, Wishes], modes: Modes, joints: int) -> tuple[Decision, ...]:
    """One decision a joint. A joint that nobody asks to move is told to stop and so holds."""
    return tuple(_decide(joint, wishes, modes) for joint in range(joints))


def asked_of(joint: int, wishes: Mapping[str, Wishes]) -> dict[str, Command]:
    """What each source asks of one joint, for the record."""
    return {source: wishes[source][joint] for source in PRIORITY if joint in wishes.get(source, {})}


def attended(sources: Sequence[str], wishes: Mapping[str, Wishes], modes: Modes) -> frozenset[int]:
    """Joints that the given sources ask to move and that may."""
    asked = {joint for source in sources for joint, wish in wishes.get(source, {}).items() if wish != Stop()}
    return frozenset(joint for joint in asked if modes.of(joint) is Mode.ACTIVE)


def _decide(joint: int, wishes: Mapping[str, Wishes], modes: Modes) -> Decision:
    if not modes.has_torque(joint):
        return Decision(None, "")
    mode = modes.of(joint)
    if mode is not Mode.ACTIVE:
        return Decision(Stop(), mode.value)
    for source, command in asked_of(joint, wishes).items():
        return Decision(command, source)
    return Decision(Stop(), "")
