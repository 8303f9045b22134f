"""Several drivers as one arm, each played by joints that write down what they are told."""

import asyncio
from collections.abc import Sequence

import pytest

from bentod.contracts import FaultInjector
from bentod.ensemble import BreakableEnsemble, Ensemble, Member, gather
from bentod.errors import BadRequest, BusError
from bentod.frames import Command, Freshness, JointState, State, Stop, Velocity
from sim.clock import VirtualClock


class Played:
    """Joints at positions that tell them apart."""

    def __init__(self, name: str, *positions: float, slow: float = 0.0) -> None:
        self.name = name
        self.diary: list[object] = []
        self.broken: Exception | None = None
        self.problem = ""
        self._positions = positions
        self._slow = slow
        self._torque = (False,) * len(positions)

    async def read(self) -> State:
        clock = VirtualClock()
        time = clock.now() + self._slow
        await clock.sleep_until(time)
        joints = (
            JointState(position, 0.0, 0.0, 12.0, 25.0, 0.01, Freshness.FRESH) for position in self._positions
        )
        return State(time, tuple(joints), self.problem)

    async def write(self, commands: Sequence[Command | None]) -> None:
        if self.broken:
            raise self.broken
        self.diary.append(list(commands))

    async def set_torque(self, on: Sequence[bool]) -> None:
        self.diary.append(tuple(on))
        if self.broken:
            raise self.broken
        self._torque = tuple(on)

    def torque(self) -> tuple[bool, ...]:
        return self._torque

    async def clear_errors(self, joints: Sequence[int]) -> tuple[str, ...]:
        return tuple(f"{self.name} {joint} needs a power cycle." for joint in joints)


class Breakable(Played):
    """Those that can be broken on purpose."""

    def faults(self) -> tuple[str, ...]:
        return ("cable", self.name)

    def inject(self, fault: str, joint: int | None, on: bool) -> None:
        self.diary.append((fault, joint, on))


def interleaved(first: Played, second: Played) -> Ensemble:
    """Joints 0 and 2 on the first driver, 1 on the second."""
    found = gather([Member("driver", first, (0, 2)), Member("wrist", second, (1,))])
    assert isinstance(found, Ensemble)
    return found


async def test_a_single_driver_is_the_arm_itself() -> None:
    alone = Played("a", 0.0)
    assert gather([Member("driver", alone, (0,))]) is alone


async def test_joints_are_read_in_the_order_of_the_config() -> None:
    state = await interleaved(Played("a", 0.0, 0.2), Played("b", 0.1)).read()
    assert [joint.position for joint in state.joints] == [0.0, 0.1, 0.2]


async def test_buses_are_read_at_once_and_ages_counted_to_the_end_of_the_slowest(clock: VirtualClock) -> None:
    began = clock.now()
    state = await interleaved(Played("a", 0.0, 0.2, slow=0.004), Played("b", 0.1, slow=0.003)).read()
    assert clock.now() - began == pytest.approx(0.004)
    assert state.time == pytest.approx(began + 0.004)
    assert [joint.age for joint in state.joints] == pytest.approx([0.01, 0.011, 0.01])


async def test_problems_of_several_buses_are_told_together() -> None:
    first, second = Played("a", 0.0, 0.2), Played("b", 0.1)
    second.problem = "The second is gone."
    assert (await interleaved(first, second).read()).problem == "The second is gone."
    first.problem = "The first is gone."
    assert (await interleaved(first, second).read()).problem == "The first is gone. The second is gone."


async def test_each_joint_gets_its_own_command() -> None:
    first, second = Played("a", 0.0, 0.2), Played("b", 0.1)
    await interleaved(first, second).write([Stop(), Velocity(0.1), None])
    assert first.diary == [[Stop(), None]]
    assert second.diary == [[Velocity(0.1)]]


async def test_a_driver_that_breaks_in_writing_keeps_no_other_from_being_told() -> None:
    first, second = Played("a", 0.0, 0.2), Played("b", 0.1)
    first.broken = ZeroDivisionError("a bug")
    with pytest.raises(ExceptionGroup, match="broke in writing"):
        await interleaved(first, second).write([Stop()] * 3)
    assert second.diary == [[Stop()]]


async def test_torque_goes_off_everywhere_before_it_comes_on_anywhere() -> None:
    first, second = Played("a", 0.0, 0.2), Played("b", 0.1)
    arm = interleaved(first, second)
    await arm.set_torque([False, True, False])
    first.diary.clear()
    second.diary.clear()
    order: list[str] = []
    for name, joints in (("a", first), ("b", second)):
        joints.diary = _Noted(name, order)
    await arm.set_torque([True, False, True])
    assert order[0] == "b (False,)"
    assert order[1] == "a (True, True)"
    assert arm.torque() == (True, False, True)


class _Noted(list[object]):
    """A diary that tells when it was written, too."""

    def __init__(self, name: str, order: list[str]) -> None:
        super().__init__()
        self._name, self._order = name, order

    def append(self, entry: object) -> None:
        self._order.append(f"{self._name} {entry}")


async def test_a_driver_that_fails_keeps_no_other_from_being_switched() -> None:
    first, second = Played("a", 0.0, 0.2), Played("b", 0.1)
    first.broken = BusError("The first did not confirm.")
    with pytest.raises(BusError, match=r"^The first did not confirm\.$"):
        await interleaved(first, second).set_torque([True] * 3)
    assert second.torque() == (True,)
    second.broken = BusError("Nor did the second.")
    with pytest.raises(BusError, match=r"^Nor did the second\. The first did not confirm\.$"):
        await interleaved(first, second).set_torque([False] * 3)


async def test_errors_are_cleared_where_the_joints_are() -> None:
    arm = interleaved(Played("a", 0.0, 0.2), Played("b", 0.1))
    assert await arm.clear_errors([1, 2]) == ("a 1 needs a power cycle.", "b 0 needs a power cycle.")


async def test_a_fault_reaches_the_bus_that_its_name_or_its_joint_says() -> None:
    first, second = Breakable("a", 0.0, 0.2), Breakable("b", 0.1)
    arm = interleaved(first, second)
    assert isinstance(arm, FaultInjector)
    arm.inject("cable", None, True)
    arm.inject("wrist.cable", None, True)
    arm.inject("driver.a", 2, False)
    assert first.diary == [("cable", None, True), ("a", 1, False)]
    assert second.diary == [("cable", None, True), ("cable", None, True)]
    assert arm.faults() == ("cable", "a", "b", "driver.cable", "driver.a", "wrist.cable", "wrist.b")


async def test_a_fault_that_a_joints_bus_does_not_have_is_refused() -> None:
    arm = interleaved(Breakable("a", 0.0, 0.2), Breakable("b", 0.1))
    assert isinstance(arm, BreakableEnsemble)
    with pytest.raises(BadRequest, match="has no fault 'a'"):
        arm.inject("a", 1, True)
    with pytest.raises(BadRequest, match=r"did you mean 'wrist\.cable'"):
        arm.inject("wirst.cable", None, True)


async def test_only_what_is_simulated_can_be_broken() -> None:
    assert not isinstance(interleaved(Played("a", 0.0, 0.2), Played("b", 0.1)), FaultInjector)
    mixed = interleaved(Played("a", 0.0, 0.2), Breakable("b", 0.1))
    assert isinstance(mixed, BreakableEnsemble)
    with pytest.raises(BadRequest):
        mixed.inject("cable", 0, True)


async def test_reading_leaves_no_task_behind() -> None:
    await interleaved(Played("a", 0.0, 0.2), Played("b", 0.1)).read()
    assert asyncio.all_tasks() == {asyncio.current_task()}
