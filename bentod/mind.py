"""What the arm expects and how it helps: readings to predictions to wishes of unattended joints."""

import logging
import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace

from bentod import registry
from bentod.assist.composite import combining
from bentod.assist.help import OFF, Help
from bentod.assist.rewards import Rewards
from bentod.assist.timescales.choice import Choice
from bentod.config_learn import ARM, Learn
from bentod.config_tables import Assist
from bentod.contracts_assist import AssistSettings, OpenAssist, Situation
from bentod.control.groups import Groups
from bentod.errors import BadRequest, ConfigError, Refused
from bentod.frames import AssistFrame, Command, GroupFrame, JointSpec, LearnFrame, Value, Wishes
from bentod.inquiry import Inquiry, gvf_of
from bentod.known import Known
from bentod.learn.horde import HasTime, unhurried
from bentod.learn.predictor import Body, Predictor, position_at
from bentod.learn.questions import MOST
from bentod.learn.signals import Percept
from bentod.learn.tiles import TileCoder
from bentod.outlook import Expectation

_log = logging.getLogger(__name__)

NOBODY = AssistFrame(OFF, False, "The config has no [assist] table.")


@dataclass(frozen=True, slots=True)
class Helped:
    """What all assists ask for in one tick, and what is to be told of each."""

    wishes: Wishes
    frames: tuple[AssistFrame, ...]  # one at least


