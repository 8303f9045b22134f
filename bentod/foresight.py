"""What is predicted of the classes of muscle signals: the questions, and the answers for recognition."""

import math
from collections.abc import Callable, Sequence

from bentod.config_learn import Gvf, Learn, RepresentationTable, Tiles
from bentod.config_recognition import Recognition
from bentod.emg.fusing import Foreseen, fuse
from bentod.emg.recognition import Fuse, Fused
from bentod.learn.expression_nodes import name_text
from bentod.learn.predictor import Predictor
from bentod.learn.signals import class_signal

REPRESENTATION = "use"

PAST_S = 1.0
"""How far back what was recognised is remembered, by a fading trace."""

TILINGS, WIDTH, MEMORY = 16, 0.2, 8192
"""A tile is a fifth of a joint's range; what is alike in posture (and past) is learned together."""


def question(label: str) -> str:
    """The name of the question how much a class will be used."""
    return f"use.{label.replace(' ', '_')}"


def with_use(learn: Learn | None, recognition: Recognition, rate_hz: float) -> Learn | None:
    """The same, and the use of each class if the config asks for fusion. `rate_hz`: of the tick.

    What is to come is what the classifier alone says, before any prediction is weighed in: so a prediction is
    never made true by what it changed. It is foreseen from where the joints are that classes move, and from
    what was recognised in the ticks before this one.
    """
    if recognition.fusion is None:
        return learn
    labels = [one.name for one in recognition.classes]
    joints = list(dict.fromkeys(joint for one in recognition.classes for joint in one.moves))[:8]
    asked = tuple(
        Gvf(
            name=question(label),
            cumulant=name_text(class_signal(label)),
            timescale=max(recognition.fusion.timescale_s * rate_hz, 1.01),
            trace_lambda=0.9,
            step_size=0.1,
            representation=REPRESENTATION,
            confidence_range=1.0,  # of a probability: a class that is not used can be foreseen, too
        )
        for label in labels
    )
    known = learn or Learn(gvfs=asked)
    return known.model_copy(
        update={
            "representations": (*known.representations, _representation(joints, labels, rate_hz)),
            "gvfs": (*(learn.gvfs if learn else ()), *asked),
        }
    )


def _representation(joints: Sequence[str], labels: Sequence[str], rate_hz: float) -> RepresentationTable:
    """Posture alone, which is soon known, and posture with what was recognised lately, which tells more."""
    posture = tuple(f"norm({name_text(f'{joint}.position')})" for joint in joints)
    kept = math.exp(-1 / (PAST_S * rate_hz))
    past = tuple(f"trace(delay({name_text(class_signal(label))}, 1), {kept:.6f})" for label in labels)
    return RepresentationTable(
        name=REPRESENTATION,
        tiles=(
            Tiles(inputs=posture, tilings=TILINGS, width=WIDTH, memory=MEMORY),
            Tiles(inputs=(*posture, *past), tilings=TILINGS, width=2 * WIDTH, memory=MEMORY),
        ),
    )


class Foresight:
    """The predictions of the newest tick; where one is missing nothing is foreseen."""

    def __init__(self, predictor: Callable[[], Predictor | None], labels: Sequence[str]) -> None:
        """`predictor`: what learns now, if anything does. `labels`: of the classes that move something."""
        self._predictor = predictor
        self._questions = {label: question(label) for label in labels}

    def __call__(self) -> Foreseen:
        """P of each class, and the least C of them."""
        predictor = self._predictor()
        if predictor is None:
            return Foreseen({}, 0.0)
        use = {label: predictor.fresh(name) for label, name in self._questions.items()}
        sure = [predictor.confidence(name) for name in self._questions.values()]
        told = [*use.values(), *sure]
        return Foreseen(use, min(sure)) if all(map(math.isfinite, told)) else Foreseen({}, 0.0)


def weighing(recognition: Recognition, predictor: Callable[[], Predictor | None]) -> Fuse | None:
    """How predictions are weighed in; None: the config does not ask for it."""
    if recognition.fusion is None:
        return None
    fusion, foresight = recognition.fusion, Foresight(predictor, [one.name for one in recognition.classes])

    def weigh(labels: Sequence[str], likelihoods: Sequence[float]) -> Fused:
        return fuse(labels, likelihoods, foresight(), fusion)

    return weigh
