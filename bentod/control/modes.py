"""What each joint may do. Here is the only door into torque, and the only one into fault."""

from collections.abc import Iterable, Sequence

from bentod.errors import Refused
from bentod.frames import Mode

_RANK = (Mode.ACTIVE, Mode.PAUSED, Mode.HOLDING, Mode.LIMP)


class Modes:
    """LIMP → HOLDING → ACTIVE ⇄ PAUSED for each joint, and FAULT for the arm.

    Torque passes through `ask_torque`, which only notes the wish: the controller carries the wish to the
    hardware and reports with `confirm_torque` what came of it. A joint that gains torque is HOLDING and one
    that loses it is LIMP: switching torque pauses (thesis A.1), and only `pause(..., False)` releases.
    """

    def __init__(self, names: Sequence[str], torque: Sequence[bool]) -> None:
        self._names = tuple(names)
        self._modes = [Mode.HOLDING if on else Mode.LIMP for on in torque]
        self._wanted = list(torque)
        self._fault = ""
        self._limp_in_fault = False

    @property
    def fault(self) -> str:
        """Why the arm is in fault; empty when it is not."""
        return self._fault

    @property
    def arm(self) -> Mode:
        """FAULT, or the mode of the least restrained joint."""
        return Mode.FAULT if self._fault else min(self._modes, key=_RANK.index)

    @property
    def wanted_torque(self) -> tuple[bool, ...]:
        """The torque that each joint should have."""
        return tuple(self._wanted)

    def of(self, joint: int) -> Mode:
        """The mode of one joint; FAULT covers all of them."""
        return Mode.FAULT if self._fault else self._modes[joint]

    def has_torque(self, joint: int) -> bool:
        """Whether the joint holds or moves, fault or not."""
        return self._modes[joint] is not Mode.LIMP

    def pause(self, joints: Iterable[int], on: bool) -> None:
        """Stop joints until they are released, or release them.

        Raises:
            Refused: a release while a fault is latched, or of a joint without torque. Nothing is changed.
        """
        joints = tuple(joints)
        if not on:
            self.may_release(joints)
        for joint in joints:
            if on and self._modes[joint] is Mode.ACTIVE:
                self._modes[joint] = Mode.PAUSED
            elif not on:
                self._modes[joint] = Mode.ACTIVE

    def ask_torque(self, joints: Iterable[int], on: bool) -> None:
        """Note that joints should gain or lose torque, and pause them.

        Raises:
            Refused: torque on while a fault is latched.
        """
        if on and self._fault:
            raise Refused(f"no torque while a fault is latched ({self._fault}): clear_fault first")
        for joint in joints:
            self._wanted[joint] = on
            if self._modes[joint] is Mode.ACTIVE:
                self._modes[joint] = Mode.PAUSED

    def confirm_torque(self, torque: Sequence[bool]) -> None:
        """Take over what the hardware has: a joint that lost torque is LIMP, one that gained it HOLDING.

        Torque that did not come is wanted no longer: only a request may arm. Torque that did not go stays
        unwanted until it is gone, whatever else happens. A limp joint that gained torque unasked is believed,
        unless the arm is limp because of a fault.
        """
        for joint, on in enumerate(torque):
            if not on:
                self._modes[joint] = Mode.LIMP
                self._wanted[joint] = False
            elif self._modes[joint] is Mode.LIMP:
                self._modes[joint] = Mode.HOLDING
                self._wanted[joint] = not (self._fault and self._limp_in_fault)

    def enter_fault(self, reason: str, limp: bool) -> bool:
        """Latch the fault; joints hold, or go limp if `limp`. True if it is new: the first reason stays."""
        if self._fault:
            return False
        self._fault = reason
        self._limp_in_fault = limp
        # A torque that was asked for in this very tick must not come true in a fault.
        self._wanted = [
            mode is not Mode.LIMP and on and not limp
            for mode, on in zip(self._modes, self._wanted, strict=True)
        ]
        for joint, mode in enumerate(self._modes):
            if mode is not Mode.LIMP:
                self._modes[joint] = Mode.HOLDING
        return True

    def clear_fault(self) -> None:
        """Unlatch. Joints stay HOLDING or LIMP: releasing them is a request of its own."""
        self._fault = ""

    def may_move(self, joint: int) -> None:
        """Raise Refused, with what to do first, for a joint that is not active."""
        mode = self.of(joint)
        if mode is Mode.ACTIVE:
            return
        remedy = {
            Mode.FAULT: f"clear_fault first ({self._fault})",
            Mode.LIMP: "switch torque on and release it (pause off) first",
        }.get(mode, "release it (pause off) first")
        raise Refused(f"{self._names[joint]} is {mode.value}: {remedy}")

    def may_release(self, joints: Iterable[int]) -> None:
        """Raise Refused while a fault is latched, or for a joint without torque."""
        if self._fault:
            raise Refused(f"a fault is latched ({self._fault}): clear_fault first")
        # A joint that is about to lose torque is limp already: nothing may be written to it meanwhile.
        limp = [
            self._names[joint]
            for joint in joints
            if self._modes[joint] is Mode.LIMP or not self._wanted[joint]
        ]
        if limp:
            raise Refused(f"torque is off on {', '.join(limp)}: switch it on first", "joints")
