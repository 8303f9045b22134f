"""What the arm expects and how it helps: readings to predictions to wishes of unattended joints."""

import logging
import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass

from pydantic import ValidationError

from bentod import registry
from bentod.assist.help import OFF, Help
from bentod.config_errors import explain
from bentod.config_learn import Gvf, Learn
from bentod.config_tables import Assist
from bentod.contracts_assist import AssistSettings, Situation
from bentod.control.groups import Groups
from bentod.errors import BadRequest, ConfigError, Refused
from bentod.frames import AssistFrame, Command, GroupFrame, JointSpec, LearnFrame, Value, Wishes
from bentod.learn.horde import HasTime, unhurried
from bentod.learn.predictor import Body, Predictor, position_at
from bentod.learn.signals import Percept
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
    ) -> None:
        """`sites`: names of the muscle signals. Raises ConfigError: a question is not one."""
        self.groups = groups
        self._names = tuple(spec.name for spec in specs)
        body = Body(
            specs, sites, {group.name: [self._names[j] for j in group.joints] for group in groups}, rate_hz
        )
        self._predictor = Predictor(body, learn) if learn else None
        self._timescales = learn.timescales if learn and learn.joints else ()
        self._outlook = Expectation(self._predictor, self._names, self._timescales)
        self._helps = tuple(self._help(specs, rate_hz, table) for table in assists)
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
        for help_ in self._helps:
            if help_.group == group:
                help_.toggled(now)

    def begun_anew(self) -> list[str]:
        """Questions whose learners diverged and began anew since the last call."""
        return self._predictor.begun_anew() if self._predictor and not self._broken else []

    def describe_gvfs(self) -> Value:
        """Every question and how it is answered. Raises Refused: nothing learns."""
        return list[Value](self.learners.describe())

    def add_gvf(self, table: Value) -> tuple[str, ...]:
        """Ask what a table like those of `learn.gvfs` asks; returns the names of the questions.

        Raises:
            Refused: nothing learns.
            BadRequest: it is not such a table, or cannot be asked.
        """
        learners = self.learners
        try:
            gvf = Gvf.model_validate(table)
        except ValidationError as error:
            raise BadRequest("; ".join(explain(error, Gvf, ("gvf",))), "gvf") from error
        return learners.add(gvf)

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
            raise BadRequest(
                f"nothing is predicted {word} steps ahead (timescales: {known})", "timescale"
            )
        help_.change(changes)
        return help_.group

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
        )
        help_ = Help(table.group, specs, rate_hz, settings, registry.open_assist)
        try:
            help_.change({"mode": table.mode, "options": dict[str, Value](table.options)})
        except BadRequest as error:
            raise ConfigError(f"the assist of {table.group}: {error}") from error
        return help_
