"""What is recognised moves joints; nothing else does, and nothing moves them when it cannot be believed."""

import asyncio
from collections.abc import AsyncIterator, Sequence
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bentod.emg.feed import Feed
from bentod.emg.live.recogniser import NO_MODEL, REST_FIRST, Recogniser, Wanted
from bentod.emg.live.stream import MOST_WINDOWS, Stream, deciding, features
from bentod.emg.recognition import Decision
from bentod.errors import ConfigError, Refused
from bentod.frames import EmgBlock, Samples
from tests.emg.live.signals import (
    ELECTRODES,
    FILTERS,
    LABELS,
    RATE_HZ,
    SETTING,
    TABLE,
    model,
    session,
    wearer,
)


class Source:
    """A wearer whose samples come when the test says so."""

    rate_hz = RATE_HZ
    channels = ELECTRODES

    def __aiter__(self) -> AsyncIterator[EmgBlock]:
        raise NotImplementedError


class Rig:
    """A recogniser, and the person in front of it; time is that of the samples."""

    def __init__(self, kind: str = "lda") -> None:
        self.feed = Feed(Source())
        self.recogniser = Recogniser(TABLE, FILTERS, self.feed)
        self.person = wearer(session=7)
        self.index = 0
        self.decisions: list[Decision] = []
        self.recogniser.decided = self.decisions.append
        if kind:
            self.recogniser.use(model(kind), "model")

    def hear(self, seconds: float, block: int = 10) -> None:
        """Samples of the person, in blocks."""
        for _ in range(round(seconds * RATE_HZ / block)):
            self.put(self.person.read(self.index, block))
            self.recogniser.step()

    def put(self, samples: Samples) -> None:
        self.feed.ring.append(EmgBlock(self.index, self.index / RATE_HZ, samples))
        self.index += len(samples)

    def make(self, label: str, seconds: float = 1.5) -> Wanted:
        self.person.prompt(label)
        self.hear(seconds)
        return self.look()

    def look(self, problem: str = "", obeyed: bool = True) -> Wanted:
        return self.recogniser.look(self.index / RATE_HZ, problem, obeyed)


@pytest.mark.parametrize("label", LABELS)
def test_what_is_made_moves_its_joints_in_proportion(label: str) -> None:
    rig = Rig()
    rig.make("rest")
    wanted = rig.make(label)
    assert wanted.frame.label == wanted.frame.likely == label
    assert 0 < wanted.efforts["hand"] == wanted.frame.speed <= 1
    assert wanted.moves == {"hand": next(one.moves for one in TABLE.classes if one.name == label)}
    assert sum(wanted.frame.probabilities.values()) == pytest.approx(1)


def test_rest_asks_for_nothing_and_says_that_it_rests() -> None:
    rig = Rig()
    wanted = rig.make("rest")
    assert (wanted.efforts, wanted.moves) == ({"hand": 0.0}, {})


def test_without_a_model_nothing_moves_and_the_frame_says_why() -> None:
    rig = Rig(kind="")
    wanted = rig.make("pronation")
    assert (wanted.efforts, wanted.moves, wanted.frame.reason) == ({}, {}, NO_MODEL)


def test_whoever_contracts_when_a_model_comes_into_use_must_rest_first() -> None:
    rig = Rig()
    rig.make("rest")
    rig.make("pronation")
    rig.recogniser.use(model("knn"), "other")
    rig.hear(0.5)
    wanted = rig.look()
    assert (wanted.efforts, wanted.frame.reason) == ({}, REST_FIRST)
    assert wanted.frame.likely == "pronation"
    rig.make("rest")
    assert rig.make("pronation").efforts["hand"] > 0


def test_a_switch_of_classifiers_is_at_one_sample_and_windows_stay_where_they_are() -> None:
    rig = Rig()
    rig.make("rest", 0.5)
    rig.recogniser.use(model("knn"), "other")
    rig.make("rest", 0.5)
    steps = np.diff([decision.index for decision in rig.decisions])
    assert set(steps) == {SETTING.segmenting.step}
    assert rig.look().frame.model == "other"


def test_a_model_of_other_windows_is_refused_and_the_old_one_stays() -> None:
    rig = Rig()
    rig.make("rest")
    other = TABLE.model_copy(update={"step_s": 0.1})
    stranger = Recogniser(other, FILTERS, rig.feed)
    with pytest.raises(Refused, match="step of the windows is 50 samples; here it is 100"):
        stranger.use(model(), "model")
    assert stranger.problem == NO_MODEL


def test_nothing_is_asked_while_the_source_cannot_be_believed_or_nobody_obeys() -> None:
    rig = Rig()
    rig.make("rest")
    assert rig.make("pronation").efforts
    assert rig.look(problem="No EMG sample for 0.08 s.").efforts == {}
    assert rig.look(obeyed=False).efforts == {}
    assert rig.look().efforts["hand"] > 0


