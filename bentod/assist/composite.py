"""Several assists as one: "dpcc+adaptive_switching" helps as the one, orders as the other."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from bentod.contracts_assist import Asking, Assist, Assistance, AssistSettings, OpenAssist, Situation
from bentod.errors import BadRequest, ConfigError
from bentod.frames import JointSpec, Value, Wishes


class Composite:
    """Parts by their modes, the strongest first: of two wishes for a joint that of the first one holds.

    All parts have the common settings; an option begins with the mode that it is for: `trajectory-after`.
    While all joints are selected at once, only parts that offer that are heard.
    """

    def __init__(
        self,
        parts: Mapping[str, OpenAssist],
        specs: Sequence[JointSpec],
        rate_hz: float,
        settings: AssistSettings,
    ) -> None:
        """Raises BadRequest: as the parts do, or an option is for none of them."""
        self._settings = _shared_out(tuple(parts), settings)
        self._parts: dict[str, Assist] = {
            mode: open_part(specs, rate_hz, self._settings[mode]) for mode, open_part in parts.items()
        }

    def adjust(self, settings: AssistSettings) -> None:
        """As in `Assist`."""
        new = _shared_out(tuple(self._parts), settings)
        done: list[str] = []
        try:
            for mode, part in self._parts.items():
                part.adjust(new[mode])
                done.append(mode)
        except BadRequest:
            for mode in done:
                self._parts[mode].adjust(self._settings[mode])
            raise
        self._settings = new

    def wish(self, situation: Situation) -> Assistance:
        """As in `Assist`; the reason is that of the parts that are engaged or order, else of all."""
        answers = [(part, part.wish(situation)) for part in self._parts.values()]
        wishes: Wishes = {}
        for part, answer in answers:
            if part.offers_together() or not situation.together:
                wishes = {**answer.wishes, **wishes}
        engaged = any(answer.engaged for _, answer in answers)
        told = [
            answer.reason
            for part, answer in answers
            if answer.engaged or not engaged or part.order(situation) is not None
        ]
        return Assistance(wishes, engaged, _one_sentence(told))

    def toggled(self, now: float) -> None:
        """As in `Assist`."""
        for part in self._parts.values():
            part.toggled(now)

    def rewarded(self, reward: float) -> None:
        """As in `Assist`."""
        for part in self._parts.values():
            part.rewarded(reward)

    def order(self, situation: Situation) -> tuple[int, ...] | None:
        """That of the first part that has one."""
        orders = (part.order(situation) for part in self._parts.values())
        return next((order for order in orders if order is not None), None)

    def needs_all(self) -> bool:
        """Whether any part does."""
        return any(part.needs_all() for part in self._parts.values())

    def offers_together(self) -> bool:
        """Whether any part does."""
        return any(part.offers_together() for part in self._parts.values())

    def told(self) -> Mapping[str, Value]:
        """What each part has found out, by mode."""
        return {mode: dict(part.told()) for mode, part in self._parts.items()}

    def memory(self) -> dict[str, NDArray[np.float64]]:
        """That of each part, by mode."""
        known = {mode: part.memory() for mode, part in self._parts.items()}
        return {f"{mode}/{name}": array for mode, part in known.items() for name, array in part.items()}

    def recall(self, memory: Mapping[str, NDArray[np.float64]]) -> None:
        """As in `Assist`; a part that does not take its own leaves those before it with theirs."""
        for mode, part in self._parts.items():
            own = {n.removeprefix(f"{mode}/"): a for n, a in memory.items() if n.startswith(f"{mode}/")}
            part.recall(own)

    def asks(self, group: str, joints: Sequence[str]) -> tuple[Mapping[str, Value], ...]:
        """As in `Asking`: what any part asks."""
        asking = [part for part in self._parts.values() if isinstance(part, Asking)]
        tables = [table for part in asking for table in part.asks(group, joints)]
        return tuple({str(table["name"]): table for table in reversed(tables)}.values())[::-1]


def combining(open_part: Callable[[str], OpenAssist]) -> Callable[[str], OpenAssist]:
    """How modes are opened of which some are several, joined with "+". `open_part`: one of them."""

    def opened(mode: str) -> OpenAssist:
        names = mode.split("+")
        if len(names) == 1:
            return open_part(mode)
        if twice := [name for name in names if names.count(name) > 1]:
            raise ConfigError(f"'{mode}' has {twice[0]} twice")
        return partial(Composite, {name: open_part(name) for name in names})

    return opened


def _shared_out(modes: Sequence[str], settings: AssistSettings) -> dict[str, AssistSettings]:
    """The settings of each part. Raises BadRequest: an option is for none of them."""
    options: dict[str, dict[str, float]] = {mode: {} for mode in modes}
    for name, value in settings.options.items():
        owners = [mode for mode in modes if name.startswith(f"{mode}-")]
        if not owners:
            raise BadRequest(
                f"{'+'.join(modes)} has no option '{name}': begin it with what it is for, e.g. {modes[0]}-…",
                name,
            )
        owner = max(owners, key=len)
        options[owner][name.removeprefix(f"{owner}-")] = value
    return {mode: replace(settings, options=options[mode]) for mode in modes}


def _one_sentence(reasons: Sequence[str]) -> str:
    first, *rest = [reason.rstrip(".") for reason in reasons if reason] or [""]
    return "; ".join([first, *(reason[:1].lower() + reason[1:] for reason in rest)]) + "."
