"""What is predicted of the classes of muscle signals, from the questions to a decision."""

import numpy as np
import pytest

from bentod.config_adaptation import Fusion
from bentod.config_learn import Learn
from bentod.config_recognition import RecognisedClass, Recognition
from bentod.emg.fusing import Foreseen
from bentod.foresight import Foresight, weighing, with_use
from bentod.frames import EmgFrame
from bentod.learn.horde import unhurried
from bentod.learn.predictor import Body, Predictor
from bentod.learn.signals import Percept
from bentod.recognition_frame import RecognitionFrame
from tests.fakes import PERIOD, SPECS, at

LABELS = ("close", "turn it")
TABLE = Recognition(
    classes=tuple(
        RecognisedClass(name=label, group="arm", moves={joint: 1.0})
        for label, joint in zip(LABELS, ("shoulder", "elbow"), strict=True)
    ),
    fusion=Fusion(timescale_s=0.2),
)


def new_predictor() -> Predictor:
    learn = with_use(None, TABLE, 1 / PERIOD)
    assert learn is not None
    return Predictor(Body(SPECS, (), {}, 1 / PERIOD, LABELS), learn)


def percept(tick: int, reason: str = "", prompted: str = "", alive: bool = True) -> Percept:
    """Closing where the shoulder is low, turning where it is high, for a second each."""
    high = tick // 30 % 2
    shares = {"close": 0.9 - 0.8 * high, "turn it": 0.1 + 0.8 * high, "rest": 0.0}
    told = RecognitionFrame(tick, "close", 1.0, shares, "close", False, reason, "model", prompted)
    emg = EmgFrame(alive, False, "", tick, 0.0, 0, {}, 0, told)
    return Percept(tick, tick * PERIOD, False, at(0.9 * high, 0.0, time=tick * PERIOD), emg, ())


def live(predictor: Predictor, *percepts: Percept) -> None:
    for one in percepts:
        predictor.see(one)
        predictor.step(unhurried)


def test_without_fusion_nothing_more_is_learned() -> None:
    plain = TABLE.model_copy(update={"fusion": None})
    assert with_use(None, plain, 30.0) is None
    assert weighing(plain, new_predictor) is None


def test_questions_about_classes_come_beside_those_of_the_config() -> None:
    own = Learn(joints=("shoulder",), timescales=(5.0,))
    found = with_use(own, TABLE, 1 / PERIOD)
    assert found is not None
    assert found.joints == own.joints
    assert [gvf.name for gvf in found.gvfs] == ["use.close", "use.turn_it"]


def test_the_use_of_classes_is_foreseen_where_they_are_used() -> None:
    predictor = new_predictor()
    foresight = Foresight(lambda: predictor, LABELS)
    live(predictor, *map(percept, range(1500)))
    live(predictor, *map(percept, range(1500, 1512)))
    low = foresight()
    live(predictor, *map(percept, range(1512, 1542)))
    high = foresight()
    assert low.use["close"] > 0.7 > 0.3 > low.use["turn it"]
    assert high.use["turn it"] > 0.7 > 0.3 > high.use["close"]
    assert low.confidence > 0.5


def test_what_has_not_been_learned_has_no_weight() -> None:
    predictor = new_predictor()
    weigh = weighing(TABLE, lambda: predictor)
    assert weigh is not None
    assert weigh((*LABELS, "rest"), (0.6, 0.3, 0.1)).weight == 0
    nobody = weighing(TABLE, lambda: None)
    assert nobody is not None
    assert nobody((*LABELS, "rest"), (0.6, 0.3, 0.1)).weight == 0


def test_what_was_learned_tips_a_decision_that_muscles_leave_open() -> None:
    predictor = new_predictor()
    live(predictor, *map(percept, range(1512)))
    weigh = weighing(TABLE, lambda: predictor)
    assert weigh is not None
    found = weigh((*LABELS, "rest"), (0.45, 0.5, 0.05))
    assert (found.unaided, found.likely, found.changed) == ("turn it", "close", True)
    assert 0 < found.weight <= 0.3


def learned_in(ticks: range, unseen: dict[str, object]) -> float:
    """How far the weights are moved by these ticks, after some seconds of use."""
    predictor = new_predictor()
    live(predictor, *map(percept, range(192)))
    before = predictor.memory()
    live(predictor, *(percept(tick, **unseen) for tick in ticks))  # type: ignore[arg-type]
    after = predictor.memory()
    names = [name for name in before if name.endswith("weights")]
    return max(float(np.abs(after[name] - before[name]).max()) for name in names)


@pytest.mark.parametrize("unseen", [{"reason": "REST"}, {"prompted": "close"}, {"alive": False}])
def test_what_the_wearer_does_not_do_freely_teaches_nothing(unseen: dict[str, object]) -> None:
    ticks = range(192, 200)
    assert learned_in(ticks, unseen) < 1e-4 < 1e-3 < learned_in(ticks, {})


def test_while_nothing_is_recognised_nothing_is_foreseen() -> None:
    predictor = new_predictor()
    live(predictor, *map(percept, range(192)))
    live(predictor, *(percept(tick, reason="REST") for tick in range(192, 200)))
    assert Foresight(lambda: predictor, LABELS)() == Foreseen({}, 0.0)
