"""Reward on its way: from clients, toggles and contacts to what finds timescales, and again in a replay."""

import asyncio
from pathlib import Path

import numpy as np
import pytest

from bentod import registry
from bentod.config_file import parse
from bentod.config_learn import Learn
from bentod.config_tables import Assist, Record
from bentod.control.groups import Groups
from bentod.errors import BadRequest, ConfigError
from bentod.frames import EmgFrame, Event, Frame, GroupFrame
from bentod.learn.signals import Percept
from bentod.learn.snapshot import read, taken, write
from bentod.mind import Helped, Mind
from bentod.record.reader import Recording
from bentod.replay.relearn import Relearner, same_thoughts, ticks
from sim.clock import run
from tests.fakes import PERIOD, SPECS, at, desk_of
from tests.rig import PLAIN, running, sim_config, table

BOTH = ("shoulder", "elbow")
NO_EMG = EmgFrame(False, False, "", 0, 0.0, 0, {}, 0)
GROUP = GroupFrame("arm", BOTH, "shoulder", 0.5, "emg")


def mind_of(by: str, timescales: tuple[float, ...] = (10.0, 20.0)) -> Mind:
    learn = Learn(joints=BOTH, timescales=timescales)
    assist = Assist.model_validate({"group": "arm", "timescale_by": by, "k": 0.1})
    return Mind(SPECS, 1 / PERIOD, Groups(SPECS, {"arm": BOTH}), learn, [assist])


def think(mind: Mind, first: int, count: int) -> Helped:
    """So many ticks, in which the wearer moves the shoulder to and fro and the elbow follows."""
    helped = None
    for tick in range(first, first + count):
        shoulder = np.sin(tick / 15)
        percept = Percept(tick, tick * PERIOD, False, at(shoulder, -shoulder), NO_EMG, (GROUP,))
        mind.predict(percept)
        helped = mind.assist(percept, {0})
        mind.learn()
    assert helped
    return helped


@pytest.mark.parametrize("by", ["sarsa", "blend", "state"])
def test_an_assist_that_finds_its_timescale_says_how_far_it_looks(by: str) -> None:
    mind = mind_of(by)
    helped = think(mind, 0, 100)
    assert helped.wishes
    assert " It looks " in helped.frames[0].reason
    assert mind.describe()["timescale_by"] == by


def test_a_varying_timescale_is_learned_and_answered_before_the_write() -> None:
    mind = mind_of("state")
    think(mind, 0, 200)
    names = {"arm.worth", "shoulder.position@state", "elbow.position@state"}
    assert names <= mind.frame().predictions.keys()
    percept = Percept(200, 200 * PERIOD, False, at(0.0, 0.0), NO_EMG, (GROUP,))
    mind.predict(percept)
    assert mind.learners.horde.answers.fresh("elbow.position@state") == pytest.approx(0.0, abs=0.7)
    told = table(table(mind.describe()["told"])["timescales"])
    assert float(str(told["leash"])) > 0


def test_reward_makes_the_varying_timescale_longer_and_its_lack_shorter() -> None:
    found = []
    for reward in (1.0, -1.0):
        mind = mind_of("state")
        for tick in range(120):
            mind.rewards.give(reward)
            think(mind, tick, 1)
        found.append(mind.learners.newest("arm.worth"))
    assert found[0] > 1
    assert found[1] < -1


def test_another_way_may_be_chosen_in_use_and_what_it_needs_is_asked() -> None:
    mind = mind_of("fixed")
    before = mind.describe()
    mind.change({"timescale_by": "state"})
    think(mind, 0, 3)
    assert "elbow.position@state" in mind.frame().predictions
    mind.change({"timescale_by": "fixed", "toggle_reward": -2.0})
    assert mind.describe() == before | {"toggle_reward": -2.0}


def test_a_way_that_cannot_be_taken_changes_nothing() -> None:
    mind = mind_of("fixed", (20.0,))
    before = mind.describe()
    with pytest.raises(BadRequest, match="at least 2 timescales"):
        mind.change({"timescale_by": "sarsa", "k": 0.3})
    with pytest.raises(BadRequest, match="one of fixed"):
        mind.change({"timescale_by": "luck", "k": 0.3})
    assert mind.describe() == before
    with pytest.raises(ConfigError, match="the assist of arm: timescale_by = 'blend' needs at least 2"):
        mind_of("blend", (20.0,))


