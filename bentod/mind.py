"""What the arm expects and how it helps: readings to predictions to wishes of unattended joints."""

import logging
import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace

from pydantic import ValidationError

from bentod.assist.dpcc import Assistance, Dpcc, DpccSettings
from bentod.config_errors import explain
from bentod.config_learn import Gvf, Learn
from bentod.config_tables import Assist
from bentod.control.groups import Groups
from bentod.errors import BadRequest, Refused
from bentod.frames import AssistFrame, JointSpec, LearnFrame, State, Value
from bentod.learn.horde import HasTime, unhurried
from bentod.learn.predictor import Body, Predictor, position_at
from bentod.learn.signals import Percept

_log = logging.getLogger(__name__)


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
        assist: Assist | None = None,
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
        self._group = assist.group if assist else ""
        self._dpcc = Dpcc(specs, rate_hz, _settings(assist, len(specs))) if assist else None
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
        """Begin a tick: learn and predict what the assist follows."""

        def see(predictor: Predictor) -> None:
            predictor.see(percept)
            if self._dpcc:
                followed = self._dpcc.settings.timescale
                predictor.step(has_time, [position_at(name, followed) for name in self._names])

        self._try(see)

    def learn(self, has_time: HasTime = unhurried) -> None:
        """Learn and predict the rest, from the reading that was last predicted from."""
        self._try(lambda predictor: predictor.step(has_time))

    def assist(self, state: State, moving: Collection[int]) -> Assistance:
        """What to ask of unattended joints while the operator moves the joints `moving`."""
        if self._dpcc is None:
            return Assistance({}, AssistFrame("off", False, "The config has no [assist] table."))
        group = self.groups.group(self._group)
        attended = [joint for joint in (group.active, *group.joints) if joint in moving]
        return self.assist_beside(state, attended[0] if attended else None)

    def assist_beside(self, state: State, attended: int | None) -> Assistance:
        """What to ask of the other joints of the assist's group while the operator moves `attended`."""
        if self._dpcc is None:
            return Assistance({}, AssistFrame("off", False, "The config has no [assist] table."))
        name = "" if attended is None else self._names[attended]
        if self._broken:
            return Assistance({}, AssistFrame("off", False, self._broken, name))
        expected = self._expected(self._dpcc.settings.timescale)
        positions = [joint.position for joint in state.joints]
        group = self.groups.group(self._group).joints
        helped = self._dpcc.wish(state.time, attended, group, positions, expected)
        return replace(helped, frame=replace(helped.frame, attended=name))

    def _expected(self, timescale: float) -> dict[int, float]:
        """Where joints are expected (rad), by index: what was predicted in this tick, and not before."""
        if self._predictor is None:
            return {}
        fresh = self._predictor.fresh
        found = {j: fresh(position_at(name, timescale)) for j, name in enumerate(self._names)}
        return {joint: position for joint, position in found.items() if math.isfinite(position)}

    def _try(self, act: Callable[[Predictor], None]) -> None:
        """Whatever learners do, control goes on without them: one that breaks is left alone from then on."""
        if self._predictor is None or self._broken:
            return
        try:
            act(self._predictor)
        except Exception as error:  # noqa: BLE001 -- see above
            self._broken = f"Learning broke and is off: {type(error).__name__}: {error}"
            _log.exception("learning broke and is off")

    def toggled(self, now: float) -> None:
        """The active joint of a group has changed."""
        if self._dpcc:
            self._dpcc.toggled(now)

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

    def describe(self) -> dict[str, Value]:
        """The assist's parameters as clients see them."""
        if self._dpcc is None:
            return {"mode": "off"}
        settings = self._dpcc.settings
        return {
            "mode": "dpcc" if settings.enabled else "off",
            "group": self._group,
            "timescale": settings.timescale,
            "k": settings.k,
            "velocity_limit_rad_s": max(settings.velocity_limits.values()),
            "manual_after_toggle_s": settings.manual,
        }

    def change(self, changes: Mapping[str, float | str]) -> None:
        """Change some of the parameters that `describe` shows.

        Raises:
            Refused: the config has no assist.
            BadRequest: a value is out of its bounds, or nobody predicts at that timescale.
        """
        if self._dpcc is None or self._predictor is None:
            raise Refused("the config has no [assist] and [learn] tables")
        settings = self._dpcc.settings
        timescale = float(changes.get("timescale", settings.timescale))
        if timescale not in self._timescales:
            known = ", ".join(f"{t:g}" for t in self._timescales)
            raise BadRequest(
                f"nothing is predicted {timescale:g} steps ahead (timescales: {known})", "timescale"
            )
        limits = settings.velocity_limits
        if "velocity_limit_rad_s" in changes:
            limits = dict.fromkeys(limits, float(changes["velocity_limit_rad_s"]))
        self._dpcc.settings = replace(
            settings,
            enabled=changes.get("mode", "dpcc" if settings.enabled else "off") == "dpcc",
            timescale=timescale,
            k=float(changes.get("k", settings.k)),
            velocity_limits=limits,
            manual=float(changes.get("manual_after_toggle_s", settings.manual)),
        )


def _settings(assist: Assist, joints: int) -> DpccSettings:
    return DpccSettings(
        enabled=assist.mode == "dpcc",
        timescale=assist.timescale,
        k=assist.k,
        velocity_limits=dict.fromkeys(range(joints), assist.velocity_limit_rad_s),
        manual=assist.manual_after_toggle_s,
    )
