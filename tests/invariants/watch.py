"""What must hold at every tick, whatever was asked and whatever is broken."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

from bentod.frames import Value
from bentod.messages import Response
from sim.arm import Arm
from sim.servo import Servo, Setting
from tests.invariants.steps import Api, Call
from tests.invariants.talk import Asked, Speaker
from tests.rig import Table, number, table, tables

PERIOD = 1 / 30  # s

OVERSHOOT = 0.015
"""rad beyond a limit. A servo sees its place in steps of 0.0015, and the least damped joint, the shoulder,
swings over by up to 0.01 when it is stopped from full speed."""

SETTLED = 0.6
"""s after the last order: the dead-man's 0.3 s, a slow servo's dead time of 0.05 s, a lost round, a swing."""

REACH = 0.3
"""s at full speed that an order reaches at most: the dead-man's time."""

STILL = 0.01
"""rad within which a joint stays that is at rest: what is left of its swing, and the steps of its sensor."""

PINNED = 0.01
"""rad between a joint and the goal that it is armed with: steps of its sensor, what it moves meanwhile."""

FAREWELL = 0.2
"""s within which nothing is left of a client that vanished: the tick that hears of it, and the next."""

ANSWERED = 3.0
"""s within which every request is answered."""

SWITCHING = 1.0
"""s after a request to switch torque or to clear errors, within which ticks may be missed: a servo is asked a
dozen things one by one before it is armed, and the whole arm takes longer than a period."""

UNCONFIRMED = "torque could not be switched"
"""What a fault says while torque that was to go may still be there. Every tick tries again, and is late."""

DEAD = 0.1
"""s after which muscles whose source died move nothing any more."""


@dataclass(slots=True)
class Lease:
    """A wish that was granted."""

    speaker: Speaker
    joint: str
    begin: float  # s
    end: float  # s


@dataclass(slots=True)
class Seen:
    """One joint as its servo has it, and what it was last told."""

    servo: Servo
    spec: Table
    since: float = 0.0  # s of the last order to move, or of what else may move it
    start: float = 0.0  # rad at that time
    rest: float | None = None  # rad
    on: bool = False  # torque, as the servo was told
    moved: bool = False  # was ever told to
    excused: bool = False  # hears what another servo is told

    @property
    def name(self) -> str:
        return str(self.spec["name"])

    @property
    def reach(self) -> float:
        """Travel (rad) that it is allowed after its last order."""
        return number(self.spec, "max_velocity_rad_s") * (REACH + 0.1) + OVERSHOOT

    def may_move(self, now: float) -> None:
        """From now on it settles anew."""
        self.since, self.start, self.rest = now, self.servo.position, None