def test_rewards_toggles_and_contacts_add_up_and_last_a_tick() -> None:
    mind = mind_of("sarsa")
    mind.rewards.give(2.0, "arm")
    mind.rewards.give(0.5)
    think(mind, 0, 1)
    mind.toggled("arm", 0.0)
    mind.rewards.marked("contact")
    mind.rewards.marked("circuit")
    assert mind.rewards.take() == {"arm": -2.0}
    assert mind.rewards.take() == {}


@pytest.mark.parametrize(
    ("reward", "group", "words"),
    [(11.0, None, "within ±10, not 11"), (float("nan"), None, "not nan"), (1.0, "leg", "no group 'leg'")],
)
def test_a_wrong_reward_is_refused(reward: float, group: str | None, words: str) -> None:
    mind = mind_of("sarsa")
    with pytest.raises(BadRequest, match=words):
        mind.rewards.give(reward, group)
    assert mind.rewards.take() == {}


def test_a_reward_is_told_of_as_an_event_and_a_contact_counts() -> None:
    desk = desk_of(mind=mind_of("sarsa"))
    desk.reward(-1.5, "tester", "arm")
    desk.trials.start("maze", "")
    desk.mark_trial("contact")
    events: list[Event] = [event for event in desk.journal.take() if event.kind == "reward"]
    assert [(event.text, dict(event.data)) for event in events] == [
        ("tester gave arm -1.5", {"reward": -1.5, "group": "arm"})
    ]
    assert desk.mind.rewards.take() == {"arm": -2.5}


def test_what_was_found_out_is_kept_with_what_was_learned(tmp_path: Path) -> None:
    one = mind_of("sarsa")
    think(one, 0, 100)
    for tick in range(100, 400, 30):
        one.toggled("arm", tick * PERIOD)
        think(one, tick, 30)
    assert one.known
    memory = one.known.memory()
    assert memory["assists/arm/sarsa/w"].any()
    other = mind_of("sarsa")
    assert other.known
    write(tmp_path / "kept", taken(one.known, "arm", 0.0, 400))
    assert read(tmp_path / "kept").give(other.known) == []
    assert all(np.array_equal(array, memory[name]) for name, array in other.known.memory().items())


@pytest.fixture(scope="module")
def told(tmp_path_factory: pytest.TempPathFactory) -> tuple[list[Event], list[tuple[Frame, Frame]]]:
    """The events of a session with rewards, and each tick as it was thought live and as it is again."""
    folder = tmp_path_factory.mktemp("rewards")
    run(_session(folder))
    with Recording(folder / "recordings") as recording:
        relearner = Relearner(parse(recording.header.config, "the recording", registry))
        seen = list(ticks(recording.entries()))
        events = [event for tick in seen for event in tick.events]
        return events, [(tick.frame, relearner.step(tick)) for tick in seen]


async def _session(folder: Path) -> None:
    config = sim_config(PLAIN, ("[assist]\n", '[assist]\ntimescale_by = "sarsa"\n'), ("k = 0.025", "k = 0.1"))
    config = config.model_copy(update={"record": Record(folder=folder / "recordings")})
    async with running(config, folder / "bentod.sock") as arm:
        await arm.call("trial_start", name="maze")
        for by in ("sarsa", "blend", "state", "sarsa"):
            await arm.call("assist_set", timescale_by=by)
            for reward in (1.0, -3.0):
                await asyncio.sleep(0.9)
                await arm.call("reward", value=reward, group="arm" if reward > 0 else None)
            await arm.call("trial_mark", mark="contact")
            await arm.call("group_toggle", group="arm")
            await asyncio.sleep(1)


def test_a_session_with_rewards_is_thought_again_to_the_last_bit(
    told: tuple[list[Event], list[tuple[Frame, Frame]]],
) -> None:
    assert [live.tick for live, again in told[1] if not same_thoughts(live, again)] == []
    assert [live.tick for live, again in told[1] if live.learn != again.learn] == []


def test_the_session_had_rewards_and_timescales_that_were_chosen(
    told: tuple[list[Event], list[tuple[Frame, Frame]]],
) -> None:
    events, frames = told
    assert [event.data["reward"] for event in events if event.kind == "reward"] == [1.0, -3.0] * 4
    reasons = {live.assist.reason.partition(" It looks ")[2] for live, _ in frames}
    assert {f"{ticks} ticks ahead, as it learned to (20 are set)." for ticks in (10, 20)} & reasons
    assert any(reason.startswith("about ") for reason in reasons)
    assert any("of the way from 10 ticks ahead" in reason for reason in reasons)
    worth = [live.learn.predictions.get("arm.worth", 0.0) for live, _ in frames]
    assert min(worth) < 0
