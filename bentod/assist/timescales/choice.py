"""By which way the timescale of a group's assist is found: fixed, or one that learns from reward."""

import logging
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from bentod.assist.timescales.learned_way import Gaussian, LearnedWay, OneOf
from bentod.assist.timescales.memories import Memory
from bentod.assist.timescales.postures import Coder, OpenCoder, Postures
from bentod.assist.timescales.state_way import StateWay
from bentod.config_learn import ARM
from bentod.contracts_assist import AssistSettings, Outlook, Situation
from bentod.errors import BadRequest
from bentod.frames import JointSpec, Value

_log = logging.getLogger(__name__)

FIXED, SARSA, BLEND, STATE = "fixed", "sarsa", "blend", "state"

SEED = 1
"""Of all dice: the same again in every replay."""

MOST_REWARD = 100.0
"""Of what comes at once, either way."""

WORTH = 3.0
"""s, over which the reward is predicted that decides γ."""

STEEPNESS = 2.0
"""k of (6.7): a toggle that is sure to come makes 0.12 of a neutral 0.5."""


def _without(dimensions: int) -> Coder:
    raise BadRequest(f"nothing codes {dimensions} dimensions", "timescale_by")


class Way(Protocol):
    """How far ahead to look, tick by tick. No clock, no input or output: the same again in every replay."""

    def see(self, situation: Situation) -> None:
        """A tick begins."""
        ...

    def outlook(self, outlook: Outlook, timescale: float) -> Outlook:
        """What the assist sees, to which `timescale` stands for what was chosen."""
        ...

    def rewarded(self, reward: float) -> None:
        """Somebody was pleased (above 0) or not (below 0)."""
        ...

    def toggled(self) -> None:
        """The operator has selected another joint; what that costs is told to `rewarded`."""
        ...

    def cut(self) -> None:
        """The assist was off: what comes next has nothing to do with what came before."""
        ...

    def words(self) -> str:
        """How far is looked ahead, in a few words."""
        ...

    def told(self) -> Mapping[str, Value]:
        """What has been found out."""
        ...

    def memory(self) -> dict[str, NDArray[np.float64]]:
        """Copies of what was learned."""
        ...

    def recall(self, memory: Memory) -> None:
        """Go on with it. Raises ValueError: it does not fit, and nothing has changed."""
        ...