def test_a_short_interruption_goes_on_and_a_long_one_needs_rest() -> None:
    rig = Rig()
    rig.make("rest")
    rig.make("pronation")
    for _ in range(12):
        rig.look(problem="gone")
        rig.index += 100
    assert rig.make("pronation").frame.reason == REST_FIRST


def test_missing_samples_stop_what_moves_until_a_window_is_whole_again() -> None:
    rig = Rig()
    rig.make("rest")
    assert rig.make("pronation").efforts["hand"] > 0
    rig.index += 20
    rig.hear(0.1)
    assert rig.look().efforts == {"hand": 0.0}
    assert "missing" in rig.look().frame.reason
    rig.hear(0.8)
    assert rig.look().efforts["hand"] > 0


def test_a_decision_that_is_old_moves_nothing() -> None:
    rig = Rig()
    rig.make("rest")
    rig.make("pronation")
    rig.put(np.zeros((1900, ELECTRODES), np.float32))
    wanted = rig.look()  # a burst: sixteen windows at a time
    assert wanted.efforts == {}
    assert "samples old" in wanted.frame.reason
    while rig.recogniser.step():
        pass
    assert rig.look().efforts == {"hand": 0.0}
    assert rig.recogniser.late == 0


def test_what_breaks_is_told_and_moves_nothing_from_then_on() -> None:
    rig = Rig()
    rig.make("rest")
    rig.feed.ring.append(EmgBlock(rig.index, 0.0, np.zeros((10, ELECTRODES), np.float32)))
    rig.recogniser.decided = lambda _: 1 / 0  # type: ignore[assignment]
    rig.index += 10
    rig.hear(0.2)
    wanted = rig.look()
    assert wanted.efforts == {}
    assert wanted.frame.reason == "Recognition broke and is off: ZeroDivisionError: division by zero."


@pytest.mark.parametrize("channels", [(0, ELECTRODES), (99,)])
def test_a_channel_that_is_not_there_is_told(channels: tuple[int, ...]) -> None:
    with pytest.raises(ConfigError, match="there is no channel"):
        Recogniser(TABLE.model_copy(update={"channels": channels}), FILTERS, Feed(Source()))


@settings(max_examples=6, deadline=None)
@given(
    blocks=st.lists(st.integers(1, 400), min_size=1, max_size=8),
    gaps=st.lists(st.tuples(st.integers(0, 2500), st.integers(1, 300)), max_size=2),
)
def test_live_decisions_are_those_of_the_recording_whatever_the_blocks(
    blocks: Sequence[int], gaps: Sequence[tuple[int, int]]
) -> None:
    samples = session().samples[:3000].copy()
    for start, length in gaps:
        samples[start : start + length] = np.nan
    rig = Rig()
    turn = 0
    while rig.index < len(samples):
        size = blocks[turn % len(blocks)]
        rig.put(samples[rig.index : rig.index + size])
        while rig.recogniser.step():
            pass
        turn += 1
    again = Stream(SETTING, range(ELECTRODES))
    again.use(model(), deciding(TABLE))
    assert rig.decisions == again.take(0, samples)


async def test_a_burst_is_worked_off_in_pieces_between_which_others_have_their_turn() -> None:
    rig = Rig()
    task = asyncio.create_task(rig.recogniser.run())
    await asyncio.sleep(0)
    rig.put(rig.person.read(0, 1950))
    rig.feed.came()
    turns = []
    for _ in range(40):
        await asyncio.sleep(0)
        turns.append(len(rig.decisions))
    task.cancel()
    pieces = np.diff([0, *turns])
    assert pieces.max() <= MOST_WINDOWS
    assert turns[-1] == (1950 - 150) // 50 + 1


def test_a_classifier_that_takes_long_is_asked_less_at_once_and_decides_the_same(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("bentod.emg.live.stream.TURN_S", 1e-7)
    rig = Rig()
    rig.make("rest", 0.5)
    before = len(rig.decisions)
    rig.put(rig.person.read(rig.index, 500))
    steps = []
    while rig.recogniser.step():
        steps.append(len(rig.decisions) - before)
    assert np.diff(steps).max() == 1
    assert len(rig.decisions) - before == 10


def test_windows_that_no_tick_could_bear_are_refused() -> None:
    with pytest.raises(ConfigError, match="has 128000 values of 64 channels at 2000 Hz"):
        features(TABLE.model_copy(update={"window_s": 1.0}), 64, 2000.0)


def test_muscles_that_nobody_is_sure_of_are_not_at_rest() -> None:
    rig = Rig()
    assert rig.make("rest").tense == ()
    rig.make("pronation")
    assert rig.recogniser.newest is not None
    rig.recogniser.newest = replace(rig.recogniser.newest, label="rest", speed=0.0, rejected=True)
    wanted = rig.look()
    assert (wanted.efforts, wanted.tense) == ({"hand": 0.0}, ("hand",))
