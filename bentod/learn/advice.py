"""What advisers say, beside what the arm perceives: one vector, of which expressions name both parts."""

from collections.abc import Sequence

import numpy as np

from bentod.contracts import Vector
from bentod.errors import ConfigError, nearest
from bentod.learn.adviser import Adviser
from bentod.learn.expression_advice import advice
from bentod.learn.signals import Named, Percept, Range, Signals


class Advised:
    """The signals of an arm, and behind them in the same vector what its advisers answer.

    Advice has no name among the signals, so that a pattern with stars never stands for it.
    """

    def __init__(self, signals: Signals, advisers: Sequence[Adviser] = ()) -> None:
        self._signals = signals
        self._advisers = {adviser.name: adviser for adviser in advisers}
        self._first: dict[str, int] = {}
        place = len(signals.names)
        for name, adviser in self._advisers.items():
            self._first[name] = place
            place += len(adviser.names)

    @property
    def names(self) -> tuple[str, ...]:
        """Of the signals, in the order of their values."""
        return self._signals.names

    @property
    def digests(self) -> dict[str, str]:
        """Of the advisers' snapshots, by name."""
        return {name: adviser.digest for name, adviser in self._advisers.items()}

    def range(self, name: str) -> Range:
        """The range of one of the signals."""
        return self._signals.range(name)

    def advice(self, adviser: str, question: str) -> tuple[int, str]:
        """As in `Advising`."""
        if adviser not in self._advisers:
            hint = nearest(adviser, self._advisers) if self._advisers else ": learn.advisers names none"
            raise ConfigError(f"there is no adviser '{adviser}'{hint}")
        chosen = self._advisers[adviser]
        return self._first[adviser] + chosen.want(question), chosen.digest

    def read(self, percept: Percept, elapsed: int) -> Vector:
        """Signals and advice of this tick, `elapsed` ticks after the last."""
        signals = self._signals.read(percept)
        if not self._advisers:
            return signals
        said = [adviser.answer(percept.tick, signals, elapsed) for adviser in self._advisers.values()]
        return np.concatenate([signals, *said])

    def restart(self) -> None:
        """The next tick is the first."""
        self._signals.restart()
        for adviser in self._advisers.values():
            adviser.restart()


def guess(signals: Named, adviser: str | None, question: str) -> str:
    """The expression of what an adviser answers to a question of the same name; empty without one.

    Raises:
        ConfigError: there is no such adviser, or it cannot answer that.
    """
    return str(advice(signals, (adviser, question))) if adviser else ""
