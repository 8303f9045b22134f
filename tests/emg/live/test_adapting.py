"""Recognition that follows its wearer while the arm is in use, and what clients hear of it."""

import pytest

from bentod.config_adaptation import Adaptation, Fusion
from bentod.config_recognition import Recognition
from bentod.emg.fusing import Foreseen, fuse
from bentod.emg.live.recogniser import REST_FIRST, Recogniser
from bentod.errors import Refused
from bentod.frames import Value
from tests.emg.live.signals import FILTERS, TABLE, model
from tests.emg.live.test_recogniser import Rig


class Following(Rig):
    """A rig whose recogniser adapts."""

    def __init__(self, kind: str = "lda_adaptive") -> None:
        super().__init__(kind="")
        table = TABLE.model_copy(update={"adaptation": Adaptation()})
        self.recogniser = Recogniser(table, FILTERS, self.feed)
        self.recogniser.use(model(kind), "model")

    def told(self) -> dict[str, Value]:
        found = self.recogniser.describe()["adaptation"]
        assert isinstance(found, dict)
        return found

    def use(self, obeyed: bool = True) -> None:
        """Two contractions, each with rest before and after, looked at as a tick does."""
        for label in ("rest", "wrist_flexion", "rest", "pronation", "rest"):
            self.person.prompt(label)
            for _ in range(60):
                self.hear(0.03)
                self.look(obeyed=obeyed)


def test_contractions_in_use_are_learned_from_and_clients_hear_of_it() -> None:
    rig = Following()
    rig.use()
    learned = rig.told()["learned"]
    assert isinstance(learned, int)
    assert learned >= 2


def test_an_arm_that_does_not_obey_teaches_nothing() -> None:
    rig = Following()
    rig.use(obeyed=False)
    assert rig.told()["learned"] == 0


def test_an_arm_that_is_paused_or_driven_by_somebody_else_teaches_nothing() -> None:
    rig = Following()
    rig.recogniser.heeded = False
    rig.use()
    assert rig.told()["learned"] == 0


def test_a_reset_goes_back_to_what_was_trained_and_wants_rest_first() -> None:
    rig = Following()
    rig.use()
    rig.make("pronation")
    rig.recogniser.reset_adaptation()
    assert rig.told()["drift"] == pytest.approx(dict.fromkeys(model("lda_adaptive").labels, 0.0), abs=1e-6)
    assert rig.look().frame.reason == REST_FIRST


@pytest.mark.parametrize("kind", ["lda", "lda_adaptive"])
def test_who_does_not_adapt_cannot_be_reset(kind: str) -> None:
    rig = Rig(kind)
    assert rig.recogniser.describe()["adaptation"] is None
    with pytest.raises(Refused, match="nothing is adapted"):
        rig.recogniser.reset_adaptation()


def test_a_model_of_another_kind_is_used_as_it_is() -> None:
    rig = Following("lda")
    assert rig.recogniser.describe()["adaptation"] is None


def test_adaptation_asks_for_the_classifier_that_can() -> None:
    with pytest.raises(ValueError, match="lda_adaptive"):
        Recognition.model_validate(TABLE.model_dump() | {"classifier": "knn", "adaptation": {}})


def test_a_frame_says_what_a_decision_owes_to_a_prediction() -> None:
    rig = Rig(kind="")
    foreseen = Foreseen({"pronation": 0.5}, 0.8)
    rig.recogniser.fuse = lambda labels, known: fuse(labels, known, foreseen, Fusion(beta=0.5))
    rig.recogniser.use(model("lda"), "model")
    assert rig.make("rest").frame.weight == 0
    frame = rig.make("wrist_flexion").frame
    assert frame.unaided == "wrist_flexion"
    assert frame.weight == pytest.approx(0.4)
    assert sum(frame.probabilities.values()) == pytest.approx(1)
