"""Methods that look at the arm and move it; each docstring is what clients read."""

from collections.abc import Mapping
from importlib.metadata import version
from typing import Annotated

from bentod.control.arbiter import OPERATORS
from bentod.control.grips import Hold
from bentod.control.leases import Holder
from bentod.desk import Desk
from bentod.errors import BadRequest, Refused
from bentod.frames import Command, JointSpec, Mode, Position, Stop, Value, Velocity
from bentod.messages import Packed, pack
from bentod.serve.params import Flag, Number, Text
from bentod.serve.room import Joint, Joints, Lease, Room
from bentod.serve.session import Session, Topic

Speed = Annotated[
    float | None, Number("rad/s", -10, 10, "signed velocity, or top speed towards the position")
]
Angle = Annotated[float | None, Number("rad", -6.3, 6.3, "position to go to, within the joint's limits")]
Goal = Annotated[int | None, Number("", 1, 2**53, "the goal that is renewed; no other is begun")]
GoalLease = Annotated[
    float | None, Number("s", 0.05, 10, "cancelled this long after the last call that renews it; nil: never")
]

RESERVED = frozenset(
    {*Mode, *OPERATORS, "client", "home", "assist", "dpcc", "operator", "observer", "everyone", "nobody"}
    | {"the wearer", "wearer", "the daemon", "daemon", "the end of the daemon", "bentod", "the arm", "root"}
    | {"the joystick"}
)
"""Names that frames, events and the log give to others than clients."""

_IN = "this connection has been let in already, as {}"

_VERSION = version("bentod")
"""Looked up once: it takes longer than all the rest of an answer."""


TOPICS: Mapping[str, Topic] = {"state": "state", "events": "events", "emg": "emg"}


