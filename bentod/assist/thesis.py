"""Direct predictive collaborative control exactly as in thesis 5.3, behind the contract of assists."""

import math
from collections.abc import Sequence

from bentod.assist.dpcc import Dpcc, DpccSettings
from bentod.contracts_assist import Assist, Assistance, AssistSettings, Situation
from bentod.errors import BadRequest
from bentod.frames import JointSpec


class ThesisDpcc(Assist):
    """Every unattended joint goes to where it is expected, whatever the confidence."""

    def __init__(self, specs: Sequence[JointSpec], rate_hz: float, settings: AssistSettings) -> None:
        self._joints = len(specs)
        self._dpcc = Dpcc(specs, rate_hz, self._own(settings))

    def adjust(self, settings: AssistSettings) -> None:
        """As in `Assist`."""
        self._dpcc.settings = self._own(settings)

    def wish(self, situation: Situation) -> Assistance:
        """As in `Assist`; thesis (5.1)."""
        timescale, outlook = self._dpcc.settings.timescale, situation.outlook
        told = {joint: outlook.position(joint, timescale) for joint in situation.joints}
        expected = {joint: position for joint, position in told.items() if math.isfinite(position)}
        positions = [joint.position for joint in situation.state.joints]
        helped = self._dpcc.wish(situation.time, situation.attended, situation.joints, positions, expected)
        return Assistance(helped.wishes, helped.frame.engaged, helped.frame.reason)

    def toggled(self, now: float) -> None:
        """As in `Assist`."""
        self._dpcc.toggled(now)

    def _own(self, settings: AssistSettings) -> DpccSettings:
        if settings.options:
            raise BadRequest(f"dpcc has no option '{min(settings.options)}'", "options")
        limits = dict.fromkeys(range(self._joints), settings.velocity_limit)
        return DpccSettings(
            enabled=True,
            timescale=settings.timescale,
            k=settings.k,
            velocity_limits=limits,
            manual=settings.manual,
        )


def open_assist(specs: Sequence[JointSpec], rate_hz: float, settings: AssistSettings) -> ThesisDpcc:
    """The thesis' assist. Raises BadRequest: a setting is out of its bounds."""
    return ThesisDpcc(specs, rate_hz, settings)
