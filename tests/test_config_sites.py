"""What the config may say of sites, pairs, single sites and toggles, and what is told when it cannot be."""

import pytest

from bentod import registry
from bentod.cli.muscle_words import explain_scheme
from bentod.config import Config
from bentod.config_file import parse
from bentod.errors import ConfigError
from tests.rig import CONFIGS


def clinic(*changes: tuple[str, str]) -> Config:
    """The shipped config that uses all of it, with pieces of its text replaced."""
    text = (CONFIGS / "clinic.toml").read_text()
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new, 1)
    return parse(text, "clinic.toml", registry)


FLEXOR = "threshold_v = 10e-6         # an effort begins above ..."


def test_a_site_may_be_written_as_in_brachioplexus() -> None:
    config = clinic(
        (FLEXOR, "smin_v = 12e-6"), ("max_v = 40e-6               # ... and is", "smax_v = 50e-6 #")
    )
    assert config.emg
    flexor = config.emg.sites[0]
    assert (flexor.threshold_v, flexor.max_v) == (12e-6, 50e-6)


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        (FLEXOR, "threshold_v = 1e-6\nsmin_v = 1e-6", "smin_v is another name of threshold_v: give one"),
        ("release = 0.8               # ... ends", "release = 0.05 # ends", "emg.sites.0.release = 0.05"),
        ('rule = "difference"', 'rule = "diference"', "emg.pairs.0.rule = 'diference'"),
        ('negative = "extensor"', 'negative = "flexor"', "positive and negative are the same site, 'flexor'"),
        ('site = "supinator"', 'site = "flexor"', "pulse.site = 'flexor' must be 'pronator' or 'supinator'"),
        ('toggle_back = "shoulder_muscle"', 'toggle_back = "toe"', "emg.pairs.1: there is no site 'toe'"),
        ('site = "hand_flexor"', 'site = "toe"', "emg.single_sites.0: there is no site 'toe'"),
        (
            'group = "hand"\nsite',
            'group = "foot"\nsite',
            "emg.single_sites.0.group: there is no group 'foot'",
        ),
        ('weak = "positive"', 'toggle = "hand_flexor"', "'hand_flexor' drives the group"),
        ("together_s = 0.12", "together_s = 0.6", "emg.pairs.0.co_contraction.together_s = 0.6"),
        ("together_s = 0.12", "toghether_s = 0.1", "unknown key; did you mean 'together_s'?"),
        (
            'site = "supinator"\n',
            'site = "supinator"\nleast_s = 0.4\n',
            "least_s = 0.4 must be below within_s",
        ),
        (
            "dwell_s = 0.2",
            "dwell_s = 0.05",
            "dwell_s = 0.05: must be above the memory of the envelope, 0.05 s",
        ),
        (
            "window = 10 ",
            "window = 20 ",
            "pulse.least_s = 0.08: must be above the memory of the envelope, 0.1 s",
        ),
        ("window = 10 ", 'envelope = "low_pass" #', "dwell_s = 0.2: must be above the memory"),
    ],
)
def test_a_mistake_is_told_with_its_place_and_its_bound(old: str, new: str, told: str) -> None:
    with pytest.raises(ConfigError) as caught:
        clinic((old, new))
    assert told in str(caught.value)


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ([], "flexor minus extensor drives the group arm, toggled by a squeeze of both."),
        (
            [('rule = "difference"', 'rule = "greatest"'), ("together_s = 0.12", 'direction = "backward"')],
            "flexor against extensor, whichever is stronger, drives the group arm, "
            "toggled back by a squeeze of both.",
        ),
        (
            [],
            "pronator against supinator, whichever is first, drives the group wrist, toggled by "
            "shoulder_muscle, toggled back by shoulder_muscle for 0.6 s, toggled by a pulse of supinator.",
        ),
        ([], "hand_flexor, positive when weak and negative when strong, drives the group hand."),
        (
            [('rule = "two_state"', 'rule = "alternate"')],
            "hand_flexor, to and fro in turn, drives the group hand.",
        ),
    ],
)
def test_what_drives_a_group_is_explained_in_a_sentence(
    changes: list[tuple[str, str]], sentence: str
) -> None:
    config = clinic(*changes)
    assert config.emg
    assert sentence in [line for _, table in config.emg.driven() for line in explain_scheme(table)]