class ArmMethods:
    """Handlers of what an arm is and does."""

    def __init__(self, room: Room) -> None:
        self._room = room
        self._info: Packed | None = None
        self._injector = room.injector

    async def hello(self, session: Session, name: Annotated[str, Text("who you are", 32)]) -> Value:
        """Give this connection a name, which others see when it moves the arm.

        Returns the connection's number and its role.
        """
        if not name.isprintable():  # it is shown on terminals, which obey what is not
            raise BadRequest("name has characters that cannot be printed.", "name")
        plain = " ".join(name.casefold().split())
        if not plain or plain in RESERVED:  # who moves or stops the arm must not be in doubt
            raise BadRequest(f"name = '{name}' is nobody's: it is empty, or the arm's own word.", "name")
        session.client = " ".join(name.split())
        return {"session": session.id, "role": session.peer.role}

    async def challenge(self, session: Session) -> Value:
        """Over TCP, the first request: returns the nonce that a proof is for. Refused anywhere else."""
        raise Refused(_IN.format(session.peer.role))

    async def authenticate(
        self,
        session: Session,
        proof: Annotated[str | None, Text("hex of HMAC-SHA256 of the nonce, keyed with the token")] = None,
        token: Annotated[str | None, Text("with TLS, the token itself", secret=True)] = None,
    ) -> Value:
        """Over TCP, before all else: say who you are; returns your role. Refused anywhere else."""
        raise Refused(_IN.format(session.peer.role), "proof")

    async def list_clients(self, session: Session) -> Value:
        """Who is connected: name, user or address, role, and what each was too slow for."""
        return [client.describe() for client in self._room.sessions()]

    async def get_info(self, session: Session) -> Packed:
        """What does not change while the daemon runs: version, arm, joints with limits, groups."""
        if self._info is None or self._room.injector is not self._injector:
            self._injector = self._room.injector
            self._info = Packed(pack(self._describe()))
        return self._info

    def _describe(self) -> Value:
        about = self._room.about
        return {
            "version": _VERSION,
            "arm": about.arm,
            "driver": about.driver,
            "rate_hz": about.rate_hz,
            "joints": [
                {
                    "name": joint.name,
                    "min_rad": joint.minimum,
                    "max_rad": joint.maximum,
                    "max_velocity_rad_s": joint.max_velocity,
                    "home_rad": joint.home,
                    "warm_c": joint.bounds.warm,
                    "hot_c": joint.bounds.hot,
                }
                for joint in about.joints
            ],
            "groups": {name: list(joints) for name, joints in about.groups.items()},
            "emg": about.emg,
            "lease_max_s": about.lease_max,
            "voice": dict(about.voice),
            "faults": list(self._room.injector.faults()) if self._room.injector else [],
        }

    async def get_state(self, session: Session) -> Packed:
        """The frame of the last tick: everything that was read, asked, sent and expected, as one message."""
        if self._room.newest is None:  # a client may come before the first tick, or be the reason for it
            return self._room.packed((await self._room.inbox.ask(lambda desk: None)).frame)
        return self._room.packed(self._room.newest)

    async def subscribe(
        self,
        session: Session,
        topic: Annotated[str, Text("what to send", choices=tuple(TOPICS))],
        rate_hz: Annotated[float, Number("Hz", 0.1, 500, "at most this many frames a second")] = 30.0,
    ) -> Value:
        """Send notifications: "state" at the chosen rate, "event" with each event, "emg" with all samples.

        A client that reads too slowly misses frames; it never gets old ones and never delays the arm.
        """
        session.subscribe(TOPICS[topic], rate_hz)
        return None

    async def unsubscribe(
        self, session: Session, topic: Annotated[str, Text("what to end", choices=tuple(TOPICS))]
    ) -> Value:
        """Send no more of a topic."""
        session.unsubscribe(TOPICS[topic])
        return None

    async def stop(self, session: Session) -> Value:
        """Stop every joint at once and pause the arm. Never refused."""
        await self._room.inbox.stop(session.client)
        return None

    async def pause(
        self, session: Session, joints: Joints = None, on: Annotated[bool, Flag("false releases")] = True
    ) -> Value:
        """Pause joints: they stop, hold, and ignore all wishes but `go_home` until they are released."""
        await self._room.inbox.ask(lambda desk: desk.pause(desk.select(joints), on))
        return None

    async def torque(
        self, session: Session, joints: Joints = None, on: Annotated[bool, Flag("false makes limp")] = True
    ) -> Value:
        """Switch torque, which also pauses. A joint is pinned where it is before it gets torque.

        An error means that a servo did not confirm; the fault in the state says which.
        """
        frame = (await self._room.inbox.ask(lambda desk: desk.torque(desk.select(joints), on))).frame
        asked = [joints] if isinstance(joints, str) else joints
        wrong = [j.name for j in frame.joints if (asked is None or j.name in asked) and j.torque is not on]
        if wrong:
            raise Refused(
                f"torque is not {'on' if on else 'off'} on {', '.join(wrong)}: {frame.fault}", "joints"
            )
        return None

    async def clear_fault(self, session: Session) -> Value:
        """Clear a latched fault whose cause is gone. Joints stay paused; releasing them is up to you.

        Servos with errors are told to clear them first, as their model allows, and are limp afterwards; an
        error says what they need besides, e.g. a power cycle.
        """
        await self._room.inbox.ask(lambda desk: desk.clear_fault())
        while (why := (await self._room.inbox.ask(lambda desk: desk.uncleared())).result) is None:
            continue  # servos reboot; each question takes a tick
        if why:
            raise Refused(why)
        return None

    async def go_home(
        self, session: Session, joints: Joints = None, lease_s: GoalLease = None, goal: Goal = None
    ) -> Value:
        """Send joints home as a goal; returns its number. Events "goal" tell its progress and its end.

        Paused joints go home undisturbed and are paused again there. Released joints go home too, but the
        wearer's first sign, another wish, `stop` or `pause` cancels the goal. With a lease it is also
        cancelled when its client is gone, or silent for that long: the same call renews it, and returns the
        same number; with that number as `goal` it never begins another. What was cancelled is not begun anew
        by renewing it: be silent for one lease first.
        """
        holder = Holder(session.id, session.client)
        hold = Hold(holder, lease_s, goal) if lease_s else None
        self._room.attach(session)
        answer = await self._room.inbox.ask(lambda desk: desk.go_home(desk.select(joints), hold))
        return {"goal": answer.result}

    async def go_home_cancel(self, session: Session) -> Value:
        """Cancel the goal under way; joints are then as they were before it. Returns whether there was one.

        Whoever held the goal with a lease and cancels it may ask for another at once.
        """
        return (await self._room.inbox.ask(lambda desk: _cancelled(desk, session))).result

    async def move(
        self,
        session: Session,
        joint: Joint,
        velocity: Speed = None,
        position: Angle = None,
        lease_s: Lease = 0.2,
    ) -> Value:
        """Move one joint: at a velocity, to a position, or to a position at a speed; a speed of 0 holds it.

        The wish ends with its lease or with the connection; call again to renew it. One client at a time.
        """
        index = self._room.index(joint)
        command = _command(self._room.about.joints[index], velocity, position)
        holder = Holder(session.id, session.client)
        self._room.attach(session)
        await self._room.inbox.ask(lambda desk: desk.move(index, command, holder, lease_s))
        return None


def _cancelled(desk: Desk, session: Session) -> bool:
    running = desk.goals.running
    desk.goals.cancel(f"cancelled by {session.client}")
    desk.goals.let_go(session.id, "it was let go")
    return running


def _command(spec: JointSpec, velocity: float | None, position: float | None) -> Command:
    if velocity is None and position is None:
        raise BadRequest("move needs a velocity, a position or both", "velocity")
    if velocity is not None and abs(velocity) > spec.max_velocity:
        raise BadRequest(
            f"velocity = {velocity:g} rad/s is beyond {spec.name}'s maximum, {spec.max_velocity:g} rad/s",
            "velocity",
        )
    if position is None:
        return Velocity(velocity) if velocity else Stop()
    if not spec.minimum <= position <= spec.maximum:
        raise BadRequest(
            f"position = {position:g} rad is outside {spec.name}'s limits, "
            f"{spec.minimum:g} to {spec.maximum:g} rad",
            "position",
        )
    if velocity == 0:
        return Stop()
    return Position(position, spec.max_velocity if velocity is None else abs(velocity))
