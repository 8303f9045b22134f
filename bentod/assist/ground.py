"""Ground: where a group has been without help, and so where help may take it."""

import math
from collections.abc import Mapping, Sequence
from itertools import chain, combinations

import numpy as np
from numpy.typing import NDArray

from bentod.contracts_assist import Situation
from bentod.frames import JointSpec

CELL = 0.01
"""rad of each of two joints that are one cell: with those around it, the thesis' 1° to either side."""

NEAR = tuple((x, y) for x in (-1, 0, 1) for y in (-1, 0, 1))
"""The cells that one visit makes known: its own, and those around it."""

MOST = 200_000
"""Cells that are remembered of two joints: more than all of a Bento Arm's elbow and shoulder have."""

SHARES = (1.0, 0.6, 0.3)
"""Of a wished velocity that are tried, until one of them stays on known ground."""

Cell = tuple[int, int]


class Ground:
    """Remembers each two joints of a group together: one by itself says little, all at once too much.

    What help did is not remembered. Otherwise help that once went astray would take that for the way.
    """

    def __init__(self, specs: Sequence[JointSpec]) -> None:
        self._names = tuple(spec.name for spec in specs)
        self._known: dict[tuple[int, int], set[Cell]] = {}
        self._last: dict[tuple[int, int], Cell] = {}

    def note(self, situation: Situation) -> None:
        """The group is where it is without help."""
        for pair in combinations(sorted(situation.joints), 2):
            cell = _cell(*(situation.state.joints[joint].position for joint in pair))
            if cell is None or self._last.get(pair) == cell:
                continue
            self._last[pair] = cell
            known = self._known.setdefault(pair, set())
            if len(known) < MOST:
                known.update((cell[0] + x, cell[1] + y) for x, y in NEAR)

    def within(self, situation: Situation, joint: int, velocity: float, ahead: float) -> float:
        """`velocity` (rad/s), or the share of it that keeps `joint` on known ground `ahead` s from now.

        It is enough that the ground is known where the attended joint goes on, or where it stays: a wearer
        who lets go is as likely as one who does not.
        """
        for share in SHARES if velocity else ():
            moments = (0.5 * ahead, ahead)
            if all(self._knows(situation, joint, share * velocity, s) for s in moments):
                return share * velocity
        return 0.0

    def memory(self) -> dict[str, NDArray[np.float64]]:
        """Known cells by the names of two joints, shape (cells, 2), whole numbers."""
        named = {f"{self._names[i]}/{self._names[j]}": cells for (i, j), cells in self._known.items()}
        return {name: _flat(cells) for name, cells in named.items()}

    def recall(self, memory: Mapping[str, NDArray[np.float64]]) -> None:
        """Go on with what `memory` told of joints that are still there. Raises ValueError: it is none."""
        found: dict[tuple[int, int], set[Cell]] = {}
        for name, cells in memory.items():
            if cells.ndim != 2 or cells.shape[1] != 2 or not np.isfinite(cells).all():
                raise ValueError(f"what is known of {name} is not a list of cells")
            first, _, second = name.partition("/")
            if {first, second} <= set(self._names):
                pair = self._names.index(first), self._names.index(second)
                found[pair] = {(int(x), int(y)) for x, y in cells[:MOST]}
        self._known, self._last = found, {}

    def _knows(self, situation: Situation, joint: int, velocity: float, ahead: float) -> bool:
        attended = situation.attended
        rate = 0.0 if attended is None else situation.state.joints[attended].velocity
        rates = [{joint: velocity}, {joint: velocity, **({} if attended is None else {attended: rate})}]
        return any(self._holds(situation, joint, moving, ahead) for moving in rates)

    def _holds(self, situation: Situation, joint: int, rates: Mapping[int, float], ahead: float) -> bool:
        """Whether `joint` is on known ground with every other one, after `ahead` s at `rates` (rad/s)."""

        def there(j: int) -> float:
            return situation.state.joints[j].position + rates.get(j, 0.0) * ahead

        pairs = [(min(joint, other), max(joint, other)) for other in situation.joints if other != joint]
        return all(_cell(there(i), there(j)) in self._known.get((i, j), ()) for i, j in pairs)


def _flat(cells: set[Cell]) -> NDArray[np.float64]:
    """Shape (cells, 2), in no order: to sort them would take a tick's time."""
    return np.fromiter(chain.from_iterable(cells), np.float64, 2 * len(cells)).reshape(-1, 2)


def _cell(first: float, second: float) -> Cell | None:
    if not (math.isfinite(first) and math.isfinite(second)):
        return None
    return math.floor(first / CELL), math.floor(second / CELL)
