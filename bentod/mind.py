"""What the arm expects and how it helps: readings to predictions to wishes of unattended joints."""

import logging
import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace

from bentod.assist.dpcc import Assistance, Dpcc, DpccSettings, at_timescale
from bentod.config_learn import Learn
from bentod.config_tables import Assist
from bentod.contracts import Features
from bentod.control.groups import Groups
from bentod.errors import BadRequest, Refused
from bentod.frames import AssistFrame, Freshness, JointSpec, Prediction, State, Value
from bentod.learn.horde import HasTime, Horde, Question, unhurried
from bentod.learn.representation import Representation

_log = logging.getLogger(__name__)


class _Predictor:
    """The learners over one representation, fed with fresh readings only."""

    def __init__(self, specs: Sequence[JointSpec], learn: Learn) -> None:
        names = [spec.name for spec in specs]
        self._seen = tuple(names.index(name) for name in learn.joints)
        self.timescales = learn.timescales
        asked = [names.index(name) for name in learn.predict or names]
        limits = [(specs[joint].minimum, specs[joint].maximum) for joint in self._seen]
        self._representation = Representation(
            limits, learn.tilings, memory=learn.memory, trace_decay=learn.trace_decay
        )
        questions = [Question(joint, timescale) for timescale in learn.timescales for joint in asked]
        self._horde = Horde(
            questions,
            self._representation.size,
            self._representation.active,
            [specs[question.joint].minimum for question in questions],
            learn.trace_lambda,
            learn.step_size,
        )
        self._arrived: tuple[Features, list[float]] | None = None
        self._first: float | None = None

    @property
    def shed(self) -> int:
        """Updates that were left out for lack of time; one is that of all joints at one timescale."""
        return self._horde.shed

    def step(
        self, state: State, gap: bool, first: float | None, has_time: HasTime
    ) -> tuple[Prediction, ...] | None:
        """Predictions at the timescale `first` (steps); None when a reading that they are made from is old.

        A joint that is only predicted teaches nothing while its reading is old: NaN says so to its learner.
        """
        fresh = [joint.freshness is Freshness.FRESH for joint in state.joints]
        seen = all(fresh[joint] for joint in self._seen)
        if gap or not seen:
            self._horde.cut()
        self._arrived = None
        if not seen:
            return None
        features = self._representation.features([state.joints[joint].position for joint in self._seen])
        positions = [
            joint.position if new else math.nan for joint, new in zip(state.joints, fresh, strict=True)
        ]
        self._arrived, self._first = (features, positions), first
        return self._horde.step(features, positions, has_time, [first] if first else [])

    @property
    def diverged(self) -> bool:
        """Whether a learner has ever had to begin anew."""
        return any(self._horde.resets)

    def rest(self, has_time: HasTime) -> tuple[Prediction, ...]:
        """Predictions from the same reading at all other timescales."""
        if self._arrived is None:
            return ()
        others = [timescale for timescale in self.timescales if timescale != self._first]
        return self._horde.step(*self._arrived, has_time, others)


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
    ) -> None:
        self._groups = groups
        self._names = tuple(spec.name for spec in specs)
        self._predictor = _Predictor(specs, learn) if learn else None
        self._group = assist.group if assist else ""
        self._dpcc = Dpcc(specs, rate_hz, _settings(assist, len(specs))) if assist else None
        self._predictions: dict[tuple[int, float], Prediction] = {}
        self._usable = False
        self._broken = ""
        self._diverged = False
        self.budget = learn.budget / rate_hz if learn else 0.0
        """s from a tick's deadline, after which nothing is to be learned in it any more."""

    @property
    def shed(self) -> int:
        """Updates of learners left out for lack of time, since the start."""
        return self._predictor.shed if self._predictor else 0

    def predict(self, state: State, gap: bool, has_time: HasTime = unhurried) -> None:
        """Learn and predict what the assist follows. `gap`: ticks were missed since the last reading."""
        first = self._dpcc.settings.timescale if self._dpcc else None
        self._usable = self._have(lambda predictor: predictor.step(state, gap, first, has_time))

    def learn(self, has_time: HasTime = unhurried) -> None:
        """Learn and predict the rest, from the reading that was last predicted from."""
        self._have(lambda predictor: predictor.rest(has_time))
        if self._predictor and self._predictor.diverged and not self._diverged:
            _log.warning("A learner was not finite any more, and began anew.")
        self._diverged = self._predictor is not None and self._predictor.diverged

    def assist(self, state: State, moving: Collection[int]) -> Assistance:
        """What to ask of unattended joints while the operator moves the joints `moving`."""
        if self._dpcc is None:
            return Assistance({}, AssistFrame("off", False, "The config has no [assist] table."))
        group = self._groups.group(self._group)
        attended = [joint for joint in (group.active, *group.joints) if joint in moving]
        return self.assist_beside(state, attended[0] if attended else None)

    def assist_beside(self, state: State, attended: int | None) -> Assistance:
        """What to ask of the other joints of the assist's group while the operator moves `attended`."""
        if self._dpcc is None:
            return Assistance({}, AssistFrame("off", False, "The config has no [assist] table."))
        name = "" if attended is None else self._names[attended]
        if self._broken:
            return Assistance({}, AssistFrame("off", False, self._broken, name))
        usable = self._predictions.values() if self._usable else ()
        expected = at_timescale(usable, self._dpcc.settings.timescale)
        positions = [joint.position for joint in state.joints]
        group = self._groups.group(self._group).joints
        helped = self._dpcc.wish(state.time, attended, group, positions, expected)
        return replace(helped, frame=replace(helped.frame, attended=name))

    def _have(self, predict: Callable[[_Predictor], tuple[Prediction, ...] | None]) -> bool:
        """Take in new predictions, if there are any. A learner that breaks is left alone from then on."""
        if self._predictor is None or self._broken:
            return False
        try:
            answers = predict(self._predictor)
        except Exception as error:  # noqa: BLE001 -- whatever a learner does, control goes on without it
            self._broken = f"Learning broke and is off: {type(error).__name__}: {error}"
            _log.exception("learning broke and is off")
            return False
        self._predictions.update({(answer.joint, answer.timescale): answer for answer in answers or ()})
        return answers is not None

    def toggled(self, now: float) -> None:
        """The active joint of a group has changed."""
        if self._dpcc:
            self._dpcc.toggled(now)

    def predictions(self, joint: int) -> dict[str, float]:
        """The newest predictions of one joint (rad), by timescale in steps."""
        asked = [(joint, timescale) for timescale in self._predictor.timescales] if self._predictor else []
        known = [self._predictions[question] for question in asked if question in self._predictions]
        return {f"{prediction.timescale:g}": prediction.position for prediction in known}

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
        if timescale not in self._predictor.timescales:
            known = ", ".join(f"{t:g}" for t in self._predictor.timescales)
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
