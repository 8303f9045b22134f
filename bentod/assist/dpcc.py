"""Direct predictive collaborative control: a joint is sent to where it is expected to be (thesis 5.3)."""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field

from bentod.errors import BadRequest
from bentod.frames import AssistFrame, JointSpec, Velocity, Wishes


def dpcc_velocity(predicted: float, position: float, rate_hz: float, k: float) -> float:
    """V = (P − θ) · f · k in rad/s, thesis (5.1): the share k of the way from θ to P (rad) in one tick."""
    return (predicted - position) * rate_hz * k


@dataclass(frozen=True, slots=True)
class DpccSettings:
    """What may be changed while the arm is in use."""

    enabled: bool = False
    timescale: float = 20.0  # steps; which of the predictions to follow
    k: float = 0.025  # share of the way a tick, 0 < k < 1; the thesis: 0.025 for way points, 0.1 in the maze
    velocity_limits: Mapping[int, float] = field(default_factory=dict)
    """Rad/s, by joint; a joint that is absent may go as fast as its own maximum, none may go faster."""
    dead_band: float = 0.012  # rad/s; the least speed of a Dynamixel MX: 0.114 rpm a step
    manual: float = 0.5  # s without assistance after a toggle

    def __post_init__(self) -> None:
        _require(1 <= self.timescale < math.inf, "timescale", self.timescale, "at least 1 step")
        _require(0 < self.k < 1, "k", self.k, "above 0 and below 1")
        _require(0 <= self.dead_band < math.inf, "dead_band", self.dead_band, "at least 0 rad/s")
        _require(0 <= self.manual < math.inf, "manual", self.manual, "at least 0 s")
        for joint, limit in self.velocity_limits.items():
            _require(0 < limit < math.inf, "velocity_limits", limit, f"above 0 rad/s for joint {joint}")


@dataclass(frozen=True, slots=True)
class Assistance:
    """What collaborative control asks for in one tick, and why."""

    wishes: Wishes
    frame: AssistFrame


class Dpcc:
    """Moves the joints that the operator is not attending to, but only while the operator moves one.

    A joint sets off at twice the dead band and is let go at the dead band: as it nears the prediction V goes
    to 0, and with one threshold for both the noise in the prediction would switch it on and off.
    """

    def __init__(self, joints: Sequence[JointSpec], rate_hz: float, settings: DpccSettings) -> None:
        self._joints = tuple(joints)
        self._rate_hz = rate_hz
        self._manual_from = -math.inf
        self._last: Mapping[int, float] = {}
        self.settings = settings
        """Replace it to change the parameters from the next tick on."""

    def toggled(self, now: float) -> None:
        """The operator has switched to another joint: back to manual for a while."""
        self._manual_from = now

    def wish(
        self,
        now: float,
        moving_joint: int | None,
        group_joints: Collection[int],
        positions: Sequence[float],
        predictions: Mapping[int, float],
    ) -> Assistance:
        """Velocities for the unattended joints of the group; a joint without a wish is to be held still.

        `moving_joint`: the joint the operator is moving in this tick, None while the hands are at rest.
        `positions`: rad, by joint. `predictions`: rad, by joint, at the timescale of the settings.
        """
        obstacle = self._obstacle(now, moving_joint, group_joints)
        unattended = [joint for joint in group_joints if joint != moving_joint]
        followed = [] if obstacle else [joint for joint in unattended if joint in predictions]
        wanted = {joint: self._velocity(joint, positions[joint], predictions[joint]) for joint in followed}
        self._last = {joint: v for joint, v in wanted.items() if self._worth_moving(joint, v)}
        reason = obstacle or self._explain(followed)
        mode = "dpcc" if self.settings.enabled else "off"
        wishes = {joint: Velocity(v) for joint, v in self._last.items()}
        return Assistance(wishes, AssistFrame(mode, engaged=bool(followed), reason=reason))

    def _obstacle(self, now: float, moving_joint: int | None, group_joints: Collection[int]) -> str:
        """Why nothing may move; empty when something may."""
        if not self.settings.enabled:
            return "Assistance is switched off."
        if now < self._manual_from + self.settings.manual:
            return f"Manual for {self.settings.manual:g} s after a toggle."
        if moving_joint is None or moving_joint not in group_joints:
            return "The operator is not moving a joint of this group."
        return ""

    def _velocity(self, joint: int, position: float, predicted: float) -> float:
        """(5.1) within the limits, rad/s; 0 when position or prediction is not a finite number."""
        spec = self._joints[joint]
        limit = min(spec.max_velocity, self.settings.velocity_limits.get(joint, spec.max_velocity))
        velocity = dpcc_velocity(spec.clamp(predicted), position, self._rate_hz, self.settings.k)
        if not (math.isfinite(velocity) and math.isfinite(predicted)):
            return 0.0
        return min(max(velocity, -limit), limit)

    def _worth_moving(self, joint: int, velocity: float) -> bool:
        keeps_going = self._last.get(joint, 0.0) * velocity > 0
        threshold = self.settings.dead_band * (1 if keeps_going else 2)
        return abs(velocity) >= threshold and velocity != 0

    def _explain(self, followed: Collection[int]) -> str:
        if not followed:
            return f"No unattended joint has a prediction at {self.settings.timescale:g} steps."
        if not self._last:
            return "Every unattended joint is about where it is expected."
        names = ", ".join(self._joints[joint].name for joint in self._last)
        return f"Moves {names} to where the operator usually has it."


def _require(holds: bool, name: str, value: float, bound: str) -> None:
    if not holds:
        raise BadRequest(f"The assistance's {name} must be {bound}, not {value:g}.", field=name)
