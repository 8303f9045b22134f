"""What timescales are chosen from: where the joints of a group are, and which of them is selected."""

import math
from collections.abc import Callable, Sequence
from typing import Protocol, TypeAlias

import numpy as np

from bentod.contracts import Features
from bentod.contracts_assist import Situation
from bentod.frames import Freshness, JointSpec


class Coder(Protocol):
    """Tile coding of a point in the unit cube."""

    @property
    def tilings(self) -> int:
        """Features that are active at once, at most."""
        ...

    @property
    def size(self) -> int:
        """Features."""
        ...

    def encode(self, inputs: Sequence[float]) -> Features:
        """Indices of the active ones."""
        ...


OpenCoder: TypeAlias = Callable[[int], Coder]
"""Makes a coding of so many dimensions."""


class Postures:
    """A tile coding of the joints' positions over their ranges, apart for each selected joint, and a bias."""

    def __init__(self, specs: Sequence[JointSpec], joints: Sequence[int], coder: Coder) -> None:
        self._specs = tuple(specs)
        self._joints = tuple(joints)
        self._coder = coder
        self.size = len(self._joints) * coder.size + 1
        """Features."""
        self.active = coder.tilings + 1
        """How many of them at once, at most."""

    def sees(self, situation: Situation) -> bool:
        """Whether all joints were read in this tick, and one of them is selected."""
        told = [situation.state.joints[joint] for joint in self._joints]
        known = all(joint.freshness is Freshness.FRESH and math.isfinite(joint.position) for joint in told)
        return known and situation.active in self._joints

    def features(self, situation: Situation) -> Features:
        """Indices of the active features, where it sees."""
        told = [situation.state.joints[joint] for joint in self._joints]
        inputs = [
            (joint.position - spec.minimum) / (spec.maximum - spec.minimum)
            for joint, spec in zip(told, (self._specs[j] for j in self._joints), strict=True)
        ]
        start = self._joints.index(situation.active) * self._coder.size
        return np.append(self._coder.encode(inputs) + start, self.size - 1)
