"""Several drivers as one arm: each joint on its own bus, one state, one command a tick for all."""

import asyncio
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

from bentod.contracts import FaultInjector, Joints
from bentod.errors import BadRequest, BusError, nearest
from bentod.frames import Command, JointState, State

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Member:
    """One driver of the arm, and which of the arm's joints are its own, in its own order."""

    name: str
    joints: Joints
    indices: tuple[int, ...]

    def share(self, values: Sequence[T]) -> list[T]:
        """Of the arm's values, one a joint, those of this member's joints."""
        return [values[index] for index in self.indices]


class Ensemble:
    """The `Joints` contract over several members, whose joints are all joints of the arm."""

    def __init__(self, members: Sequence[Member]) -> None:
        """Every index from 0 up belongs to exactly one member."""
        self._members = tuple(members)
        self._cleared: dict[int, tuple[str, ...]] = {}  # by number of the member, while others are at it
        self._count = sum(len(member.indices) for member in members)

    async def read(self) -> State:
        """All buses at once; ages are counted to the end of the slowest round."""
        states = await _all_read(self._members)
        time = max(state.time for state in states)
        joints: dict[int, JointState] = {}
        for member, state in zip(self._members, states, strict=True):
            late = time - state.time
            aged = (replace(joint, age=joint.age + late) for joint in state.joints)
            joints.update(zip(member.indices, aged, strict=True))
        problem = " ".join(state.problem for state in states if state.problem)
        return State(time, tuple(joints[index] for index in range(self._count)), problem)

    async def write(self, commands: Sequence[Command | None]) -> None:
        """Each member its share. One that breaks keeps no other from being told, to stop perhaps."""
        broken: list[Exception] = []
        for member in self._members:
            try:
                await member.joints.write(member.share(commands))
            except Exception as error:  # noqa: BLE001 -- told to the tick below
                broken.append(error)
        if broken:
            raise ExceptionGroup("a driver broke in writing", broken)

    async def set_torque(self, on: Sequence[bool]) -> None:
        """Off before on over the whole arm, each member even if another failed."""
        problems: list[str] = []
        for member in self._members:
            has, wanted = member.joints.torque(), member.share(on)
            kept = [was and now for was, now in zip(has, wanted, strict=True)]
            if tuple(kept) != has:
                problems += await _tried(member, kept)
        for member in self._members:
            problems += await _tried(member, member.share(on))
        if problems:
            raise BusError(" ".join(dict.fromkeys(problems)))

    def torque(self) -> tuple[bool, ...]:
        """Of each joint as last confirmed, by whichever member it is on."""
        found = {
            index: on
            for member in self._members
            for index, on in zip(member.indices, member.joints.torque(), strict=True)
        }
        return tuple(found[index] for index in range(self._count))

    async def clear_errors(self, joints: Sequence[int]) -> tuple[str, ...] | None:
        """Each member those of its joints that are among `joints`; who is done waits for the others."""
        waiting = False
        for number, member in enumerate(self._members):
            own = [own for own, index in enumerate(member.indices) if index in joints]
            if own and number not in self._cleared:
                needs = await _cleared(member, own)
                if needs is not None:
                    self._cleared[number] = needs
                else:
                    waiting = True
        if waiting:
            return None
        told = tuple(need for needs in self._cleared.values() for need in needs)
        self._cleared.clear()
        return told


class BreakableEnsemble(Ensemble):
    """An ensemble with members that can be broken on purpose (FaultInjector)."""

    def __init__(self, members: Sequence[Member]) -> None:
        super().__init__(members)
        self._breakable = [
            (member, member.joints) for member in members if isinstance(member.joints, FaultInjector)
        ]

    def faults(self) -> tuple[str, ...]:
        """Every member's, and each with the member's name before it: "wrist.cable" spares other buses."""
        everywhere = [fault for _, joints in self._breakable for fault in joints.faults()]
        only = [f"{member.name}.{fault}" for member, joints in self._breakable for fault in joints.faults()]
        return tuple(dict.fromkeys([*everywhere, *only]))

    def inject(self, fault: str, joint: int | None, on: bool) -> None:
        """Break the member that the fault or the joint names, or every member that knows the fault."""
        if fault not in self.faults():
            raise BadRequest(f"there is no fault '{fault}'{nearest(fault, self.faults())}", "fault")
        name, _, plain = fault.rpartition(".")
        chosen = [
            (member, joints)
            for member, joints in self._breakable
            if name in ("", member.name) and plain in joints.faults()
            if joint is None or joint in member.indices
        ]
        if not chosen:
            raise BadRequest(f"the driver of joint {joint} has no fault '{fault}'", "joint")
        for member, joints in chosen:
            joints.inject(plain, None if joint is None else member.indices.index(joint), on)


def gather(members: Sequence[Member]) -> Joints:
    """The members as one arm. One member that has every joint is the arm, at no cost."""
    if len(members) == 1:
        return members[0].joints
    breakable = any(isinstance(member.joints, FaultInjector) for member in members)
    return BreakableEnsemble(members) if breakable else Ensemble(members)


async def _tried(member: Member, on: Sequence[bool]) -> list[str]:
    """What went wrong when the member's torque was switched."""
    try:
        await member.joints.set_torque(on)
    except BusError as error:
        return [str(error)]
    except Exception as error:  # noqa: BLE001 -- a bug in one driver keeps no other joint from letting go
        return [f"{member.name}: {type(error).__name__}: {error}"]
    return []


async def _cleared(member: Member, joints: Sequence[int]) -> tuple[str, ...] | None:
    """As `Joints.clear_errors`; a driver that breaks is a sentence, too."""
    try:
        return await member.joints.clear_errors(joints)
    except Exception as error:  # noqa: BLE001 -- a bug in one driver keeps no other from clearing its errors
        return (f"{member.name}: {type(error).__name__}: {error}",)


async def _all_read(members: Sequence[Member]) -> list[State]:
    """Every member's state. One that breaks cuts no other's round short.

    Raises:
        ExceptionGroup: members broke.
    """
    rounds = [asyncio.ensure_future(member.joints.read()) for member in members]
    found = await asyncio.gather(*rounds, return_exceptions=True)
    if broken := [result for result in found if isinstance(result, Exception)]:
        raise ExceptionGroup("a driver broke in reading", broken)
    return [done.result() for done in rounds]
