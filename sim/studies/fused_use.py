"""A simulated wearer moves three joints by six movements, with and without predictions of what is next."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import nan

import numpy as np
from numpy.typing import NDArray

from bentod.config_adaptation import Fusion
from bentod.config_recognition import RecognisedClass, Recognition
from bentod.emg.adapt.normal import Normal
from bentod.emg.classify.deciding import Decider, Deciding
from bentod.emg.features.feature_list import FeatureList
from bentod.emg.fusing import Foreseen, fuse
from bentod.emg.recognition import REST, Table
from bentod.foresight import Foresight, with_use
from bentod.frames import EmgFrame, Freshness, JointSpec, JointState, State
from bentod.learn.horde import unhurried
from bentod.learn.predictor import Body, Predictor
from bentod.learn.signals import Percept
from bentod.recognition_frame import RecognitionFrame
from sim.movements import MOVEMENTS, Prompted
from sim.studies.adaptation import RATE_HZ, STEP_S, session, trained

JOINTS = ("wrist_flexion", "wrist_deviation", "wrist_rotation")
MOVES: Mapping[str, tuple[int, float]] = {
    label: (place // 2, 1.0 - 2 * (place % 2)) for place, label in enumerate(MOVEMENTS)
}
"""The joint that a movement moves, and which way."""

SPEED = 0.6
"""Rad/s at full effort."""

CYCLE = ((0, 0.5), (2, 0.6), (1, 0.3), (0, -0.2), (2, -0.4), (1, -0.3))
"""The predictable task: which joint goes where (rad), again and again. The other one draws both at random."""

NEAR = 0.06
MIXED = 0.4
"""Share of the windows of a movement that have something of another one in them: 30 to 70 %."""

PAUSE, REACTION = 8, 8
"""Windows of rest between movements, and until a wearer sees that something else moves."""


@dataclass(frozen=True, slots=True)
class Person:
    """Windows of one person, and what was trained on others of theirs."""

    classifier: Normal
    rows: Mapping[str, Table]  # in order of time, by class


def person(number: int, electrodes: int = 4) -> Person:
    """One on another occasion of the same day."""
    features = FeatureList("robust", electrodes, RATE_HZ)
    usual = {"person": number, "electrodes": electrodes, "hold_s": 2.0, "rest_s": 2.0}
    known = session(features, Prompted.model_validate({**usual, "session": 10 * number, "repetitions": 4}))
    later = {"session": 10 * number + 1, "repetitions": 8}
    use = session(features, Prompted.model_validate({**usual, **later}))
    return Person(trained(known), {label: use.rows[use.labels == label] for label in (REST, *MOVEMENTS)})


@dataclass(frozen=True, slots=True)
class Use:
    """What came of it."""

    right: float  # share of windows with a movement meant, in which it was decided
    wrong: float  # share of them in which another movement was decided
    steps: int  # of the task that were done
    owed: float  # share of the decisions that a prediction changed


class Arm:
    """Three joints that go where they are told."""

    def __init__(self) -> None:
        self.angles = np.zeros(len(JOINTS))

    def move(self, label: str) -> None:
        """For the time of one window."""
        if label != REST:
            joint, way = MOVES[label]
            self.angles[joint] = np.clip(self.angles[joint] + way * SPEED * STEP_S, -1, 1)


class Operator:
    """Does one step of the task after the other, puts right what went wrong, and lets go on seeing it."""

    def __init__(self, predictable: bool, random: np.random.Generator) -> None:
        self.steps = 0
        self._predictable, self._random = predictable, random
        self._goal = CYCLE[0] if predictable else self._drawn(np.zeros(len(JOINTS)))
        self._wrong = self._pause = 0

    def mean(self, angles: NDArray[np.float64]) -> str:
        """What is meant in this window."""
        if self._pause:
            self._pause -= 1
            return REST
        joint, target = self._goal
        if abs(target - angles[joint]) < NEAR:
            self.steps += 1
            self._goal = CYCLE[self.steps % len(CYCLE)] if self._predictable else self._drawn(angles)
            self._pause = PAUSE
            return REST
        return MOVEMENTS[2 * joint + (target < angles[joint])]

    def see(self, meant: str, label: str) -> None:
        """What the arm does."""
        self._wrong = self._wrong + 1 if label not in (meant, REST) else 0
        if self._wrong >= REACTION:
            self._wrong, self._pause = 0, PAUSE

    def _drawn(self, angles: NDArray[np.float64]) -> tuple[int, float]:
        while True:
            joint, target = int(self._random.integers(len(JOINTS))), float(self._random.uniform(-0.6, 0.6))
            if abs(target - angles[joint]) > 4 * NEAR:
                return joint, target


class Signals:
    """Windows of what is meant, in runs as they were made."""

    def __init__(self, rows: Mapping[str, Table], random: np.random.Generator) -> None:
        self._rows, self._random = rows, random
        self._at = dict.fromkeys(rows, 0)
        self._last = ""

    def of(self, meant: str) -> Table:
        """The next one, shape (1, columns)."""
        count = len(self._rows[meant])
        if meant != self._last:
            self._at[meant], self._last = int(self._random.integers(count)), meant
        self._at[meant] = (self._at[meant] + 1) % count
        row = self._rows[meant][self._at[meant]]
        if meant != REST and self._random.random() < MIXED:
            other = self._rows[str(self._random.choice(MOVEMENTS))]
            share = self._random.uniform(0.3, 0.7)
            row = (1 - share) * row + share * other[int(self._random.integers(len(other)))]
        return np.asarray(row[np.newaxis])


def used(who: Person, predictable: bool, fusion: Fusion | None, seed: int, minutes: float = 4.0) -> Use:
    """A session; the second half counts."""
    operator = Operator(predictable, np.random.default_rng([seed, 1]))
    signals, arm = Signals(who.rows, np.random.default_rng([seed, 2])), Arm()
    mind = Mind(fusion) if fusion else None
    decider = Decider(who.classifier.labels, {}, Deciding(reject_below=0.5, proportional=False))
    labels = who.classifier.labels
    count = round(60 * minutes / STEP_S)
    tally = np.zeros(4)
    for place in range(count):
        meant = operator.mean(arm.angles)
        alone = who.classifier.probabilities(signals.of(meant))[0].tolist()
        fused = fuse(labels, alone, mind.foreseen() if mind else Foreseen({}, 0.0), fusion or Fusion())
        shares = list(fused.likelihoods.values()) if fused.changed else alone
        label = decider.decide(place, shares, 1.0).label
        arm.move(label)
        operator.see(meant, label)
        if mind:
            mind.see(place, arm.angles, dict(zip(labels, alone, strict=True)))
        if place >= count // 2 and meant != REST:
            tally += (1, label == meant, label not in (meant, REST), fused.changed)
        if place == count // 2:
            half = operator.steps
    windows, right, wrong, changed = tally.tolist()
    return Use(right / windows, wrong / windows, operator.steps - half, changed / windows)


class Mind:
    """The daemon's learners, one tick a window."""

    def __init__(self, fusion: Fusion) -> None:
        specs = [JointSpec(name, -1.0, 1.0, SPEED, 0.0, {}) for name in JOINTS]
        classes = [
            RecognisedClass(name=label, group="wrist", moves={JOINTS[joint]: way})
            for label, (joint, way) in MOVES.items()
        ]
        asked = Recognition(classes=tuple(classes), fusion=fusion)
        learn = with_use(None, asked, 1 / STEP_S)
        body = Body(specs, (), {}, 1 / STEP_S, MOVEMENTS)
        self._predictor = Predictor(body, learn) if learn else None
        self.foreseen = Foresight(lambda: self._predictor, MOVEMENTS)

    def see(self, tick: int, angles: NDArray[np.float64], likelihoods: Mapping[str, float]) -> None:
        """One tick."""
        joints = tuple(
            JointState(float(angle), 0.0, 0.0, 12.0, 40.0, 0.0, Freshness.FRESH) for angle in angles
        )
        likely = max(likelihoods, key=likelihoods.__getitem__)
        told = RecognitionFrame(tick, likely, nan, likelihoods, likely, False, "", "model", "")
        emg = EmgFrame(True, False, "", tick, 0.0, 0, {}, 0, told)
        if self._predictor:
            self._predictor.see(Percept(tick, tick * STEP_S, False, State(tick * STEP_S, joints), emg, ()))
            self._predictor.step(unhurried)
