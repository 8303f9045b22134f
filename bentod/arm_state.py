"""What the arm is between two ticks, and what the tick tells it: readings, torque, faults, operators."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

from bentod.control.arbiter import OPERATORS
from bentod.control.clients import Clients
from bentod.control.goals import Goals
from bentod.control.groups import Group, Groups
from bentod.control.guard import Guard
from bentod.control.health import Ladder
from bentod.control.joint_seats import JointSeats
from bentod.control.journal import Journal
from bentod.control.leases import Holder
from bentod.control.limiter import Limiter
from bentod.control.modes import Modes
from bentod.control.operators import Asked, Operators
from bentod.control.recency import Recency
from bentod.control.trials import Trials
from bentod.emg.live.recogniser import Recogniser
from bentod.errors import Refused
from bentod.frames import EmgFrame, GroupFrame, JointSpec, Mode, State, Value, Velocity, Wishes
from bentod.joystick import Joystick
from bentod.learn.horde import HasTime
from bentod.learn.signals import Percept
from bentod.mind import Mind
from bentod.muscles import Muscles


@dataclass(frozen=True, slots=True)
class Rules:
    """The config's safety table as the desk needs it: SI units."""

    ladder: Ladder
    limp_on_fault: bool
    home_speed: float  # rad/s
    lease_max: float  # s


_TORQUE = "torque"
"""The matter of torque that is asked for in every tick until it is confirmed."""


def shortened(names: Sequence[str], most: int = 8) -> str:
    """A list of names for a sentence."""
    return ", ".join(names[:most]) + (f" and {len(names) - most} more" if len(names) > most else "")


