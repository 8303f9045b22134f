"""Who is told when somebody was pleased with the arm, or not: what helps, and those who predict it."""

import math
from collections.abc import Collection, Mapping, Sequence

from bentod.assist.help import Help
from bentod.contracts_assist import MOST_REWARD
from bentod.errors import BadRequest, nearest

CONTACT = "contact"
"""The mark of a trial that says that the arm has touched what it should not."""


class Rewards:
    """Of all groups; `take` gives what has come since the last tick."""

    def __init__(self, helps: Sequence[Help], groups: Collection[str]) -> None:
        self._helps = tuple(helps)
        self._groups = tuple(groups)
        self._waiting: dict[str, float] = {}

    def give(self, reward: float, group: str | None = None) -> None:
        """Somebody was pleased (above 0) or not (below 0) with a group, or (None) with all.

        Raises:
            BadRequest: there is no such group, or the reward is out of its bounds.
        """
        if not abs(reward) <= MOST_REWARD:
            raise BadRequest(f"a reward must be within ±{MOST_REWARD:g}, not {reward:g}", "value")
        if group is not None and group not in self._groups:
            raise BadRequest(f"there is no group '{group}'{nearest(group, self._groups)}", "group")
        for name in self._groups if group is None else (group,):
            self._add(name, reward)
            for help_ in self._helps:
                if help_.group == name:
                    help_.rewarded(reward)

    def toggled(self, group: str, now: float) -> None:
        """The active joint of a group has changed (monotonic s). Where nothing helps, that says nothing."""
        for help_ in self._helps:
            if help_.group == group:
                help_.toggled(now)
                self._add(group, help_.settings.toggle_reward if help_.assist else 0.0)

    def marked(self, mark: str) -> None:
        """A trial was marked: a contact is the fault of all that helps."""
        for help_ in self._helps:
            if mark == CONTACT and help_.assist:
                self._add(help_.group, help_.settings.contact_reward)
                help_.rewarded(help_.settings.contact_reward)

    def take(self) -> Mapping[str, float]:
        """By group, all that has come since the last call."""
        waiting, self._waiting = self._waiting, {}
        return waiting

    def _add(self, group: str, reward: float) -> None:
        total = self._waiting.get(group, 0.0) + reward
        self._waiting[group] = total if math.isfinite(total) else 0.0
