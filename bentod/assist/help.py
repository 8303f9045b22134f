"""What helps with one group: an assist that can be exchanged in use, and is kept within its bounds."""

import logging
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from bentod.assist.timescales.choice import Choice
from bentod.contracts_assist import Asking, Assist, Assistance, AssistSettings, OpenAssist, Situation
from bentod.errors import BadRequest, ConfigError
from bentod.frames import AssistFrame, JointSpec, Value, Velocity, Wishes

_log = logging.getLogger(__name__)

OFF = "off"

Memory: TypeAlias = dict[str, NDArray[np.float64]]

_COMMON = {
    "timescale": "timescale",
    "k": "k",
    "velocity_limit_rad_s": "velocity_limit",
    "manual_after_toggle_s": "manual",
    "timescale_by": "timescale_by",
    "toggle_reward": "toggle_reward",
    "contact_reward": "contact_reward",
}
"""Settings that all assists have, by the names that clients and configs use."""


class Help:
    """Of one group. What an assist learns stays while another mode is in use."""

    def __init__(
        self,
        group: str,
        specs: Sequence[JointSpec],
        rate_hz: float,
        settings: AssistSettings,
        open_assist: Callable[[str], OpenAssist],
        choice: Choice | None = None,
    ) -> None:
        """It is off until `change` says another mode. `open_assist`: factories by mode.

        `choice`: what finds timescales; without, they are fixed.
        """
        self.choice = choice or Choice(group, specs, (), rate_hz)
        self.group = group
        self.mode = OFF
        self.settings = settings
        self._specs = tuple(specs)
        self._rate_hz = rate_hz
        self._open = open_assist
        self._opened: dict[str, Assist] = {}
        self._remembered: dict[str, Memory] = {}
        self._assist: Assist | None = None
        self._broken: dict[str, str] = {}

    @property
    def assist(self) -> Assist | None:
        """What helps now; None while it is off or broken."""
        return None if self.mode in self._broken else self._assist

    def follows(self, timescales: Sequence[float]) -> Sequence[float]:
        """Of the `timescales` (ticks) that are predicted, those that are needed before the write."""
        if self._assist is None:
            return []
        all_ = self._assist.needs_all() or not self.choice.fixed
        return timescales if all_ else [self.settings.timescale]

    def wish(self, situation: Situation, obstacle: str = "") -> tuple[Wishes, AssistFrame]:
        """What to ask in this tick, and what to tell of it. `obstacle`: why nothing may be asked."""
        attended = "" if situation.attended is None else self._specs[situation.attended].name
        reason = obstacle or self._broken.get(self.mode, "")
        if reason or self._assist is None:
            self.choice.off()
        if reason:
            return {}, AssistFrame(OFF, False, reason, attended, self.group)
        if self._assist is None:
            return {}, AssistFrame(OFF, False, "Assistance is switched off.", attended, self.group)
        try:
            situation = self.choice.look(situation)
            helped = self._bounded(self._assist.wish(situation), situation)
            helped = replace(helped, reason=self._explained(helped))
        except Exception as error:  # noqa: BLE001 -- whatever an assist does, the wearer's control goes on
            helped = self._give_up(error)
        frame = AssistFrame(self.mode, helped.engaged, helped.reason, attended, self.group)
        return helped.wishes, replace(frame, moving=self._moving(helped), offers_together=self._offers())

    def toggled(self, now: float) -> None:
        """The operator has selected another joint of the group (monotonic s)."""
        for assist in self._opened.values():
            assist.toggled(now)
        self.choice.toggled()

    def offers_together(self, obstacle: str = "") -> bool:
        """Whether all joints may be selected at once. `obstacle`: why nothing may be asked."""
        return not obstacle and self._offers()

    def order(self, situation: Situation) -> tuple[int, ...] | None:
        """In which order toggles go through the group; None: as the config lists it."""
        try:
            return self.assist.order(situation) if self.assist else None
        except Exception as error:  # noqa: BLE001 -- as in `wish`
            self._give_up(error)
            return None

    def asks(self, joints: Sequence[str]) -> tuple[Mapping[str, Value], ...]:
        """Tables of the questions that the assist needs answered about `joints` of the group."""
        assist = self.assist
        if assist is None:
            return ()
        own = assist.asks(self.group, joints) if isinstance(assist, Asking) else ()
        return (*own, *self.choice.asks())

    def rewarded(self, reward: float) -> None:
        """Somebody was pleased (above 0), or not (below 0)."""
        self.choice.rewarded(reward)
        if self.assist:
            self.assist.rewarded(reward)

    def memory(self) -> dict[str, NDArray[np.float64]]:
        """Copies of what all modes know, and of what was found out about timescales."""
        modes = {f"mode {mode}": assist.memory() for mode, assist in self._opened.items()}
        known = {f"{mode}/{name}": array for mode, part in modes.items() for name, array in part.items()}
        return {**known, **self.choice.memory()}

    def recall(self, memory: Mapping[str, NDArray[np.float64]]) -> None:
        """Go on with it; a mode that is chosen later will, too. What does not fit is logged and left out."""
        self.choice.recall(memory)
        self._remembered = {}
        for name, array in memory.items():
            mode, _, rest = name.partition("/")
            if mode.startswith("mode "):
                self._remembered.setdefault(mode.removeprefix("mode "), {})[rest] = array
        for mode in self._opened:
            self._remind(mode)

    def change(self, changes: Mapping[str, Value]) -> None:
        """Change some of what `describe` shows. Raises BadRequest: a value is none; nothing has changed."""
        mode = str(changes.get("mode", self.mode))
        settings = self._changed(changes)
        self.choice.check(settings)
        assist = self._find(mode, settings)
        if assist is not None:
            assist.adjust(settings)
        self.choice.adjust(settings)
        self.mode, self.settings, self._assist = mode, settings, assist
        self._broken.pop(mode, None)

    def describe(self) -> dict[str, Value]:
        """The settings as clients see them, and what the assist has found out."""
        common: dict[str, Value] = {key: getattr(self.settings, name) for key, name in _COMMON.items()}
        told = dict(self._assist.told()) if self._assist else {}
        told |= {"timescales": dict(self.choice.told())} if not self.choice.fixed else {}
        options = dict[str, Value](self.settings.options)
        return {"mode": self.mode, "group": self.group, **common, "options": options, "told": told}

    def _changed(self, changes: Mapping[str, Value]) -> AssistSettings:
        given = {name: changes[key] for key, name in _COMMON.items() if key in changes}
        numbers = {name: float(value) for name, value in given.items() if isinstance(value, int | float)}
        numbers.pop("timescale_by", None)
        by = str(changes.get("timescale_by", self.settings.timescale_by))
        options = changes.get("options", {})
        if not isinstance(options, dict) or not all(isinstance(v, int | float) for v in options.values()):
            raise BadRequest("options must be a table of numbers", "options")
        same = changes.get("mode", self.mode) == self.mode
        kept = self.settings.options if same else {}  # else they are another mode's
        more = {name: float(value) for name, value in options.items() if isinstance(value, int | float)}
        return replace(self.settings, **numbers, timescale_by=by, options={**kept, **more})

    def _find(self, mode: str, settings: AssistSettings) -> Assist | None:
        if mode == OFF:
            return None
        if mode not in self._opened:
            try:
                self._opened[mode] = self._open(mode)(self._specs, self._rate_hz, settings)
            except ConfigError as error:
                raise BadRequest(f"mode: {error}", "mode") from error
            self._remind(mode)
        return self._opened[mode]

    def _remind(self, mode: str) -> None:
        try:
            self._opened[mode].recall(self._remembered.get(mode, {}))
        except ValueError as error:
            _log.warning("What %s knew of %s is left out: %s.", mode, self.group, error)

    def _bounded(self, helped: Assistance, situation: Situation) -> Assistance:
        """Only joints that the operator does not move, only while they move, only finite velocities."""
        moved = set(situation.joints) - ({situation.attended} - {None})
        moves = situation.attended is not None or (situation.together and situation.effort != 0)
        allowed = {j: wish for j, wish in helped.wishes.items() if moves and j in moved and _finite(wish)}
        return replace(helped, wishes=allowed, engaged=helped.engaged and moves)

    def _explained(self, helped: Assistance) -> str:
        return f"{helped.reason} {self.choice.words()}".rstrip() if helped.engaged else helped.reason

    def _offers(self) -> bool:
        try:
            return self.assist is not None and self.assist.offers_together()
        except Exception as error:  # noqa: BLE001 -- as in `wish`
            self._give_up(error)
            return False

    def _moving(self, helped: Assistance) -> dict[str, float]:
        found = helped.wishes.items()
        return {self._specs[j].name: wish.velocity for j, wish in found if isinstance(wish, Velocity)}

    def _give_up(self, error: Exception) -> Assistance:
        _log.exception("the assist %s broke and is off", self.mode)
        reason = f"The assist {self.mode} broke and is off: {type(error).__name__}: {error}"
        self._broken[self.mode] = reason
        return Assistance({}, False, reason)


def _finite(wish: object) -> bool:
    return isinstance(wish, Velocity) and math.isfinite(wish.velocity)