class Mind:
    """Learners and assist of the arm, either of which the config may leave out.

    Learning goes on in every mode that reads the joints: the arm is watched, whoever moves it. Before the
    servos are written only the timescale that the assist follows is updated; the others are afterwards, the
    shortest first. Those for which a tick has no time any more still predict, but learn nothing.
    """

    def __init__(
        self,
        specs: Sequence[JointSpec],
        rate_hz: float,
        groups: Groups,
        learn: Learn | None = None,
        assists: Sequence[Assist] = (),
        sites: Sequence[str] = (),
        open_assist: Callable[[str], OpenAssist] = registry.open_assist,
        classes: Sequence[str] = (),
    ) -> None:
        """`sites`: names of the muscle signals; `classes`: of recognised contractions.

        `open_assist`: finds the assist of a mode.

        Raises ConfigError: a question is not one.
        """
        self._open_assist = open_assist
        self.groups = groups
        self._names = tuple(spec.name for spec in specs)
        members = {group.name: [self._names[j] for j in group.joints] for group in groups}
        body = Body(specs, sites, members, rate_hz, classes)
        self._predictor = Predictor(body, learn) if learn else None
        self._timescales = learn.timescales if learn and learn.joints else ()
        seen = learn.representation if learn else ARM
        self._outlook = Expectation(self._predictor, self._names, self._timescales, seen)
        self._inquiry = Inquiry(self._predictor)
        self._situations: dict[str, Situation] = {}
        self._seen = seen
        self._helps = tuple(self._help(specs, rate_hz, table) for table in assists)
        self.rewards = Rewards(self._helps, [group.name for group in groups])
        """Where somebody says that they were pleased with the arm, or not."""
        self.known = Known(self._predictor, self._helps) if self._predictor else None
        """What can be kept of all that is learned, if anything learns."""
        self._rate_hz = rate_hz
        self._broken = ""
        self.budget = learn.budget / rate_hz if learn else 0.0
        """s from a tick's deadline, after which nothing is to be learned in it any more."""

    @property
    def predictor(self) -> Predictor | None:
        """What learns, if the config has such a table."""
        return self._predictor

    @property
    def broken(self) -> str:
        """Why learning is off for good; empty if it is not."""
        return self._broken

    @property
    def learners(self) -> Predictor:
        """What learns. Raises Refused: the config has no such table, or learning broke."""
        if self._predictor is None:
            raise Refused("the config has no [learn] table")
        if self._broken:
            raise Refused(self._broken)
        return self._predictor

    @property
    def units(self) -> int:
        """How many times a tick asks whether there is time to learn."""
        return len(self._predictor.horde.units) if self._predictor else 0

    @property
    def shed(self) -> int:
        """Updates of learners left out for lack of time, since the start."""
        return self._predictor.shed if self._predictor else 0

    def predict(self, percept: Percept, has_time: HasTime = unhurried) -> None:
        """Begin a tick: learn and predict what the assists follow."""
        followed = [
            position_at(self._names[joint], timescale)
            for help_ in self._helps
            for timescale in help_.follows(self._timescales)
            for joint in self.groups.group(help_.group).joints
        ]
        percept = replace(percept, rewards=self.rewards.take())
        followed += [name for help_ in self._helps for name in self._inquiry.needed(help_.group)]

        def see(predictor: Predictor) -> None:
            predictor.see(percept)
            if followed:
                predictor.step(has_time, followed)

        self._try(see)

    def learn(self, has_time: HasTime = unhurried) -> None:
        """Learn and predict the rest, from the reading that was last predicted from."""
        self._try(lambda predictor: predictor.step(has_time))

    def assist(self, percept: Percept, moving: Collection[int]) -> Helped:
        """What to ask of unattended joints while the operator moves the joints `moving`."""
        attended: dict[str, int | None] = {}
        for group in self.groups:
            moved = [joint for joint in (group.active, *group.joints) if joint in moving]
            attended[group.name] = moved[0] if moved else None
        return self.assist_beside(percept, attended)

    def assist_beside(self, percept: Percept, attended: Mapping[str, int | None]) -> Helped:
        """What to ask of the other joints while the operator moves `attended`, by group."""
        told = {group.name: group for group in percept.groups}
        wishes: dict[int, Command] = {}
        frames: list[AssistFrame] = []
        for help_ in self._helps:
            name = help_.group
            situation = self._situation(percept, told.get(name), name, attended.get(name))
            self._situations[name] = situation
            asked, frame = help_.wish(situation, self._broken)
            wishes = {**asked, **wishes}
            frames.append(frame)
        return Helped(wishes, tuple(frames) or (NOBODY,))

    def _situation(
        self, percept: Percept, told: GroupFrame | None, name: str, attended: int | None
    ) -> Situation:
        group = self.groups.group(name)
        return Situation(
            time=percept.state.time,
            rate_hz=self._rate_hz,
            joints=group.joints,
            active=self._names.index(told.active) if told else group.active,
            attended=attended,
            effort=told.effort if told else 0.0,
            together=told.together if told else False,
            state=percept.state,
            outlook=self._outlook,
            group=name,
        )

    def _try(self, act: Callable[[Predictor], None]) -> None:
        """Whatever learners do, control goes on without them: one that breaks is left alone from then on."""
        if self._predictor is None or self._broken:
            return
        try:
            act(self._predictor)
        except Exception as error:  # noqa: BLE001 -- see above
            self._broken = f"Learning broke and is off: {type(error).__name__}: {error}"
            _log.exception("learning broke and is off")

    def toggled(self, group: str, now: float) -> None:
        """The active joint of a group has changed."""
        self.rewards.toggled(group, now)

    def order(self, group: str) -> tuple[int, ...] | None:
        """In which order toggles go through a group, as of the last tick; None: as the config lists it."""
        situation = self._situations.get(group)
        return self._find(group).order(situation) if situation else None

    def offers_together(self, group: str) -> bool:
        """Whether all joints of a group may be selected at once, as of the last tick."""
        return any(help_.offers_together(self._broken) for help_ in self._helps if help_.group == group)

    def begun_anew(self) -> list[str]:
        """Questions whose learners diverged and began anew since the last call."""
        return self._predictor.begun_anew() if self._predictor and not self._broken else []

    def describe_gvfs(self) -> Value:
        """Every question and how it is answered. Raises Refused: nothing learns."""
        return list[Value](self.learners.describe())

    def add_gvf(self, table: Value, most: int = MOST) -> tuple[str, ...]:
        """Ask what a table like those of `learn.gvfs` asks, up to `most` questions; returns their names.

        Raises:
            Refused: nothing learns.
            BadRequest: it is not such a table, or cannot be asked.
        """
        return self.learners.add(gvf_of(table), most=most)

    def predictions(self, joint: int) -> dict[str, float]:
        """The newest predictions of one joint's position (rad), by timescale in ticks."""
        if self._predictor is None:
            return {}
        name, known = self._names[joint], self._predictor.newest
        found = {f"{t:g}": known(position_at(name, t)) for t in self._timescales}
        return {timescale: position for timescale, position in found.items() if not math.isnan(position)}

    def frame(self) -> LearnFrame:
        """What the learners say in this tick."""
        return self._predictor.frame() if self._predictor and not self._broken else LearnFrame()

    def describe(self, group: str | None = None) -> dict[str, Value]:
        """The settings of the assist of a group (None: the first) as clients see them."""
        return self._find(group).describe() if self._helps else {"mode": OFF}

    def change(self, changes: Mapping[str, Value], group: str | None = None) -> str:
        """Change some of the settings that `describe` shows; returns the name of the group.

        Raises:
            Refused: the config has no assist.
            BadRequest: a value is out of its bounds, or nobody predicts at that timescale.
        """
        if self._predictor is None or not self._helps:
            raise Refused("the config has no [assist] and [learn] tables")
        help_ = self._find(group)
        timescale = changes.get("timescale", help_.settings.timescale)
        if not isinstance(timescale, int | float) or timescale not in self._timescales:
            known = ", ".join(f"{t:g}" for t in self._timescales)
            word = f"{timescale:g}" if isinstance(timescale, int | float) else "such"
            raise BadRequest(f"nothing is predicted {word} steps ahead (timescales: {known})", "timescale")
        before = help_.describe()
        help_.change(changes)
        try:
            self._inquiry.ask(help_, self._joints_of(help_.group))
        except BadRequest:
            help_.change(before)
            raise
        return help_.group

    def _joints_of(self, group: str) -> list[str]:
        return [self._names[joint] for joint in self.groups.group(group).joints]

    def _find(self, group: str | None) -> Help:
        known = {help_.group: help_ for help_ in self._helps}
        if group is None:
            return self._helps[0]
        if group not in known:
            raise BadRequest(f"nothing helps with the group '{group}' (groups: {', '.join(known)})", "group")
        return known[group]

    def _help(self, specs: Sequence[JointSpec], rate_hz: float, table: Assist) -> Help:
        settings = AssistSettings(
            timescale=table.timescale,
            k=table.k,
            velocity_limit=table.velocity_limit_rad_s,
            manual=table.manual_after_toggle_s,
            options=dict(table.options),
            toggle_reward=table.toggle_reward,
            contact_reward=table.contact_reward,
        )
        joints = self.groups.group(table.group).joints
        choice = Choice(table.group, specs, joints, rate_hz, self._timescales, _postures, self._seen)
        help_ = Help(table.group, specs, rate_hz, settings, combining(self._open_assist), choice)
        try:
            options = dict[str, Value](table.options)
            help_.change({"mode": table.mode, "timescale_by": table.timescale_by, "options": options})
            self._inquiry.ask(help_, self._joints_of(table.group))
        except BadRequest as error:
            raise ConfigError(f"the assist of {table.group}: {error}") from error
        return help_


def _postures(dimensions: int) -> TileCoder:
    """What timescales are chosen from: eight tilings, a tile a quarter of each joint's range wide."""
    return TileCoder(dimensions, tilings=8, width=0.25, memory=512)
