"""How a client teaches an arm: leads it along a trajectory, or counts the circuits that a hand leads it."""

import asyncio
from collections.abc import Callable, Mapping, Sequence

from bentod.cli import show
from bentod.cli.trajectory import Reach, Trajectory
from bentod.client import Client
from bentod.errors import ConfigError, Refused, nearest
from bentod.frames import Value

Told = Callable[[str], None]

STEP = 0.1
"""s between two wishes."""

LEASE = 0.3
"""s, for which each wish holds: three steps, and then the joint stops."""

APPROACH = 0.2
"""rad/s on the way to the first way point."""

SLOWEST = 0.02
"""rad/s; a wish for no speed at all would be one to stop."""

ARRIVED = 0.03
"""rad from a way point."""

PATIENCE = 30.0
"""s in which the first way point must be reached."""


async def reaches(arm: Client) -> dict[str, Reach]:
    """What each joint of the arm may do, by name."""
    joints = show.entries(show.fields(await arm.call("get_info")).get("joints"))
    told = [show.fields(joint) for joint in joints]
    keys = ("min_rad", "max_rad", "max_velocity_rad_s")
    return {str(joint["name"]): Reach(*(_number(joint[key]) for key in keys)) for joint in told}


async def lead(arm: Client, trajectory: Trajectory, times: int, told: Told) -> None:
    """Lead the arm along `trajectory`, `times` times. Cancelled, it stops the arm before it ends.

    Raises:
        ConfigError: a way point is beyond what the arm may do; nothing has moved.
        RpcError, Refused: the arm is paused, somebody else moves it, or it does not get there. Wishes end
            with this client.
    """
    allowed = await reaches(arm)
    trajectory.check(allowed)
    await arm.call("hello", name="teacher")
    try:
        for lap in range(times):
            await _approach(arm, trajectory, allowed)
            await _follow(arm, trajectory, allowed)
            told(f"{lap + 1} of {times}")
    except asyncio.CancelledError:
        await arm.call("stop")
        raise


async def _approach(arm: Client, trajectory: Trajectory, allowed: Mapping[str, Reach]) -> None:
    loop = asyncio.get_running_loop()
    goal, patience = trajectory.at(0.0), loop.time() + PATIENCE
    while far := await _missing(arm, goal):
        if loop.time() > patience:
            raise Refused(f"{far[0]} does not get to the first way point within {PATIENCE:g} s")
        speeds = {joint: min(APPROACH, allowed[joint].velocity) for joint in goal}
        await _wish(arm, goal, speeds)
        await asyncio.sleep(STEP)


async def _follow(arm: Client, trajectory: Trajectory, allowed: Mapping[str, Reach]) -> None:
    loop = asyncio.get_running_loop()
    began = loop.time()
    while (passed := loop.time() - began) < trajectory.duration:
        here, goal = await positions(arm), trajectory.at(passed + STEP)
        speeds = {
            joint: min(max(abs(position - here[joint]) / STEP, SLOWEST), allowed[joint].velocity)
            for joint, position in goal.items()
        }
        await _wish(arm, goal, speeds)
        await asyncio.sleep(max(passed + STEP - (loop.time() - began), 0.0))


async def _wish(arm: Client, goal: Mapping[str, float], speeds: Mapping[str, float]) -> None:
    wishes = (
        arm.call("move", joint=joint, position=position, velocity=speeds[joint], lease_s=LEASE)
        for joint, position in goal.items()
    )
    await asyncio.gather(*wishes)


async def _missing(arm: Client, goal: Mapping[str, float]) -> list[str]:
    here = await positions(arm)
    return [joint for joint, position in goal.items() if not abs(here[joint] - position) <= ARRIVED]


async def positions(arm: Client) -> dict[str, float]:
    """Where each joint was in the last tick (rad), by name."""
    return _positions(await arm.call("get_state"))


class Circuits:
    """Counts how often an arm that is led about comes back to where it was at first.

    Away is `away` rad from there in some joint at least, and back is within `near` rad in all of them.
    """

    def __init__(self, near: float = 0.1, away: float = 0.25) -> None:
        self.done = 0
        self._near, self._away = near, away
        self._start: Mapping[str, float] | None = None
        self._left = False

    def step(self, now: Mapping[str, float]) -> bool:
        """Take in where the joints are (rad); whether a circuit ends here."""
        if self._start is None:
            self._start = dict(now)
        farthest = max(abs(now[joint] - position) for joint, position in self._start.items())
        self._left = self._left or farthest > self._away
        if not (self._left and farthest < self._near):
            return False
        self._left = False
        self.done += 1
        return True


async def chosen(arm: Client, joints: Sequence[str]) -> list[str]:
    """`joints`, or all. Raises ConfigError: the arm has no such joint."""
    known = await reaches(arm)
    for joint in joints:
        if joint not in known:
            raise ConfigError(f"there is no joint '{joint}'{nearest(joint, known)}")
    return list(joints) or list(known)


async def limp(arm: Client, joints: Sequence[str]) -> None:
    """Let the joints go limp. Raises RpcError: a servo does not confirm it."""
    await arm.call("torque", joints=list(joints), on=False)


async def count(arm: Client, joints: Sequence[str], circuits: int | None, told: Told) -> int:
    """Tell each circuit of the joints, until there were `circuits` of them; None: for ever."""
    counted = Circuits()
    async for frame in arm.subscribe_state(rate_hz=10):
        now = _positions(frame)
        if counted.step({joint: now[joint] for joint in joints}):
            told(f"Circuit {counted.done}")
        if counted.done == circuits:
            break
    return counted.done


async def hold(arm: Client, joints: Sequence[str]) -> None:
    """Give the joints torque again, where they are; they stay paused. Raises RpcError: they may not."""
    await arm.call("torque", joints=list(joints), on=True)


def _positions(frame: Value) -> dict[str, float]:
    joints = map(show.fields, show.entries(show.fields(frame).get("joints")))
    return {str(joint["name"]): _number(joint["position"]) for joint in joints}


def _number(value: Value) -> float:
    return float(value) if isinstance(value, int | float) else float("nan")
