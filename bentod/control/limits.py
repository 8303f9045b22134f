"""The last stage before the bus: nothing leaves that is not a number within the joint's limits."""

import math

from bentod.frames import Command, JointSpec, JointState, Position, Stop, Velocity


def limit(command: Command | None, spec: JointSpec, state: JointState) -> Command | None:
    """`command` cut to the joint's position and velocity limits (rad, rad/s).

    A velocity that leads further out of the limits becomes a stop, and so does anything not finite, and
    every command to a joint whose position is not known.
    """
    if command is not None and not math.isfinite(state.position):
        return Stop()
    match command:
        case Velocity(velocity=velocity):
            return _velocity(velocity, spec, state)
        case Position(position=position, speed=speed):
            return _position(position, speed, spec)
        case _:
            return command


def _velocity(velocity: float, spec: JointSpec, state: JointState) -> Command:
    if not math.isfinite(velocity) or velocity == 0:
        return Stop()
    outward = state.position >= spec.maximum if velocity > 0 else state.position <= spec.minimum
    return Stop() if outward else Velocity(max(-spec.max_velocity, min(spec.max_velocity, velocity)))


def _position(position: float, speed: float, spec: JointSpec) -> Command:
    if not (math.isfinite(position) and math.isfinite(speed)) or speed <= 0:
        return Stop()
    return Position(spec.clamp(position), min(speed, spec.max_velocity))