class Choice:
    """Of one group. What a way learned stays while another is in use."""

    def __init__(
        self,
        group: str,
        specs: Sequence[JointSpec],
        joints: Sequence[int],
        rate_hz: float,
        timescales: Sequence[float] = (),
        open_coder: OpenCoder = _without,
        representation: str = ARM,
    ) -> None:
        """It is fixed until `adjust` says otherwise.

        `joints`: of the group; `timescales`: those at which joints are predicted (ticks); `representation`:
        what questions of its own are to be learned from.
        """
        self._group = group
        self._specs = tuple(specs)
        self._joints = tuple(joints)
        self._timescales = tuple(sorted(timescales))
        self._rate_hz = rate_hz
        self._open_coder = open_coder
        self._representation = representation
        self._settings = AssistSettings()
        self._ways: dict[str, Way] = {}
        self._remembered: dict[str, Memory] = {}
        self._off = True

    @property
    def fixed(self) -> bool:
        """Whether nothing is chosen."""
        return self._settings.timescale_by == FIXED

    def adjust(self, settings: AssistSettings) -> None:
        """Go on with other settings, which were checked."""
        if settings.timescale_by not in (FIXED, *self._ways):
            self._ways[settings.timescale_by] = self._opened(settings)
        if settings.timescale_by != self._settings.timescale_by:
            self.off()
        self._settings = settings

    def check(self, settings: AssistSettings) -> None:
        """Raises BadRequest: with these there is nothing to choose from."""
        if settings.timescale_by != FIXED and len(self._timescales) < 2:
            known = ", ".join(f"{t:g}" for t in self._timescales) or "none"
            raise BadRequest(
                f"timescale_by = '{settings.timescale_by}' needs at least 2 timescales that are predicted, "
                f"not {len(self._timescales)} (learn.timescales: {known})",
                "timescale_by",
            )

    def look(self, situation: Situation) -> Situation:
        """The same as the assist is to see it; once a tick while the assist is on."""
        if self.fixed:
            return situation
        self._off = False
        way = self._ways[self._settings.timescale_by]
        way.see(situation)
        return replace(situation, outlook=way.outlook(situation.outlook, self._settings.timescale))

    def off(self) -> None:
        """The assist is off in this tick."""
        if not self._off:
            self._off = True
            for way in self._ways.values():
                way.cut()

    def toggled(self) -> None:
        """The operator has selected another joint."""
        if not (self.fixed or self._off):
            self._ways[self._settings.timescale_by].toggled()
            self.rewarded(self._settings.toggle_reward)

    def rewarded(self, reward: float) -> None:
        """Somebody was pleased (above 0) or not (below 0); what is not finite says nothing."""
        if not (self.fixed or self._off) and math.isfinite(reward):
            reward = min(max(reward, -MOST_REWARD), MOST_REWARD)
            self._ways[self._settings.timescale_by].rewarded(reward)

    def words(self) -> str:
        """A sentence about how far is looked ahead; empty if that is fixed."""
        if self.fixed:
            return ""
        far = self._ways[self._settings.timescale_by].words()
        return f"It looks {far} ({self._settings.timescale:g} are set)."

    def told(self) -> Mapping[str, Value]:
        """What has been found out about timescales; empty if nothing is chosen."""
        return {} if self.fixed else self._ways[self._settings.timescale_by].told()

    def memory(self) -> dict[str, NDArray[np.float64]]:
        """Copies of what all ways have learned, names below theirs."""
        known = {name: way.memory() for name, way in self._ways.items()}
        return {f"{way}/{name}": array for way, part in known.items() for name, array in part.items()}

    def recall(self, memory: Memory) -> None:
        """Go on with it; a way that is chosen later will, too. What does not fit is logged and left out."""
        for name in (SARSA, BLEND):
            prefix = f"{name}/"
            part = {k.removeprefix(prefix): a for k, a in memory.items() if k.startswith(prefix)}
            if part:
                self._remembered[name] = part
            if name in self._ways:
                self._remind(name, self._ways[name])

    def asks(self) -> tuple[Mapping[str, Value], ...]:
        """Tables of the questions that must be answered, besides the joints' positions at the timescales.

        γ = γ_0 + (γ_1 − γ_0) σ(worth), thesis (6.7): between those of the shortest and the longest timescale,
        where worth is the reward to be expected, of this group, in the next seconds.
        """
        if self._settings.timescale_by != STATE:
            return ()
        low, high = (1 - 1 / t for t in (self._timescales[0], self._timescales[-1]))
        name = f"{self._group}.worth"
        worth: dict[str, Value] = {
            "name": name,
            "cumulant": f"{self._group}.reward",
            "timescale_s": WORTH,
            "scaling": "cumulative",
            "representation": self._representation,
        }
        gamma = f'{low!r} + {high - low!r} * logistic(prediction("{name}"), {STEEPNESS!r}, 0)'
        return (worth, *(self._varying(self._specs[joint], gamma) for joint in self._joints))

    def _varying(self, spec: JointSpec, gamma: str) -> dict[str, Value]:
        return {
            "name": varying(spec.name),
            "cumulant": f"{spec.name}.position",
            "gamma": gamma,
            "representation": self._representation,
            "initial": spec.clamp(spec.home),
        }

    def _opened(self, settings: AssistSettings) -> Way:
        if settings.timescale_by == STATE:
            names = [varying(spec.name) for spec in self._specs]
            return StateWay(names, self._timescales, self._rate_hz)
        postures = Postures(self._specs, self._joints, self._open_coder(len(self._joints)))
        way = self._learned(postures, settings)
        self._remind(settings.timescale_by, way)
        return way

    def _remind(self, name: str, way: Way) -> None:
        part = self._remembered.pop(name, None)
        try:
            if part:
                way.recall(part)
        except ValueError as error:
            _log.warning("How %s finds timescales for %s is learned anew: %s", name, self._group, error)

    def _learned(self, postures: Postures, settings: AssistSettings) -> LearnedWay:
        first = min(self._timescales, key=lambda t: abs(t - settings.timescale))
        if settings.timescale_by == SARSA:
            place = self._timescales.index(first)
            picker = OneOf(postures.size, postures.active, len(self._timescales), place, SEED)
            return LearnedWay(postures, picker, self._timescales, first, self._rate_hz)
        gammas = [1 - 1 / t for t in self._timescales]
        blend = Gaussian(postures.size, postures.active, gammas, 1 - 1 / first, SEED)
        return LearnedWay(postures, blend, self._timescales, first, self._rate_hz)


def varying(joint: str) -> str:
    """The name of the question where `joint` will be, whose γ depends on the state."""
    return f"{joint}.position@state"
