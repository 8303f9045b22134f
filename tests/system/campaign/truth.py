"""The simulated servos themselves, millisecond by millisecond, whatever the daemon believes of them."""

import math
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager
from unittest import mock

from bentod.contracts import ArmConfig
from sim import bento
from sim.arm import SUBSTEP, Arm
from sim.options import Options
from tests.system.campaign.outcome import Moved

AT_REST = 0.02
"""rad/s, as the daemon sees it (`bentod.tick`)."""


class TrueArm(Arm):
    """An arm whose every substep is kept once it is watched."""

    def __init__(self, arm: Arm) -> None:
        super().__init__(arm.servos, arm.time, arm.catch_up)
        self._path: list[tuple[float, ...]] | None = None
        self._since = 0.0

    def watch(self) -> None:
        """Keep from now on what the shafts do, and forget what was kept."""
        self._since = self.time
        self._path = [self._positions()]

    def unwatch(self) -> None:
        """Keep nothing any more."""
        self._path = None

    def advance(self, to: float) -> None:
        """As `Arm.advance`."""
        if self._path is None:
            super().advance(to)
            return
        while to - self.time > SUBSTEP * (1 - 1e-6):
            super().advance(self.time + SUBSTEP * 1.001)
            self._path.append(self._positions())

    def moved(self, since: float, until: float, joints: Collection[int]) -> Moved:
        """What `joints` did between two moments (monotonic s) since it is watched."""
        self.advance(until)
        path = (self._path or [])[max(int((since - self._since) / SUBSTEP), 0) :]
        path = path[: max(int((until - since) / SUBSTEP), 1)]
        farthest = max((abs(now[j] - path[0][j]) for now in path for j in joints), default=0.0)
        still = AT_REST * SUBSTEP
        moving = (
            at
            for at in range(len(path) - 1, 0, -1)
            if any(abs(path[at][j] - path[at - 1][j]) > still for j in joints)
        )
        return Moved(math.degrees(farthest), next(moving, 0) * SUBSTEP)

    def speed(self, joint: int) -> float:
        """rad/s at this moment."""
        return self.servos[joint].velocity

    def _positions(self) -> tuple[float, ...]:
        return tuple(servo.position for servo in self.servos)


@contextmanager
def true_arms(module: str) -> Iterator[list[TrueArm]]:
    """While entered, the arms that `module` builds are true arms; the list fills with them."""
    built: list[TrueArm] = []
    build: Callable[[ArmConfig, Options, float], Arm] = bento.build_arm

    def keep(config: ArmConfig, options: Options, time: float) -> TrueArm:
        built.append(TrueArm(build(config, options, time)))
        return built[-1]

    with mock.patch(f"{module}.build_arm", keep):
        yield built
