"""What the terminal says of collecting, training and classes."""

from bentod.cli.recognition_words import collected, explain_recognition, trained
from bentod.frames import Value
from tests.emg.live.signals import TABLE


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
