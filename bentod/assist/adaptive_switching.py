"""Adaptive switching: toggles go first to the joint that is expected to be needed next.

After Edwards et al., "Machine learning and unlearning to autonomously switch between the functions of a
myoelectric arm", BioRob 2016, as thesis 4.4 tells it. Of each joint of the group a general value function
learns how much it is about to be used; a toggle goes to the most needed one, the next to the next, and last
of all to the joint that toggling began from. The order stands until the operator moves something, so that
nothing changes under their hands while they look for a joint.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields

from bentod.contracts_assist import TOGETHER, Assist, Assistance, AssistSettings, Situation
from bentod.errors import BadRequest, nearest
from bentod.frames import JointSpec, Value

ALL = "together"
"""The name of all joints at once among those of single joints."""


@dataclass(frozen=True, slots=True)
class SwitchingOptions:
    """The table `options` of `adaptive_switching`."""

    use_timescale: float = 60.0  # ticks, above 1 up to 10,000: how far ahead a joint's use is predicted
    effort: float = 0.05  # 0..1, above which a joint is in use

    def __post_init__(self) -> None:
        if not 1 < self.use_timescale <= 10_000:
            raise BadRequest(
                f"The assistance's use_timescale must be above 1 up to 10000, not {self.use_timescale}.",
                "use_timescale",
            )
        if not 0 <= self.effort < 1:
            raise BadRequest(
                f"The assistance's effort must be from 0 and below 1, not {self.effort}.", "effort"
            )


class AdaptiveSwitching(Assist):
    """Moves nothing by itself: it only says in which order toggles go."""

    def __init__(self, specs: Sequence[JointSpec], settings: AssistSettings) -> None:
        """Raises BadRequest: an option is unknown, or out of its bounds."""
        self._names = {joint: spec.name for joint, spec in enumerate(specs)} | {TOGETHER: ALL}
        self._options = _options(settings)
        self._toggling = False
        self._order: tuple[int, ...] | None = None
        self._needs: dict[int, float] = {}

    def adjust(self, settings: AssistSettings) -> None:
        """As in `Assist`."""
        self._options = _options(settings)

    def wish(self, situation: Situation) -> Assistance:
        """As in `Assist`: nothing, but what the order is."""
        if situation.attended is not None or (situation.together and situation.effort):
            self._toggling = False
        if not self._toggling:
            self._needs = {
                entry: situation.outlook.answer(f"{situation.group}.use.{self._names[entry]}")
                for entry in (*situation.joints, TOGETHER)
            }
            self._order = self._ranked(situation)
        return Assistance({}, False, self._explain(situation))

    def toggled(self, now: float) -> None:
        """The order stands from here until something moves."""
        self._toggling = True

    def order(self, situation: Situation) -> tuple[int, ...] | None:
        """Most needed first, that from which toggling began last; None: nothing is known yet."""
        return self._order

    def told(self) -> Mapping[str, Value]:
        """The need of each joint, as of when the order was made: share of the time to come, 0..1."""
        finite = {entry: need for entry, need in self._needs.items() if math.isfinite(need)}
        return {"need": {self._names[entry]: round(need, 4) for entry, need in finite.items()}}

    def asks(self, group: str, joints: Sequence[str]) -> tuple[Mapping[str, Value], ...]:
        """As in `Asking`: of each joint, and of all at once, how much it is about to be used."""
        signals = {joint: f"{group}.active.{joint}" for joint in joints}
        together = f"{group}.together"
        used = f"above(abs({group + '.effort'!r}), {self._options.effort!r})"
        alone = {joint: f"{signal!r} * (1 - {together!r}) * {used}" for joint, signal in signals.items()}
        cumulants = {**alone, ALL: f"{together!r} * {used}"}
        return tuple(
            {
                "name": f"{group}.use.{name}",
                "cumulant": cumulant,
                "timescale": self._options.use_timescale,
                "confidence": False,
            }
            for name, cumulant in cumulants.items()
        )

    def _ranked(self, situation: Situation) -> tuple[int, ...] | None:
        """Equal needs in the order of the group's list, from the selected joint on."""
        if not all(math.isfinite(self._needs[joint]) for joint in situation.joints):
            return None
        listed = [*situation.joints, TOGETHER]
        place = listed.index(_selected(situation))
        others = listed[place + 1 :] + listed[:place]
        ranked = sorted(others, key=self._worth)
        return (*ranked, listed[place])

    def _worth(self, entry: int) -> float:
        need = self._needs[entry]
        return -max(need, 0.0) if math.isfinite(need) else 0.0

    def _explain(self, situation: Situation) -> str:
        if self._order is None:
            return "Toggles go as the joints are listed, for no use of them is predicted yet."
        place = self._order.index(_selected(situation)) + 1
        coming = [*self._order[place:], *self._order[: place - 1]]
        joints = [entry for entry in coming if entry != TOGETHER]
        if not joints:
            return "There is nothing to toggle to."
        first, *rest = [f"{self._names[j].replace('_', ' ')} ({self._needs[j]:.2f})" for j in joints]
        return ", then to ".join([f"The next toggle goes to {first}", *rest[:1]]) + ", by need."


def _selected(situation: Situation) -> int:
    return TOGETHER if situation.together else situation.active


def _options(settings: AssistSettings) -> SwitchingOptions:
    known = [field.name for field in fields(SwitchingOptions)]
    for name in settings.options:
        if name not in known:
            raise BadRequest(f"adaptive_switching has no option '{name}'{nearest(name, known)}", name)
    return SwitchingOptions(**settings.options)


def open_assist(specs: Sequence[JointSpec], rate_hz: float, settings: AssistSettings) -> AdaptiveSwitching:
    """The assist. Raises BadRequest: an option is unknown, or out of its bounds."""
    return AdaptiveSwitching(specs, settings)