class ArmState:
    """The parts of one arm, which share a journal. Nothing here touches the bus."""

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
        muscles.tell = partial(self.journal.note, "emg")
        self.trials = Trials(self.journal)
        self.goals = Goals(modes, self.journal.goal)
        self.state: State | None = None
        self.to_clear: tuple[int, ...] = ()
        """Joints whose servos are to clear their errors in this tick."""
        self.needs: tuple[str, ...] = ()
        """What servos needed besides, when they were last asked to clear their errors."""
        self.rules = rules
        self.limiter = Limiter(self.specs, rules.ladder)
        self.recency = Recency()
        self.interventions = 0
        """How often joints were stopped, paused, released or had their torque switched, or a fault came."""
        self.joystick: Joystick | None = None
        self._operators = Operators([group.name for group in groups], OPERATORS)
        self._seats = JointSeats(self.specs, OPERATORS)
        self._guard = Guard(self.specs, modes, rules.ladder, self.journal)

    def begin(self, now: float) -> None:
        """A tick begins (monotonic s): leases are reckoned from here."""
        self.journal.now = now
        self.recency.begin(now)

    @property
    def now(self) -> float:
        """Monotonic s of the tick under way."""
        return self.journal.now

    def watch(self, state: State, now: float) -> None:
        """Take in a new reading: staleness, heat, servo errors, leases that ran out, the goal's progress."""
        self.state = state
        self.journal.now = now
        reason, limp = self._guard.take(state)
        if reason:
            self.fault(reason)
        self.modes.ask_torque(limp, False)
        self.clients.expire(now)
        self.goals.advance(state.joints, now)
        self.muscles.interventions = self.interventions
        if self.muscles.recognition:
            self.muscles.recognition.heeded = self._heeds_classes()

    @property
    def recognition(self) -> Recogniser:
        """What tells classes of contractions apart. Raises Refused: the config asks for none."""
        if self.muscles.recognition is None:
            raise Refused("the config has no [emg.recognition] table")
        return self.muscles.recognition

    def torque_confirmed(self, torque: Sequence[bool]) -> None:
        """Take over the torque that the hardware reports."""
        before = [self.modes.has_torque(joint) for joint in range(len(self.specs))]
        self.modes.confirm_torque(torque)
        if self.modes.wanted_torque == tuple(torque):
            self.journal.settled(_TORQUE)
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
            self.interventions += 1
            self.clients.clear()
            self.limiter.reset()
            self.goals.cancel(f"fault: {reason}")
            self.journal.note("fault", reason)

    def torque_failed(self, why: str) -> None:
        """The hardware did not confirm a torque that was asked for; that is told even in a fault."""
        reason = f"torque could not be switched: {why}"
        if self.modes.fault:
            self.journal.note_seldom("fault", _TORQUE, reason)
        self.fault(reason)

    def operate(
        self, asked: Mapping[str, Asked], joints: Mapping[str, Asked] | None = None
    ) -> dict[str, Wishes]:
        """What each operator may have of what they ask; that ends a goal that they may disturb.

        Who pushes all joints of a group at once asks it of the group's assist, not of a joint. `joints`: what
        they ask of joints by name, rather than of groups.
        """
        self._withdraw()
        taken = [group.name for group in self.groups if self._taken(group)]
        wishes: dict[str, Wishes] = {}
        one_by_one = {name: self._without_synergies_together(one) for name, one in asked.items()}
        for name, granted in self._operators.decide(one_by_one, taken, self.now).items():
            toggles = [(group, 1) for group in granted.toggles]
            toggles += [(group, -1) for group in granted.toggles_back]
            for group, steps in toggles:
                self._toggle(self.groups.group(group), steps, "the wearer")
            efforts = {group: it for group, it in granted.efforts.items() if self._operators.driver(group)}
            wishes[name] = self.groups.wishes(efforts, asked[name].moves)
            if toggles or any(efforts.values()):
                self.goals.disturb("the wearer moved")
        for name, by_name in self._seats.decide(joints or {}, self._moved(wishes), self.now).items():
            wishes[name] = {**wishes.get(name, {}), **by_name}
            if by_name:
                self.goals.disturb("the wearer moved")
        return wishes

    def _moved(self, wishes: Mapping[str, Wishes]) -> set[int]:
        """Joints that nobody drives by name: a client moves them, or their group is driven."""
        driven = [group for group in self.groups if self._client(group) or self._operators.driver(group.name)]
        by_groups = {joint for group in driven for joint in self._reached(group)}
        held = {joint for joint in range(len(self.specs)) if self.clients.holder(joint)}
        return by_groups | held | {joint for asked in wishes.values() for joint in asked}

    def _reached(self, group: Group) -> Sequence[int]:
        """Joints that whoever drives a group may move: its active one, or all of them."""
        whole = group.together or group.name in self.muscles.recognised
        return group.joints if whole else (group.active,)

    def _taken(self, group: Group) -> bool:
        """Whether a client drives a group; where classes move any joint, a lease on any counts."""
        if self._client(group) or self._seats.driven(self._reached(group)):
            return True
        joints = group.joints if group.name in self.muscles.recognised else ()
        return any(self.clients.holder(joint) for joint in joints)

    def _heeds_classes(self) -> bool:
        """Whether the wearer sees what classes ask for: who does not cannot correct it by letting go."""
        moved = [group for group in self.groups if group.name in self.muscles.recognised]
        return all(
            not self._taken(group)
            and self._operators.driver(group.name) in ("", "emg")
            and all(self.modes.of(joint) is Mode.ACTIVE for joint in group.joints)
            for group in moved
        )

    def _without_synergies_together(self, asked: Asked) -> Asked:
        """A class that moves joints of its own must not push all joints where they are selected at once."""
        together = {name for name in asked.moves if self.groups.group(name).together}
        efforts = {name: 0.0 if name in together else effort for name, effort in asked.efforts.items()}
        return replace(asked, efforts=efforts) if together else asked

    def percept(self, tick: int, due: float, gap: bool, state: State, emg: EmgFrame) -> Percept:
        """What learners are told of the tick under way, once operators have asked."""
        return Percept(tick, due, gap, state, emg, tuple(map(self._group_frame, self.groups)))

    def learn(self, has_time: HasTime) -> None:
        """Let the learners take in the rest of what the tick under way shows."""
        self.mind.learn(has_time)
        if anew := self.mind.begun_anew():
            data: dict[str, Value] = {"began_anew": list[Value](anew)}
            self.journal.note_seldom(
                "diverged", "began_anew", f"diverged, and began anew: {shortened(anew)}", data
            )

    def driver(self, group: Group) -> tuple[str, float]:
        """Who drives a group, and what they ask (-1..1) of its active joint, or of all of its joints."""
        client = self._client(group)
        if client is None:
            return self._operators.driver(group.name), self._operators.effort(group.name)
        if push := self.clients.pusher(group.name):
            return f"client:{client.client}", push.wish.effort
        wish = self.clients.wishes()[group.active]
        top = self.specs[group.active].max_velocity
        return f"client:{client.client}", wish.velocity / top if isinstance(wish, Velocity) else 0.0

    def _client(self, group: Group) -> Holder | None:
        """The client that drives a group."""
        if group.together:
            push = self.clients.pusher(group.name)
            return push.holder if push else None
        return self.clients.holder(group.active)

    def _group_frame(self, group: Group) -> GroupFrame:
        """Joints that cannot all move are not pushed: what is left of the path would be another one."""
        operator, effort = self.driver(group)
        if group.together and any(self.modes.of(joint) is not Mode.ACTIVE for joint in group.joints):
            effort = 0.0
        names = tuple(self.specs[joint].name for joint in group.joints)
        active = self.specs[group.active].name
        return GroupFrame(group.name, names, active, effort, operator, group.together)

    def _withdraw(self) -> None:
        """Fall back to one joint where all at once are no longer to be had: the assist has lost the way."""
        for group in self.groups:
            if group.together and not self.mind.offers_together(group.name):
                group.together = False
                self._switched(group, "the assist, no longer sure of the way,", rest=True)

    def _suspend_operators(self, joints: Sequence[int]) -> None:
        """Whoever contracts while `joints` are released must rest once before they move any of them."""
        self._seats.suspend(joints)
        for group in self.groups:
            if not set(group.joints).isdisjoint(joints):
                self._operators.suspend(group.name)

    def _toggle(self, group: Group, steps: int, who: str) -> Group:
        before = group.together
        group.toggle(steps, self.mind.order(group.name), self.mind.offers_together(group.name))
        self._switched(group, who, rest=group.together is not before)
        return group

    def _switched(self, group: Group, who: str, rest: bool) -> None:
        """`rest`: who pushed all joints and now has one, or the reverse, must rest once before going on."""
        name = self.specs[group.active].name
        self.clients.drop_group(group.name)
        if rest:
            self._operators.suspend(group.name)
        self.mind.toggled(group.name, self.now)
        what = "all joints together" if group.together else name
        data: dict[str, Value] = {"group": group.name, "active": name, "together": group.together}
        self.journal.note("group", f"{who} switched {group.name} to {what}", data)

    def _names(self, joints: Sequence[int]) -> str:
        whole = len(joints) == len(self.specs)
        return "the arm" if whole else ", ".join(self.specs[joint].name for joint in joints)
