"""The features of thesis 5.3, position by position."""

from collections.abc import Sequence

import numpy as np

from bentod.config_learn import Learn
from bentod.contracts import Features
from bentod.frames import JointSpec
from bentod.learn.expression import Expression, Vocabulary
from bentod.learn.program import Program
from bentod.learn.representation import arm_coding
from bentod.learn.signals import Signals


class ArmFeatures:
    """Of joints with these limits (rad), one tick after another. `learn`: keys of the table [learn]."""

    def __init__(self, limits: Sequence[tuple[float, float]], **learn: object) -> None:
        specs = [JointSpec(f"j{i}", low, high, 1.0, low, {}) for i, (low, high) in enumerate(limits)]
        table = Learn.model_validate({"joints": tuple(spec.name for spec in specs)} | learn)
        signals = Signals(specs)
        self.coding = arm_coding(table, specs)
        self.size, self.active = self.coding.size, self.coding.active
        self._program = Program([Expression.parse(it, Vocabulary(signals)) for it in self.coding.inputs])
        self._signals = np.full(len(signals.names), np.nan)
        self._places = [signals.names.index(f"{spec.name}.position") for spec in specs]

    def features(self, positions: Sequence[float]) -> Features:
        """Those that are active at `positions` (rad)."""
        self._signals[self._places] = positions
        return self.coding.encode(self._program.evaluate(self._signals))

    def restart(self) -> None:
        """Forget the history."""
        self._program.restart()
