"""Methods that steer groups, muscles and assist, or break a simulated arm; clients read the docstrings."""

from typing import Annotated

from bentod.contracts_assist import TIMESCALE_BY
from bentod.control.leases import Holder
from bentod.errors import Refused
from bentod.frames import Value
from bentod.serve.params import Flag, Free, Number, Text
from bentod.serve.room import GroupName, Joint, Lease, Room
from bentod.serve.session import Session

HelpedGroup = Annotated[str | None, Text("a group that has an assist; nil for the first")]


class TuningMethods:
    """Handlers of what can be set while the arm is in use."""

    def __init__(self, room: Room) -> None:
        self._room = room

    async def group_list(self, session: Session) -> Value:
        """The joint groups, their joints, which one is active, and whether all are selected together."""
        return (await self._room.inbox.ask(lambda desk: desk.describe_groups())).result

    async def group_command(
        self,
        session: Session,
        group: GroupName,
        effort: Annotated[float, Number("", -1, 1, "share of the active joint's top speed")],
        lease_s: Lease = 0.2,
    ) -> Value:
        """Move a group's active joint at a share of its top speed, as muscles would.

        While all joints are selected together, it pushes them on along the learned path, or pulls them back.
        """
        holder = Holder(session.id, session.client)
        self._room.attach(session)
        answer = await self._room.inbox.ask(lambda desk: desk.group_command(group, effort, holder, lease_s))
        return self._room.active(answer.result)

    async def group_toggle(
        self,
        session: Session,
        group: GroupName,
        direction: Annotated[str, Text("which way", choices=("forward", "backward"))] = "forward",
    ) -> Value:
        """Select the next or the previous joint of a group, or all together where an assist offers that."""
        steps = 1 if direction == "forward" else -1
        answer = await self._room.inbox.ask(lambda desk: desk.toggle(group, steps, session.client))
        return self._room.active(answer.result)

    async def group_activate(self, session: Session, group: GroupName, joint: Joint) -> Value:
        """Make a joint the active one of its group."""
        answer = await self._room.inbox.ask(lambda desk: desk.activate(group, joint, session.client))
        return self._room.active(answer.result)

    async def emg_get(self, session: Session) -> Value:
        """The EMG sites and their parameters, what drives which group, and whether EMG is paused."""
        return (await self._room.inbox.ask(lambda desk: desk.muscles.describe())).result

    async def emg_levels(self, session: Session) -> Value:
        """How loud each site is now (V after gain), and why leads are taken to be off."""
        return (await self._room.inbox.ask(lambda desk: desk.muscles.levels())).result

    async def emg_set(
        self,
        session: Session,
        site: Annotated[str, Text("site name")],
        gain: Annotated[float | None, Number("", 1e-6, 1e6, "amplification")] = None,
        threshold_v: Annotated[float | None, Number("V", 0, 10, "effort is 0 up to here")] = None,
        max_v: Annotated[float | None, Number("V", 1e-9, 10, "effort is 1 from here on")] = None,
        release: Annotated[
            float | None, Number("", 0.1, 1, "share of the threshold below which it ends")
        ] = None,
    ) -> Value:
        """Change a site's parameters from the next tick on; what is left out stays."""
        await self._room.inbox.ask(
            lambda desk: desk.muscles.change_site(site, gain, threshold_v, max_v, release)
        )
        return None

    async def emg_pause(
        self, session: Session, on: Annotated[bool, Flag("false lets the muscles drive again")] = True
    ) -> Value:
        """Let the muscles drive nothing; everything else goes on."""
        await self._room.inbox.ask(lambda desk: desk.pause_muscles(on))
        return None

    async def assist_get(self, session: Session, group: HelpedGroup = None) -> Value:
        """The settings of what helps with a group, and what it has found out."""
        return (await self._room.inbox.ask(lambda desk: desk.mind.describe(group))).result

    async def assist_set(
        self,
        session: Session,
        mode: Annotated[str | None, Text("which assist, e.g. off, or dpcc+adaptive_switching", 131)] = None,
        k: Annotated[float | None, Number("", 1e-4, 0.9999, "share of the way in one tick")] = None,
        timescale: Annotated[float | None, Number("ticks", 1, 10_000, "which prediction to follow")] = None,
        velocity_limit_rad_s: Annotated[
            float | None, Number("rad/s", 1e-3, 10, "top speed it may use")
        ] = None,
        manual_after_toggle_s: Annotated[float | None, Number("s", 0, 10, "no assist after a toggle")] = None,
        timescale_by: Annotated[
            str | None, Text("how another timescale is found", choices=TIMESCALE_BY)
        ] = None,
        toggle_reward: Annotated[float | None, Number("", -10, 10, "what a toggle is worth to that")] = None,
        contact_reward: Annotated[float | None, Number("", -10, 10, "what a mark 'contact' is worth")] = None,
        group: HelpedGroup = None,
        options: Annotated[Value, Free("a table of the mode's own settings; nil leaves them")] = None,
    ) -> Value:
        """Change the settings of what helps with a group, from the next tick on; what is left out stays."""
        given = {
            "mode": mode,
            "k": k,
            "timescale": timescale,
            "velocity_limit_rad_s": velocity_limit_rad_s,
            "manual_after_toggle_s": manual_after_toggle_s,
            "timescale_by": timescale_by,
            "toggle_reward": toggle_reward,
            "contact_reward": contact_reward,
            "options": options,
        }
        changes: dict[str, Value] = {name: value for name, value in given.items() if value is not None}
        await self._room.inbox.ask(lambda desk: desk.change_assist(changes, group))
        return None

    async def reward(
        self,
        session: Session,
        value: Annotated[float, Number("", -10, 10, "above 0: pleased; below 0: not")],
        group: Annotated[str | None, Text("group name; nil for all")] = None,
    ) -> Value:
        """Tell the arm how well it did just now, as with a button for good or bad."""
        await self._room.inbox.ask(lambda desk: desk.reward(value, session.client, group))
        return None

    async def inject(
        self,
        session: Session,
        fault: Annotated[str, Text("one of get_info's faults")],
        joint: Annotated[str | None, Text("joint name, for faults of one joint")] = None,
        on: Annotated[bool, Flag("false mends")] = True,
    ) -> Value:
        """Break or mend a simulated arm on purpose; real arms refuse."""
        if self._room.injector is None:
            raise Refused("this arm is not simulated; only simulated faults can be injected")
        self._room.injector.inject(fault, None if joint is None else self._room.index(joint), on)
        return None
