"""How one servo behaves, and how it is to be stopped, as the config and the calibration say."""

import math
from dataclasses import dataclass

from drivers.dynamixel.stopping import StopRule


@dataclass(frozen=True, slots=True)
class Tuning:
    """Of one joint."""

    dead_time_s: float = 0.017  # from the arrival of a command to its effect (T_cmd)
    bus_time_s: float = 0.002  # from the decision to the arrival of the command (T_bus)
    longest_age_s: float = 0.5  # beyond this age of a reading the joint is no longer extrapolated
    p_gain: float = 32.0  # P gain register
    goal_acceleration: float = 0.0  # rad/s², 0: unlimited
    rule: StopRule = "full"
    tick: float = math.tau / 4096  # rad, one step of a position
    slowest: float = math.radians(0.684)  # rad/s, the least speed the servo can be given, and its step
    pin_speed: float = math.radians(5 * 0.684)  # rad/s, when a joint is pinned where it is
    learning: bool = True  # whether the dead time is corrected by what the joint does
    dead_man: float = 0.0  # s that a motion lasts without a further order; 0: to its end