@dataclass(slots=True)
class Watch:
    """Looks at every frame, at the servos behind it, and at every answer."""

    api: Api
    arm: Arm
    broken: list[str] = field(default_factory=list)
    leases: list[Lease] = field(default_factory=list)
    speakers: list[Speaker] = field(default_factory=list)
    homings: dict[int, tuple[Speaker, float]] = field(default_factory=dict)  # by goal: whose, until when (s)
    left: dict[str, float] = field(default_factory=dict)  # names of clients that vanished, and when
    emg_broken: float = math.inf  # since when (s)
    switched: float = -math.inf  # when torque, or that errors be cleared, was last asked for (s)
    now: float = 0.0
    worst: dict[str, float] = field(default_factory=dict)
    seen: dict[str, Seen] = field(default_factory=dict)
    _last: tuple[float, Table] | None = None

    def __post_init__(self) -> None:
        for spec, servo in zip(self.api.joints, self.arm.servos, strict=True):
            self.seen[str(spec["name"])] = Seen(servo, spec, start=servo.position)

    def complain(self, what: str) -> None:
        """Something does not hold."""
        self.broken.append(f"{self.now:.3f} s: {what}")

    def note(self, what: str, value: float) -> None:
        """Remember the greatest value, which tells how much room a bound leaves."""
        self.worst[what] = max(self.worst.get(what, 0.0), value)

    # Frames.

    def frame(self, frame: Table, now: float) -> None:
        """A tick has passed (s). Leases are judged one frame later, when all its answers have come."""
        self.now = now
        if self._last:
            self._judge_sources(*self._last)
            self._judge_tick(self._last[1], frame)
        previous, self._last = self._last, (now, frame)
        was_in_fault = previous is None or bool(previous[1]["fault"])
        for joint in tables(frame, "joints"):
            seen = self.seen[str(joint["name"])]
            if _moving(joint):
                self._judge_mode(joint, was_in_fault)
                seen.may_move(now)
                seen.moved = True
            self._judge_place(seen, now)
        for speaker in self.speakers:
            self._judge_answers(speaker)

    def _judge_tick(self, before: Table, frame: Table) -> None:
        if frame["tick"] != number(before, "tick") + 1:
            self.complain(f"tick {before['tick']!r} was followed by {frame['tick']!r}")
        missed = number(frame, "missed") - number(before, "missed")
        self.note("missed at once", missed)
        tries_again = UNCONFIRMED in str(before["fault"])
        if missed and self.now - self.switched > SWITCHING and not tries_again:
            self.complain(f"{missed:g} ticks were missed before tick {frame['tick']!r}")
        if "internal error" in str(frame["fault"]):
            self.complain(f"the tick broke: {frame['fault']!r}")

    def _judge_mode(self, joint: Table, was_in_fault: bool) -> None:
        """Who is told to move must be released; a loss of torque that is found after the write is news."""
        is_news = joint["mode"] == "fault" and not was_in_fault
        if not is_news and (joint["mode"] != "active" or not joint["torque"]):
            self.complain(f"{joint['name']!r} is {joint['mode']!r} and was sent {joint['sent']!r}")

    def _judge_place(self, seen: Seen, now: float) -> None:
        place = seen.servo.position
        low, high = number(seen.spec, "min_rad"), number(seen.spec, "max_rad")
        beyond = max(low - place, place - high)
        self.note("beyond", beyond)
        if beyond > OVERSHOOT:
            self.complain(f"{seen.name} stands {beyond:.4f} rad beyond its limit")
        if seen.excused:
            return
        travel = abs(place - seen.start)
        self.note("travel/reach", travel / seen.reach)
        if travel > seen.reach:
            self.complain(
                f"{seen.name} went on for {travel:.3f} rad since its last order at {seen.since:.3f} s"
            )
        if now - seen.since <= SETTLED:
            return
        if seen.rest is None:
            seen.rest = place
        self.note("still", abs(place - seen.rest))
        if abs(place - seen.rest) > STILL:
            self.complain(
                f"{seen.name} moved by {place - seen.rest:.4f} rad unasked, at rest since {seen.since:.3f} s"
            )
            seen.rest = place

    def _judge_sources(self, now: float, frame: Table) -> None:
        for joint in tables(frame, "joints"):
            if _moving(joint) and not self._has_source(joint, frame, now):
                self.complain(
                    f"{joint['name']!r} was sent {joint['sent']!r} for {joint['holder']!r}: no live source"
                )

    def _has_source(self, joint: Table, frame: Table, now: float) -> bool:
        source, _, who = str(joint["holder"]).partition(":")
        match source:
            case "client":
                # A fault that arises after the write has taken the lease, and its client's name with it.
                return self._leased(str(joint["name"]), who, now) or (not who and joint["mode"] == "fault")
            case "home":
                return bool(frame["goal"]) and self._goes_home(table(frame["goal"]), now)
            case "emg":
                emg = table(frame["emg"])
                alive = emg["alive"] is True and emg["paused"] is False
                return alive and now - self.emg_broken <= DEAD
            case "assist":
                return table(frame["assist"])["engaged"] is True and self._driven(joint, frame)
        return False

    def _leased(self, joint: str, who: str, now: float) -> bool:
        if now - self.left.get(who, -math.inf) <= FAREWELL:
            return True
        return any(
            lease.joint == joint and who in lease.speaker.names and lease.begin <= now < lease.end
            for lease in self.leases
        )

    def _goes_home(self, goal: Table, now: float) -> bool:
        """Whether a goal is under way, and its lease, if it has one, has not run out."""
        _, end = self.homings.get(round(number(goal, "id")), (None, math.inf))
        return goal["status"] in ("accepted", "moving") and now < end

    def _driven(self, joint: Table, frame: Table) -> bool:
        """Whether an operator drives another joint."""
        return any(
            table(asked).get(source, {"kind": "stop"}) != {"kind": "stop"}
            for other in tables(frame, "joints")
            if other["name"] != joint["name"]
            for asked in [other["asked"]]
            for source in ("client", "emg")
        )

    # Answers.

    def _judge_answers(self, speaker: Speaker) -> None:
        late = [a for a in speaker.open.values() if self.now - a.sent > ANSWERED]
        if late and not speaker.gone:
            self.complain(f"{speaker.name} waits for an answer to {late[0].call}")
            speaker.gone = True

    def answered(self, speaker: Speaker, asked: Asked, response: Response) -> None:
        """A client was answered; what was granted is a source of motion from now on."""
        call, error = asked.call, response.error
        if isinstance(error, dict) and error["code"] == "internal":
            self.complain(f"{call} failed: {error['message']!r}")
        if error is not None or speaker.gone:
            return
        now = self._time(asked)
        given = self._named(call)
        match call.method:
            case "move":
                self._grant(speaker, str(given["joint"]), given, now)
            case "group_command":
                self._grant(speaker, str(table(response.result)["active"]), given, now)
            case "stop":
                self._revoke(speaker, None, now)
            case "pause" | "torque" if given.get("on") is not False or call.method == "torque":
                self._revoke(speaker, given.get("joints"), now)
            case "go_home":
                self._revoke(speaker, given.get("joints"), now)
                goal = round(number(table(response.result), "goal"))
                self.homings[goal] = (speaker, _end(given.get("lease_s"), now, math.inf))

    def vanished(self, speaker: Speaker, now: float) -> None:
        """A client is gone, or was given up by the daemon."""
        self.left |= dict.fromkeys(speaker.names, now)
        for lease in self.leases:
            if lease.speaker is speaker:
                lease.end = min(lease.end, now + FAREWELL)
        for goal, (owner, end) in self.homings.items():
            if owner is speaker and end < math.inf:
                self.homings[goal] = (owner, min(end, now + FAREWELL))

    def _time(self, asked: Asked) -> float:
        return asked.done.get_loop().time()

    def _named(self, call: Call) -> Table:
        """Parameters by name, however they were given."""
        match call.params:
            case dict():
                return call.params
            case [dict() as named]:
                return named
            case list():
                names = [str(p["name"]) for p in self.api.methods.get(call.method, ())]
                return dict(zip(names, call.params, strict=False))
        return {}

    def _grant(self, speaker: Speaker, joint: str, given: Table, now: float) -> None:
        self.leases.append(Lease(speaker, joint, now, _end(given.get("lease_s"), now, 0.2)))

    def _revoke(self, speaker: Speaker, joints: Value, now: float) -> None:
        """Wishes end, but what another client was granted in the same tick may have come after this."""
        names = [joints] if isinstance(joints, str) else joints
        for lease in self.leases:
            before = lease.begin < now or lease.speaker is speaker
            if before and (names is None or (isinstance(names, list) and lease.joint in names)):
                lease.end = min(lease.end, now)

    # The servos' own truth.

    def told(self, servo: Servo, setting: Setting, now: float) -> None:
        """A servo is told something: if that arms it, its goal must be where it stands."""
        seen = next((s for s in self.seen.values() if s.servo is servo), None)
        if seen is None:
            return
        if setting.torque_on and not seen.on:
            off = abs(setting.goal - servo.position)
            self.note("pin", off)
            if off > PINNED:
                self.complain(f"{seen.name} was armed with its goal {off:.4f} rad from where it stands")
            if now - self.switched > ANSWERED:
                self.complain(f"{seen.name} was armed, and nobody asked")
            seen.may_move(now)
        seen.on = setting.torque_on

    def rebooted(self, servo: Servo) -> None:
        """A servo starts anew, limp."""
        for seen in self.seen.values():
            if seen.servo is servo:
                seen.on = False

    def injected(self, fault: str, joints: Sequence[int], on: bool, now: float) -> None:
        """The world changes: what was held up by force may move a little when it is let go."""
        for place, seen in enumerate(self.seen.values()):
            if place not in joints:
                continue
            if fault in ("stuck", "blocked") and not on:
                seen.may_move(now)
            if fault == "id_clash":
                seen.excused = on
                seen.may_move(now)


def _end(lease: Value, now: float, missing: float) -> float:
    """When a lease runs out (s); `missing`: what one that was not given is (s)."""
    return now + (min(float(lease), 2.0) if isinstance(lease, int | float) else missing)


def _moving(joint: Table) -> bool:
    sent = joint["sent"]
    return isinstance(sent, dict) and sent["kind"] != "stop"
