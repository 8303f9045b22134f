"""The ladder for joints that do not answer: hold, then fault; never guess."""

from collections.abc import Sequence
from dataclasses import dataclass

from bentod.frames import JointSpec, State


@dataclass(frozen=True, slots=True)
class Ladder:
    """How old a reading may be: beyond `hold` (s) the joint is stopped, beyond `fault` (s) the arm is."""

    hold: float
    fault: float

    def too_old_to_move(self, state: State) -> frozenset[int]:
        """Joints whose reading no longer tells where they are."""
        return frozenset(i for i, joint in enumerate(state.joints) if not joint.age <= self.hold)

    def reason_for_fault(self, state: State, specs: Sequence[JointSpec]) -> str:
        """A sentence, or nothing while every joint answers often enough and none has shut itself down."""
        return self.silence(state, specs) or shutdown(state, specs)

    def silence(self, state: State, specs: Sequence[JointSpec]) -> str:
        """Which joints have not answered for too long, as a sentence; nothing if all have."""
        silent = [
            f"{spec.name} ({joint.age:.2f} s)"
            for spec, joint in zip(specs, state.joints, strict=True)
            if not joint.age <= self.fault
        ]
        if not silent:
            return ""
        everyone = len(silent) == len(specs)
        who = (
            f"any joint ({max(joint.age for joint in state.joints):.2f} s)" if everyone else ", ".join(silent)
        )
        cause = state.problem or "check the cable and the servo's power"
        return f"no answer for more than {self.fault:g} s from {who}: {cause}"


def shutdown(state: State, specs: Sequence[JointSpec]) -> str:
    """Which servos have switched themselves off, as a sentence; nothing if none has."""
    down = [
        f"{spec.name} ({', '.join(joint.errors)})"
        for spec, joint in zip(specs, state.joints, strict=True)
        if joint.shut_down
    ]
    return f"shut down by itself: {', '.join(down)}" if down else ""
