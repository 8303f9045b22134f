"""Where requests meet the arm: what clients and the daemon may ask between two ticks, without waiting."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from bentod.control.clients import Clients
from bentod.control.goals import Goals
from bentod.control.groups import Group, Groups
from bentod.control.health import Ladder
from bentod.control.journal import Journal
from bentod.control.leases import Holder, Lease
from bentod.control.modes import Modes
from bentod.errors import BadRequest, Refused, nearest
from bentod.frames import Command, JointSpec, Mode, State, Stop, Value, Wishes
from bentod.mind import Mind
from bentod.muscles import Muscles


@dataclass(frozen=True, slots=True)
class Rules:
    """The config's safety table as the desk needs it: SI units."""

    ladder: Ladder
    limp_on_fault: bool
    home_speed: float  # rad/s
    lease_max: float  # s


class Desk:
    """The arm's state between two ticks, and what may be asked of it. Nothing here touches the bus."""

    def __init__(
        self,
        specs: Sequence[JointSpec],
        groups: Groups,
        modes: Modes,
        rules: Rules,
        muscles: Muscles,
        mind: Mind,
    ) -> None:
        self.specs = tuple(specs)
        self.groups = groups
        self.modes = modes
        self.muscles = muscles
        self.mind = mind
        self.meta: Value = None
        self.clients = Clients()
        self.journal = Journal(self.specs)
        self.goals = Goals(modes, self.journal.goal)
        self.state: State | None = None
        self.to_clear: tuple[int, ...] = ()
        """Joints whose servos are to clear their errors in this tick."""
        self.needs: tuple[str, ...] = ()
        """What servos needed besides, when they were last asked to clear their errors."""
        self.rules = rules
        self._down: frozenset[int] = frozenset()

    def begin(self, now: float) -> None:
        """A tick begins (monotonic s): leases are reckoned from here."""
        self.journal.now = now

    @property
    def now(self) -> float:
        """Monotonic s of the tick under way."""
        return self.journal.now

    # Verbs: each takes effect in the tick that is about to begin.

    def pause(self, joints: Sequence[int], on: bool) -> None:
        """Stop joints until released, or release them. Raises Refused as `Modes.pause` does."""
        if on:
            self.clients.drop(joints)
        self.modes.pause(joints, on)
        self.goals.cancel("the arm was paused" if on else "the arm was released", joints)
        self.modes.pause(joints, on)  # the goal's end may have paused again what was released
        self.journal.note("mode", f"{self._names(joints)} {'paused' if on else 'released'}")

    def torque(self, joints: Sequence[int], on: bool) -> None:
        """Switch torque, which pauses. Raises Refused as `Modes.ask_torque` does."""
        self.modes.ask_torque(joints, on)
        self.clients.drop(joints)
        self.goals.cancel("torque was switched", joints)
        self.journal.note("mode", f"torque {'on' if on else 'off'} asked for {self._names(joints)}")

    def stop(self, who: str) -> None:
        """Stop everything: wishes and goals are dropped, every joint is paused. Never refused."""
        self.clients.clear()
        self.goals.cancel(f"stopped by {who}")
        self.modes.pause(range(len(self.specs)), True)
        self.journal.note("mode", f"stopped by {who}")

    def clear_fault(self) -> None:
        """Unlatch the fault; joints stay paused. Servos with errors are first asked to clear them.

        Raises:
            Refused: there is no fault, or joints still do not answer.
        """
        if not self.modes.fault:
            raise Refused("there is no fault to clear")
        silence = self.state and self.rules.ladder.silence(self.state, self.specs)
        if silence:
            raise Refused(f"the cause is still there: {silence}")
        joints = self.state.joints if self.state else ()
        self.to_clear = tuple(i for i, joint in enumerate(joints) if joint.errors or joint.shut_down)
        if not self.to_clear:
            self.errors_cleared(())

    def move(self, joint: int, command: Command, holder: Holder, lease: float) -> None:
        """Move a joint for `lease` seconds. Raises Refused: it may not move, or another client holds it."""
        self._must_be_active(joint)
        self.clients.move(joint, Lease(holder, command, self.now + self._lease(lease)))
        self.goals.cancel(f"{holder.client} moved {self.specs[joint].name}", (joint,))

    def group_command(self, name: str, effort: float, holder: Holder, lease: float) -> Group:
        """Move a group's active joint at `effort` (-1..1) for `lease` seconds. Raises as `move` does."""
        group = self.groups.group(name)
        self._must_be_active(group.active)
        command = self.groups.wish(name, effort).get(group.active, Stop())
        self.clients.move(group.active, Lease(holder, command, self.now + self._lease(lease)), name)
        self.goals.cancel(f"{holder.client} moved the group {name}", (group.active,))
        return group

    def toggle(self, name: str, steps: int, who: str) -> Group:
        """Make the next (1) or previous (-1) joint of a group active. Raises BadRequest: no such group."""
        group = self.groups.group(name)
        group.toggle(steps)
        self._switched(group, who)
        return group

    def activate(self, name: str, joint: str, who: str) -> Group:
        """Make `joint` active in its group. Raises BadRequest: no such group, or not in it."""
        group = self.groups.activate(name, joint)
        self._switched(group, who)
        return group

    def go_home(self, joints: Sequence[int]) -> int:
        """Send joints home; returns the goal's number.

        Joints that are paused go too, undisturbed by the wearer, and are paused again afterwards; a homing
        of released joints ends at the wearer's first sign.

        Raises:
            Refused: no reading yet, a fault, or a joint without torque.
        """
        if self.state is None:
            raise Refused("the arm has not been read yet")
        specs = {joint: self.specs[joint] for joint in joints}
        self.clients.drop(joints)
        return self.goals.begin(specs, self.state.joints, self.rules.home_speed, self.now)

    def pause_muscles(self, on: bool) -> None:
        """Let the wearer's muscles drive nothing, or let them drive again."""
        self.muscles.paused = on
        self.journal.note("emg", f"EMG {'paused' if on else 'released'}")

    def set_meta(self, meta: Value) -> None:
        """Put `meta` into every frame from now on."""
        self.meta = meta
        self.journal.note("meta", "meta set", {"meta": meta})

    def describe_groups(self) -> Value:
        """The groups as clients see them."""
        return [
            {
                "name": group.name,
                "joints": [self.specs[joint].name for joint in group.joints],
                "active": self.specs[group.active].name,
            }
            for group in self.groups
        ]

    # What the tick tells the desk.

    def watch(self, state: State, now: float) -> None:
        """Take in a new reading: staleness, servo errors, leases that ran out, the goal's progress."""
        self.state = state
        self.journal.now = now
        reason = self.rules.ladder.reason_for_fault(state, self.specs)
        if reason:
            self.fault(reason)
        down = frozenset(joint for joint, reading in enumerate(state.joints) if reading.shut_down)
        self.modes.ask_torque(down - self._down, False)  # else its old goal waits for the alarm to end
        self._down = down
        self.journal.errors(state)
        self.clients.expire(now)
        self.goals.advance(state.joints, now)

    def torque_confirmed(self, torque: Sequence[bool]) -> None:
        """Take over the torque that the hardware reports."""
        before = [self.modes.has_torque(joint) for joint in range(len(self.specs))]
        self.modes.confirm_torque(torque)
        for on in (True, False):
            changed = [joint for joint, was in enumerate(before) if torque[joint] is on is not was]
            if changed:
                self.journal.note("mode", f"torque is {'on' if on else 'off'}: {self._names(changed)}")

    def torque_found(self, torque: Sequence[bool]) -> None:
        """Servos lost or gained torque by themselves: that is a fault, and what they have is believed."""
        lost = [j for j, on in enumerate(torque) if self.modes.has_torque(j) and not on]
        self.torque_confirmed(torque)
        what = f"{self._names(lost)} lost torque" if lost else "a servo gained torque"
        self.fault(f"{what} unasked: power or servo was reset")

    def errors_cleared(self, needs: Sequence[str]) -> None:
        """The servos in `to_clear` have done what they could; `needs` says what some of them need besides."""
        self.to_clear = ()
        self.needs = tuple(needs)
        if needs:
            self.journal.note("fault", f"not cleared: {' '.join(needs)}")
            return
        self.modes.clear_fault()
        self.journal.note("fault", "fault cleared; joints stay paused")

    def fault(self, reason: str) -> None:
        """The one door into fault; the first reason stays until it is cleared."""
        if self.modes.enter_fault(reason, self.rules.limp_on_fault):
            self.clients.clear()
            self.goals.cancel(f"fault: {reason}")
            self.journal.note("fault", reason)

    def torque_failed(self, why: str) -> None:
        """The hardware did not confirm a torque that was asked for; that is told even in a fault."""
        reason = f"torque could not be switched: {why}"
        if self.modes.fault:
            self.journal.note("fault", reason)
        self.fault(reason)

    def operator(self, efforts: Mapping[str, float], toggles: Sequence[str]) -> Wishes:
        """What the wearer's muscles ask, by group (efforts -1..1); they end a goal that they may disturb."""
        for name in toggles:
            self.toggle(name, 1, "the wearer")
        wishes = {
            j: command
            for name, effort in efforts.items()
            for j, command in self.groups.wish(name, effort).items()
        }
        if wishes or toggles:
            self.goals.disturb("the wearer moved")
        return wishes

    # Names and bounds.

    def select(self, joints: str | Sequence[str] | None) -> tuple[int, ...]:
        """Indices of one joint, several, or (None) all. Raises BadRequest: there is no such joint."""
        if joints is None:
            return tuple(range(len(self.specs)))
        names = [spec.name for spec in self.specs]
        asked = [joints] if isinstance(joints, str) else list(joints)
        if not asked:
            raise BadRequest("name at least one joint, or leave the names out for all of them", "joints")
        for name in asked:
            if name not in names:
                raise BadRequest(f"there is no joint '{name}'{nearest(name, names)}", "joints")
        return tuple(names.index(name) for name in asked)

    def _must_be_active(self, joint: int) -> None:
        mode = self.modes.of(joint)
        if self.goals.borrows(joint):
            raise Refused(
                f"{self.specs[joint].name} is paused and on its way home: release it (pause off) first"
            )
        if mode is Mode.ACTIVE:
            return
        remedy = {
            Mode.FAULT: f"clear_fault first ({self.modes.fault})",
            Mode.LIMP: "switch torque on and release it (pause off) first",
        }
        raise Refused(
            f"{self.specs[joint].name} is {mode.value}: {remedy.get(mode, 'release it (pause off) first')}"
        )

    def _lease(self, seconds: float) -> float:
        return min(seconds, self.rules.lease_max)

    def _switched(self, group: Group, who: str) -> None:
        name = self.specs[group.active].name
        self.clients.drop_group(group.name)
        self.mind.toggled(self.now)
        self.journal.note(
            "group", f"{who} switched {group.name} to {name}", {"group": group.name, "active": name}
        )

    def _names(self, joints: Sequence[int]) -> str:
        whole = len(joints) == len(self.specs)
        return "the arm" if whole else ", ".join(self.specs[joint].name for joint in joints)
