"""What the arm did with all joints together is thought again from the recording, to the last bit."""

import asyncio
from pathlib import Path

import pytest

from bentod import registry
from bentod.config_file import parse
from bentod.config_tables import Record
from bentod.frames import Frame
from bentod.record.reader import Recording
from bentod.replay.relearn import Relearner, same_thoughts, ticks
from sim.clock import run
from tests.rig import PLAIN, running, sim_config, state, tables

EAGER = """
[assist]
options = { trajectory-confidence = 0.0, trajectory-familiarity = 0.0, trajectory-hysteresis = 1.0 }
"""
MODE = ('mode = "dpcc"', 'mode = "dpcc+trajectory+adaptive_switching"')


@pytest.fixture(scope="module")
def told(tmp_path_factory: pytest.TempPathFactory) -> list[tuple[Frame, Frame]]:
    """Each tick as it was thought live, and as it is thought again."""
    folder = tmp_path_factory.mktemp("together")
    run(_session(folder))
    with Recording(folder / "recordings") as recording:
        relearner = Relearner(parse(recording.header.config, "the recording", registry))
        return [(tick.frame, relearner.step(tick)) for tick in ticks(recording.entries())]


async def _session(folder: Path) -> None:
    config = sim_config(PLAIN, ("[assist]\n", EAGER), MODE)
    config = config.model_copy(update={"record": Record(folder=folder / "recordings")})
    async with running(config, folder / "bentod.sock") as arm:
        await asyncio.sleep(4)
        await arm.call("emg_pause")
        await arm.call("group_activate", group="arm", joint="elbow_flexion")
        while not tables(await state(arm), "groups")[0]["together"]:
            await arm.call("group_toggle", group="arm")
        await asyncio.sleep(0.6)
        for effort in (0.7, -0.4, 0.3):
            await arm.call("group_command", group="arm", effort=effort, lease_s=0.7)
            await asyncio.sleep(0.7)
        await arm.call("assist_set", mode="dpcc")
        await asyncio.sleep(0.3)
        await arm.call("assist_set", mode="adaptive_switching", options={"use_timescale": 20})
        await arm.call("emg_pause", on=False)
        await asyncio.sleep(3)


def test_every_tick_is_thought_again_to_the_last_bit(told: list[tuple[Frame, Frame]]) -> None:
    assert len(told) > 250
    assert [live.tick for live, again in told if not same_thoughts(live, again)] == []
    assert [live.tick for live, again in told if live.learn != again.learn] == []


def test_the_session_had_joints_pushed_and_pulled_together(told: list[tuple[Frame, Frame]]) -> None:
    lives = [live for live, _ in told]
    reasons = {live.assist.reason.partition(":")[0] for live in lives if live.assist.moving}
    assert {"Pushed along the learned path", "Pulled back along the way it came"} <= reasons
    assert all(live.groups[0].together for live in lives if live.assist.reason.startswith("Pu"))
    assert any(live.assist.mode == "adaptive_switching" for live in lives)
    assert {live.groups[0].active for live in lives} == {"shoulder_rotation", "elbow_flexion"}
