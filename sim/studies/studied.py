"""The daemon's mind in a study: with assists that only the study knows, or learners that learn no more."""

from collections.abc import Mapping, Sequence

from bentod import registry
from bentod.config import Config
from bentod.config_learn import ARM
from bentod.contracts_assist import OpenAssist
from bentod.control.groups import Groups
from bentod.frames import JointSpec
from bentod.learn.confidence.visits import Visit
from bentod.learn.horde import HasTime, unhurried
from bentod.learn.signals import Percept
from bentod.mind import Mind


class StudiedMind(Mind):
    """Everything else is as in the daemon."""

    def __init__(
        self,
        config: Config,
        specs: Sequence[JointSpec],
        groups: Groups,
        assists: Mapping[str, OpenAssist],
        learns: bool = True,
    ) -> None:
        """`assists`: factories by mode, besides those of the registry. `learns`: False: only predicts."""
        self._learns = learns
        sites = [site.name for site in config.emg.sites] if config.emg else []
        tables = [table for _, table in config.helped()]

        def find(mode: str) -> OpenAssist:
            return assists.get(mode) or registry.open_assist(mode)

        super().__init__(specs, config.rate_hz, groups, config.learn, tables, sites, find)

    def predict(self, percept: Percept, has_time: HasTime = unhurried) -> None:
        """As in `Mind`."""
        super().predict(percept, has_time if self._learns else _never)

    def learn(self, has_time: HasTime = unhurried) -> None:
        """As in `Mind`."""
        super().learn(has_time if self._learns else _never)

    def visit(self) -> Visit | None:
        """How often the state of this tick was visited before."""
        return self.learners.horde.encoders[ARM].visit


def _never() -> bool:
    return False
