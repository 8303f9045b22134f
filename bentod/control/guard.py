"""What readings mean for the arm: what is a fault, which joints must let go, which may be armed."""

from collections.abc import Collection, Sequence

from bentod.control import arming, heat
from bentod.control.health import Ladder
from bentod.control.journal import Journal
from bentod.control.modes import Modes
from bentod.frames import JointSpec, State


class Guard:
    """Looks at every reading before anything moves by it."""

    def __init__(self, specs: Sequence[JointSpec], modes: Modes, ladder: Ladder, journal: Journal) -> None:
        self._specs = tuple(specs)
        self._modes = modes
        self._ladder = ladder
        self._journal = journal
        self._heat = heat.Heat(specs)
        self._down: frozenset[int] = frozenset()
        self._state: State | None = None

    def take(self, state: State) -> tuple[str, Collection[int]]:
        """Take in a reading: why it is a fault (empty if it is none), and who must go limp because of it."""
        self._state = state
        for spec, text in self._heat.take(state):
            self._journal.note("servo", text, {"joint": spec.name})
        self._journal.errors(state)
        hot = [joint for joint in sorted(self._heat.too_hot) if self._modes.has_torque(joint)]
        reason = self._ladder.reason_for_fault(state, self._specs) or heat.complaint(hot, self._specs, state)
        return reason, [*self._shut_down(state), *hot]

    def cause(self) -> str:
        """Why a fault may not be cleared yet, as a sentence; empty if it may."""
        if self._state is None:
            return ""
        everyone = range(len(self._specs))
        return self._ladder.silence(self._state, self._specs) or heat.complaint(
            everyone, self._specs, self._state
        )

    def unfit(self, joints: Collection[int], now: float) -> str:
        """Why those of `joints` that are limp may not be armed now (monotonic s); empty if they may."""
        limp = [joint for joint in joints if not self._modes.has_torque(joint)]
        return arming.objections(limp, self._specs, self._state, self._ladder, now) if limp else ""

    def _shut_down(self, state: State) -> list[int]:
        """Who has shut down by itself just now: else its old goal waits for the alarm to end."""
        down = frozenset(joint for joint, reading in enumerate(state.joints) if reading.shut_down)
        new = sorted(down - self._down)
        self._down = down
        return new
