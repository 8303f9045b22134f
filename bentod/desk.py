"""Where requests meet the arm: what clients and the daemon may ask between two ticks, without waiting."""

from collections.abc import Mapping, Sequence

from bentod.arm_state import ArmState, shortened
from bentod.control.clients import Push
from bentod.control.grips import Hold
from bentod.control.groups import Group
from bentod.control.leases import Holder, Lease
from bentod.emg.live.collection import Collection
from bentod.errors import BadRequest, Refused, nearest
from bentod.frames import Command, Mode, Stop, Trial, Value

ASKED_IN_MOTION = 100
"""GVFs up to which others may come and go while the arm may move: about one tick's time."""

ASKED_AT_ONCE = 1000
"""GVFs that a family may have that is asked while nothing moves."""


class Desk(ArmState):
    """Every verb: each takes effect in the tick that is about to begin."""

    def pause(self, joints: Sequence[int], on: bool) -> None:
        """Stop joints until released, or release them; then the wearer must rest once before moving them.

        Raises:
            Refused: a release that may be an old one, or as `Modes.pause` does.
        """
        if on:
            self.clients.drop(joints)
        else:
            self.recency.require()
        halted = [j for j in joints if self.modes.of(j) is not Mode.ACTIVE or self.goals.borrows(j)]
        self.modes.pause(joints, on)
        self.interventions += 1
        if not on:
            self._suspend_operators(halted)
        self.goals.cancel("the arm was paused" if on else "the arm was released", joints)
        self.modes.pause(joints, on)  # the goal's end may have paused again what was released
        self.journal.note("mode", f"{self._names(joints)} {'paused' if on else 'released'}")

    def torque(self, joints: Sequence[int], on: bool) -> None:
        """Switch torque, which pauses.

        Raises:
            Refused: a fault is latched, a joint is not fit to be armed, or the request to arm may be an old
                one. Nothing is changed.
        """
        if on:
            self.recency.require()
        if on and not self.modes.fault and (reason := self.unfit(joints)):
            raise Refused(f"not armed: {reason}", "joints")
        self.modes.ask_torque(joints, on)
        self.interventions += 1
        self.clients.drop(joints)
        self.goals.cancel("torque was switched", joints)
        self.journal.note("mode", f"torque {'on' if on else 'off'} asked for {self._names(joints)}")

    def unfit(self, joints: Sequence[int]) -> str:
        """Why those of `joints` that are limp may not be armed now; empty if they may."""
        return self._guard.unfit(joints, self.now)

    def stop(self, who: str) -> None:
        """Stop everything: wishes and goals are dropped, every joint is paused. Never refused.

        An arm that is stopped already stays so, and nothing is told.
        """
        everyone = range(len(self.specs))
        moved = self.clients.wishes() or self.goals.running
        if moved or any(self.modes.of(joint) is Mode.ACTIVE for joint in everyone):
            self.journal.note("mode", f"stopped by {who}")
        self.interventions += 1
        self.clients.clear()
        self.goals.cancel(f"stopped by {who}")
        self.modes.pause(everyone, True)

    def woke(self, slept: float) -> None:
        """The machine was suspended for `slept` (s), in which leases did not run out and nobody looked."""
        self.stop(f"the machine, which was suspended for {slept:.1f} s")
        self.recency.slept(slept)

    def clear_fault(self) -> None:
        """Unlatch the fault; joints stay paused. Servos with errors are first asked to clear them.

        Raises:
            Refused: there is no fault, or joints still do not answer, or are still hot, or the request may be
                an old one.
        """
        self.recency.require()
        if not self.modes.fault:
            raise Refused("there is no fault to clear")
        if cause := self._guard.cause():
            raise Refused(f"the cause is still there: {cause}")
        joints = self.state.joints if self.state else ()
        self.needs = ()
        self.to_clear = tuple(i for i, joint in enumerate(joints) if joint.errors or joint.shut_down)
        if not self.to_clear:
            self.errors_cleared(())

    def uncleared(self) -> str | None:
        """Why a fault could not be cleared; empty if it was, None while servos are still at it."""
        if self.to_clear:
            return None
        return " ".join(self.needs) or self.modes.fault

    def move(self, joint: int, command: Command, holder: Holder, lease: float) -> None:
        """Move a joint for `lease` seconds.

        Raises:
            Refused: it may not move, another client holds it, or the request may be an old one.
        """
        self.recency.require()
        self._must_be_active(joint)
        self.clients.move(joint, Lease(holder, command, self.now + self._lease(lease)))
        self.goals.cancel(f"{holder.client} moved {self.specs[joint].name}", (joint,))

    def group_command(self, name: str, effort: float, holder: Holder, lease: float) -> Group:
        """Move a group's active joint at `effort` (-1..1) for `lease` seconds. Raises as `move` does.

        While all joints of the group are selected, that is how all of them are pushed (above 0) or pulled.
        """
        group = self.groups.group(name)
        self.recency.require()
        for joint in group.joints if group.together else (group.active,):
            self._must_be_active(joint)
        if group.together:
            push = Push(max(-1.0, min(1.0, effort)), group.joints)
            self.clients.push(name, Lease(holder, push, self.now + self._lease(lease)))
            self.goals.cancel(f"{holder.client} moved the group {name}", group.joints)
            return group
        command = self.groups.wish(name, effort).get(group.active, Stop())
        self.clients.move(group.active, Lease(holder, command, self.now + self._lease(lease)), name)
        self.goals.cancel(f"{holder.client} moved the group {name}", (group.active,))
        return group

    def toggle(self, name: str, steps: int, who: str) -> Group:
        """Make the next (1) or previous (-1) joint of a group active.

        Raises:
            BadRequest: no such group.
            Refused: the request may be an old one.
        """
        self.recency.require()
        group = self.groups.group(name)
        self._operators.suspend(name)
        return self._toggle(group, steps, who)

    def activate(self, name: str, joint: str, who: str) -> Group:
        """Make `joint` active in its group.

        Raises:
            BadRequest: no such group, or not in it.
            Refused: the request may be an old one.
        """
        self.recency.require()
        group = self.groups.activate(name, joint)
        self._switched(group, who, rest=True)
        return group

    def go_home(self, joints: Sequence[int], hold: Hold | None = None) -> int:
        """Send joints home, or hold the goal that does so already; returns its number.

        Joints that are paused go too, undisturbed by the wearer, and are paused again afterwards; a homing
        of released joints ends at the wearer's first sign. One that is on `hold` ends when that is over.

        Raises:
            Refused: as `Goals.renew` and `begin` do, no reading yet, or the request may be an old one.
        """
        self.recency.require()
        if self.state is None:
            raise Refused("the arm has not been read yet")
        held = Lease(hold.holder, frozenset(joints), self.now + self._lease(hold.lease)) if hold else None
        if hold and held and (known := self.goals.renew(held, hold.goal)):
            return known
        specs = {joint: self.specs[joint] for joint in joints}
        self.clients.drop(joints)
        return self.goals.begin(specs, self.state.joints, self.rules.home_speed, self.now, held)

    def pause_muscles(self, on: bool) -> None:
        """Let the wearer's muscles drive nothing, or let them drive again once they have rested.

        Raises:
            Refused: they are to drive again, but the request may be an old one.
        """
        if not on:
            self.recency.require()
            if self.muscles.paused:
                self._operators.suspend_all()
        if on and self.muscles.recognition:
            self.muscles.recognition.cancel("EMG was paused.")
        self.muscles.pause(on)
        self.journal.note("emg", f"EMG {'paused' if on else 'released'}")

    def collect(self, collection: Collection) -> None:
        """Prompt contractions and keep what is done, while muscles move nothing.

        Afterwards the muscles must be seen at rest. Raises Refused: a collection is under way.
        """
        self.recognition.collect(collection, self.interventions)
        self._operators.suspend_all()

    def change_assist(self, changes: Mapping[str, Value], group: str | None = None) -> None:
        """Change the settings of the assist of a group (None: the first). Raises as `Mind.change` does."""
        group = self.mind.change(changes, group)
        self.journal.note("assist", f"assist of {group} changed", self.mind.describe(group))

    def reward(self, reward: float, who: str, group: str | None = None) -> None:
        """Somebody was pleased (above 0) or not (below 0) with a group, or (None) all. Raises BadRequest."""
        self.mind.rewards.give(reward, group)
        what = group or "the arm"
        self.journal.note("reward", f"{who} gave {what} {reward:+g}", {"reward": reward, "group": group})

    def mark_trial(self, mark: str) -> Trial:
        """Note what happened in the trial; a "contact" is a reward, too. Raises Refused: none runs."""
        trial = self.trials.mark(mark)
        self.mind.rewards.marked(mark)
        return trial

    def mark(self, mark: str, who: str) -> Trial | None:
        """The same at any time; returns the trial, if one runs."""
        self.mind.rewards.marked(mark)
        return self.trials.note(mark, who)

    def describe_gvfs(self) -> Value:
        """Every general value function as clients see it. Raises Refused: nothing learns."""
        return self.mind.describe_gvfs()

    def add_gvf(self, table: Value) -> tuple[str, ...]:
        """Ask one more question about the future, or a family of them; returns their names.

        Raises:
            Refused: nothing learns, or so much that the arm, which may move, would have to wait.
            BadRequest: that cannot be asked.
        """
        names = self.mind.add_gvf(table, self._must_bear_a_pause())
        self.journal.note("learn", f"GVF added: {shortened(names)}", {"added": table})
        return names

    def remove_gvfs(self, names: Sequence[str]) -> None:
        """Ask no more. Raises as `add_gvf` does, BadRequest: there is no such question, or it is needed."""
        self._must_bear_a_pause()
        self.mind.learners.remove(names)
        self.journal.note("learn", f"GVF removed: {shortened(names)}", {"removed": list[Value](names)})

    def reset_gvfs(self, names: Sequence[str]) -> None:
        """Let what was learned about some questions be forgotten. Raises Refused, BadRequest: none such."""
        self.mind.learners.reset(names)
        self.journal.note("learn", f"GVF reset: {shortened(names)}", {"reset": list[Value](names)})

    def set_meta(self, meta: Value) -> None:
        """Put `meta` into every frame from now on."""
        self.meta = meta
        self.journal.note("meta", "meta set", {"meta": meta})

    def describe_groups(self) -> Value:
        """The groups as clients see them."""
        return self.groups.describe()

    def _must_bear_a_pause(self) -> int:
        """Changing what is asked takes long where much is asked: ticks are then missed.

        Returns how many more may be asked at once. Raises Refused: the arm, which may move, would wait.
        """
        learners = self.mind.learners
        asked = len(learners.horde.questions)
        if not any(mode is Mode.ACTIVE for mode in map(self.modes.of, range(len(self.specs)))):
            return ASKED_AT_ONCE
        if asked > ASKED_IN_MOTION:
            raise Refused(
                f"{asked} GVFs are learned, and with more than {ASKED_IN_MOTION} a change holds up the tick: "
                "pause the arm first"
            )
        if learners.changed:
            raise Refused("GVFs came or went in this tick already, which takes time: ask again")
        return max(ASKED_IN_MOTION - asked, 1)

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
        if self.goals.borrows(joint):
            raise Refused(
                f"{self.specs[joint].name} is paused and on its way home: release it (pause off) first"
            )
        self.modes.may_move(joint)

    def _lease(self, seconds: float) -> float:
        return min(seconds, self.rules.lease_max)
