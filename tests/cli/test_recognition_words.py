"""What the terminal says of collecting, training and classes."""

import re
from pathlib import Path

import pytest

from bentod.cli.configs import read
from bentod.cli.recognition_words import check_recognition, collected, explain_recognition, trained
from bentod.config_adaptation import Adaptation, Fusion
from bentod.errors import ConfigError
from bentod.frames import Value
from tests.emg.live.signals import TABLE

CONFIGS = Path(__file__).parents[2] / "config"


def test_a_class_is_told_with_its_strength_and_how_far_its_labels_went() -> None:
    told: Value = {
        "classes": {"close": {"over_rest": 6.04, "moved_s": [0.31, -0.1]}},
        "warnings": ["close is clipped in 5 % of its samples: lower the amplification."],
    }
    assert collected(told).splitlines() == [
        "close: 6.0 times rest, labels moved by -0.10 to +0.31 s",
        "close is clipped in 5 % of its samples: lower the amplification.",
    ]


def test_training_tells_what_to_expect_and_when_nothing_is_known_of_it() -> None:
    told: Value = {"accuracy": 0.931, "recall": {"close": 0.9}, "seconds": 1.24, "sessions": 2}
    assert trained(told).splitlines() == [
        "each repetition by the others: 93.1 %",
        "  close: 90.0 %",
        "trained in 1.2 s on 2 sessions",
    ]
    assert "only one repetition" in trained({"accuracy": None})


def test_the_config_is_explained_class_by_class() -> None:
    assert list(explain_recognition(TABLE)) == [
        "lda tells 3 classes and rest apart, every 50 ms in the last 150 ms.",
        "  wrist_flexion moves wrist_flexion at +100% of its top speed.",
        "  wrist_extension moves wrist_flexion at -50% of its top speed.",
        "  pronation moves wrist_rotation at +100%, wrist_flexion at +50% of its top speed.",
    ]


def test_what_helps_recognition_is_explained() -> None:
    helped = TABLE.model_copy(update={"fusion": Fusion(beta=0.2), "adaptation": Adaptation()})
    assert list(explain_recognition(helped))[4:] == [
        "What is predicted of their use counts up to 20% (fusion).",
        "The classes follow the wearer (adaptation); what they become is not kept.",
    ]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"classifier": "ldaa"}, "emg.recognition: there is no classifier 'ldaa'; did you mean 'lda'?"),
        ({"features": ("mvs",)}, "emg.recognition: there is no feature 'mvs'; did you mean 'mavs'?"),
        ({"features": ({"name": "wl", "segments": 4},)}, "150 is no multiple of 4"),
    ],
)
def test_what_could_not_be_trained_is_told_before_anything_is_collected(
    change: dict[str, Value], said: str
) -> None:
    emg = read(CONFIGS / "patterns.toml").emg
    assert emg
    assert emg.recognition
    check_recognition(emg)
    wrong = emg.model_copy(update={"recognition": emg.recognition.model_copy(update=change)})
    with pytest.raises(ConfigError, match=re.escape(said)):
        check_recognition(wrong)
