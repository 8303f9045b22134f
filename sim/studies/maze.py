"""Experiment 2 of the thesis (5.5, appendix B): an angled corridor between two barriers, and a rod in it.

From the text: the joint with the shorter way goes 0.28 rad there and back; a barrier is felt on 2 cm in its
middle; each rest lasts 5 s; walls are not to be touched but touching costs nothing; the author needs ten
toggles a circuit at least; going straight up from the green barrier ends in the top of the maze; it bends
near the yellow barrier. The rest the thesis shows without numbers and is ours: the corridor goes up, then up
and left, then left, and its width is what makes ten toggles the usual least of a practised person.
"""

from dataclasses import dataclass, field, replace
from itertools import pairwise
from math import hypot

from bentod.tasks.corridor import measured
from sim.people.scene import Point, Way, moved

CENTRE: tuple[Point, ...] = ((0.0, 0.0), (0.0, 0.06), (-0.22, 0.36), (-0.28, 0.36))
"""Shoulder (right is positive) and elbow (up is positive), rad, from the green barrier to the yellow one."""

HALF_WIDTH = 0.058
"""rad from the centre line to the rod's first touch of a wall."""

EXPOSED = 0.025
"""rad to either side of a barrier's middle: 2 cm at the 0.4 m from the shoulder to the rod."""

FELT = 0.003
"""rad before a barrier at which the rod touches it; its play, assumed."""

REST = 5.0
"""s"""

PLAY = 0.025
"""rad beyond a wall's surface that the rod and its mounting give way, so that it slides (5.5); assumed."""

BOUNCE = 0.3
"""s without a touch, after which the next one is another contact; assumed."""

LIMITS = ((-0.38, 0.10), (-0.10, 0.46))
"""rad, by joint: the workspace by a small margin."""

WALL = 4.0
"""rad of progress that a person gives up to be 1 rad farther inside the margin; assumed."""

NEAR = 0.05
"""rad from a barrier, from where on one aims at its middle; assumed."""

PRESSED = 0.015
"""rad beyond a barrier's surface to which one means to push, so as to feel it; assumed."""

STEP, FARTHEST = 0.008, 60
"""rad between two spots that are looked at along a way, and how many there are at most."""


@dataclass(slots=True)
class Maze:
    """The maze as it is and as it is seen. `mirrored`: its other diagonal, for a change in mid-session.

    `both`: the arm's limits leave room for either, so that the change is one.
    """

    mirrored: bool = False
    both: bool = False
    name: str = "maze"
    leg: int = 0
    resting: bool = True
    touching: bool = False
    pressing: bool = False
    contacts: int = 0
    circuits: int = 0
    _until: float = field(default=-1.0)
    _touched: float = field(default=-1e9)

    @property
    def start(self) -> Point:
        """Where the arm is at the beginning: at the green barrier."""
        return CENTRE[0]

    @property
    def limits(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """rad, by joint."""
        (low, high), elbow = LIMITS
        if self.both:
            return (low, -low), elbow
        return ((-high, -low), elbow) if self.mirrored else LIMITS

    def step(self, time: float, position: Point) -> bool:
        """Take in where the rod is at `time` (s); whether a circuit ends with that."""
        if self._until < 0:
            self._until = time + REST
        self._feel(time, position)
        if self.resting:
            self.resting = time < self._until
            return False
        if not self._at_barrier(position):
            return False
        self.resting, self._until = True, time + REST
        self.leg = 1 - self.leg
        self.circuits += self.leg == 0
        return self.leg == 0

    def resume(self) -> None:
        """See `Task`."""
        self.resting, self._until = True, -1.0

    def clearance(self, position: Point) -> float:
        """How far it is to the nearest wall (rad); negative behind it."""
        _, off, _ = self._along(position)
        return HALF_WIDTH - off

    def value(self, position: Point, margin: float) -> float:
        """See `Course`: progress along the corridor, less what it costs to be near a wall."""
        along, off, total = self._along(position)
        way = total - along if self.leg else along
        left = max(total - way, 0.0)
        way = min(way, total + PRESSED)
        aimed = max(0.0, 1 - left / NEAR)
        return way - aimed * off - WALL * max(0.0, off - HALF_WIDTH + margin)

    def way(self, position: Point, joint: int, drift: float, margin: float) -> Way:
        """See `Course`: as far as the value rises, and not through a wall to where it rises again."""
        here = self.value(position, margin)
        best = Way(0.0, 0.0)
        for sign in (1.0, -1.0):
            found = self._best(position, joint, sign, drift, margin, here)
            best = max(best, found, key=lambda way: way.gain)
        return replace(best, back=self._leads_back(position, joint, best.distance, drift))

    def ahead(self, position: Point, by: float) -> Point:
        """The spot of the centre line that is `by` (rad) further on the leg than `position` is."""
        along, _, total = self._along(position)
        wanted = along - by if self.leg else along + by
        wanted = min(max(wanted, -PRESSED), total + PRESSED)
        x, y = _spot(wanted)
        return (-x, y) if self.mirrored else (x, y)

    def place(self, position: Point) -> int:
        """See `Course`: the leg, and each 0.07 rad of it."""
        along, _, _ = self._along(position)
        return 10 * self.leg + int(max(along, 0.0) / 0.07)

    def _best(
        self, position: Point, joint: int, sign: float, drift: float, margin: float, here: float
    ) -> Way:
        best, top = Way(0.0, 0.0), 0.0
        for i in range(1, FARTHEST):
            by = sign * i * STEP
            gain = self.value(moved(position, joint, by, drift * abs(by)), margin) - here
            if gain > top:
                best, top = Way(by, gain), gain
            elif gain < top - STEP:
                break
        return best

    def _leads_back(self, position: Point, joint: int, by: float, drift: float) -> bool:
        now, _, _ = self._along(position)
        then, _, _ = self._along(moved(position, joint, by, drift * abs(by)))
        return (then - now) * (-1 if self.leg else 1) < 0

    def _at_barrier(self, position: Point) -> bool:
        x, y = self._mirror(position)
        (gx, gy), (yx, yy) = CENTRE[0], CENTRE[-1]
        if self.leg:
            return y <= gy + FELT and abs(x - gx) <= EXPOSED
        return x <= yx + FELT and abs(y - yy) <= EXPOSED

    def _feel(self, time: float, position: Point) -> None:
        clearance = self.clearance(position)
        self.touching, self.pressing = clearance <= 0.0, clearance <= -PLAY
        if self.touching:
            self.contacts += time - self._touched > BOUNCE
            self._touched = time

    def _mirror(self, position: Point) -> Point:
        return (-position[0], position[1]) if self.mirrored else position

    def _along(self, position: Point) -> tuple[float, float, float]:
        """How far `position` is along the centre line (which goes on at its ends) and off it; its length."""
        return measured(CENTRE, self._mirror(position))


def _spot(along: float) -> Point:
    """Where the centre line is, `along` (rad) from its beginning; it goes on at its ends."""
    for i, ((ax, ay), (bx, by)) in enumerate(pairwise(CENTRE)):
        length = hypot(bx - ax, by - ay)
        if along <= length or i == len(CENTRE) - 2:
            break
        along -= length
    return ax + along / length * (bx - ax), ay + along / length * (by - ay)
