"""What a joystick asks, as every frame tells it."""

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class JoystickFrame:
    """A joystick or gamepad in one tick."""

    connected: bool
    paused: bool  # by its own button, which leaves everybody else alone
    problem: str  # why it moves nothing although it is not paused; empty otherwise
    held: bool  # the dead man's button; always true where the config wants none
    axes: Mapping[str, float]  # by number, -1..1: after dead zone, expo, direction and share of the speed
