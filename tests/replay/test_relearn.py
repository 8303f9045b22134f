"""What was learned live is learned again from the recording, to the last bit, whatever clients asked."""

import asyncio
from pathlib import Path

import pytest

from bentod import registry
from bentod.config_file import parse
from bentod.config_tables import Record
from bentod.frames import Frame, Value
from bentod.record.reader import Recording
from bentod.replay.relearn import Relearner, same_thoughts, ticks
from sim.clock import VirtualLoop, run
from tests.rig import PLAIN, running, sim_config

LEARNING = """
[[learn.representations]]
name = "layered"
[[learn.representations.tiles]]
inputs = ['norm(prediction("elbow_flexion.position@10"), -1, 3)', "norm(elbow_flexion.position)"]
memory = 256

[[learn.gvfs]]
name = "deep"
cumulant = "elbow_flexion.velocity"
timescale_s = 0.5
representation = "layered"
variance = true

[[learn.gvfs]]
name = "off"
cumulant = "diff(shoulder_rotation.position)"
gamma = "below(abs(shoulder_rotation.velocity), 0.3)"
algorithm = "gtd"
policy = "2 * above(shoulder_rotation.velocity, 0)"
representation = "layered"

[assist]
"""
"""A second layer with the variance of its return, and a question about another policy."""

ADDED: dict[str, Value] = {"name": "push", "cumulant": "trace(emg.flexor, 0.9)", "timescale": 15}
ALONE: dict[str, Value] = {"name": "alone", "cumulant": "arm.toggled", "timescale": 30, "algorithm": "tidbd"}
LATER: dict[str, Value] = {"name": "later", "cumulant": "elbow_flexion.velocity", "timescale": 10}


@pytest.fixture(scope="module")
def told(tmp_path_factory: pytest.TempPathFactory) -> list[tuple[Frame, Frame]]:
    """Each tick of a session as it was thought live, and as it is thought again."""
    folder = tmp_path_factory.mktemp("relearn")
    run(_session(folder))
    with Recording(folder / "recordings") as recording:
        relearner = Relearner(parse(recording.header.config, "the recording", registry))
        return [(tick.frame, relearner.step(tick)) for tick in ticks(recording.entries())]


async def _session(folder: Path) -> None:
    config = sim_config(PLAIN, ("[assist]\n", LEARNING))
    config = config.model_copy(update={"record": Record(folder=folder / "recordings")})
    async with running(config, folder / "bentod.sock") as arm:
        assert await arm.call("gvf_add", gvf=ADDED) == ["push"]
        assert await arm.call("gvf_add", gvf=ALONE) == ["alone"]
        await asyncio.sleep(1)
        await miss(0.05, 0.08, 0.3)
        await arm.call("gvf_reset", name=["push", "elbow_flexion.position@10", "off"])
        await asyncio.sleep(0.7)
        await arm.call("gvf_remove", name=["alone", "deep", "deep.variance"])
        await arm.call("gvf_add", gvf=LATER)
        await miss(0.3, 0.08)
        await arm.call("gvf_remove", name="push")
        await arm.call("gvf_add", gvf=ADDED)
        await asyncio.sleep(0.5)


async def miss(*spans: float) -> None:
    """Hold the loop for each of `spans` (s), so that ticks are missed."""
    loop = asyncio.get_running_loop()
    assert isinstance(loop, VirtualLoop)
    for span in spans:
        loop.block(span)
        await asyncio.sleep(0.2)


def test_every_tick_is_learned_again_to_the_last_bit(told: list[tuple[Frame, Frame]]) -> None:
    assert len(told) > 100
    assert [live.tick for live, again in told if not same_thoughts(live, again)] == []
    assert [live.tick for live, again in told if live.learn != again.learn] == []


def test_questions_that_came_and_went_are_told_of_in_their_time(told: list[tuple[Frame, Frame]]) -> None:
    asked = [list(live.learn.predictions) for live, _ in told]
    for names in (
        ["deep", "deep.variance", "off"],
        ["deep", "deep.variance", "off", "push", "alone"],
        ["off", "push", "later"],
        ["off", "later", "push"],
    ):
        assert names in asked


def test_the_session_had_all_that_makes_learning_hard(told: list[tuple[Frame, Frame]]) -> None:
    lives = [live for live, _ in told]
    missed = [lives[i].missed - lives[i - 1].missed for i in range(1, len(lives))]
    assert {1, 2} <= set(missed)
    assert max(missed) > 3
    assert all(
        any(live.learn.predictions.get(name, 0.0) for live in lives) for name in ("push", "off", "later")
    )
    assert any(live.learn.predictions.get("deep.variance", 0.0) > 0 for live in lives)
