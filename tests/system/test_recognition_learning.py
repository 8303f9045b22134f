"""Recognition that learns in use, in a whole daemon with a simulated wearer."""

import asyncio
from pathlib import Path

import pytest

from bentod.client import Client
from bentod.config import Config
from bentod.config_adaptation import Adaptation, Fusion
from bentod.daemon import Daemon
from bentod.emg.classify import model_file
from bentod.endpoint import RpcError
from bentod.frames import Frame
from bentod.record.reader import Recording
from bentod.supervise import Supervisor
from sim.clock import VirtualClock
from tests.emg.live.signals import model
from tests.system.test_recognition_recorded import config

LEARNING = {"classifier": "lda_adaptive", "adaptation": Adaptation(), "fusion": Fusion()}


def learning(folder: Path, **changes: object) -> Config:
    """As recorded, and with what is to be learned in use."""
    found = config(folder)
    model_file.write(folder / "muscles" / "model.model", model("lda_adaptive"))
    assert found.emg is not None
    assert found.emg.recognition is not None
    recognition = found.emg.recognition.model_copy(update=changes)
    return found.model_copy(update={"emg": found.emg.model_copy(update={"recognition": recognition})})


async def test_decisions_in_a_recording_tell_what_they_owe_to_predictions(tmp_path: Path) -> None:
    daemon = Daemon(learning(tmp_path, **LEARNING), VirtualClock(), Supervisor(), tmp_path / "s")
    task = asyncio.create_task(daemon.run(240))
    await asyncio.sleep(0.5)
    async with Client.connect(tmp_path / "s") as arm:
        asked = await arm.call("gvf_list")
        assert "use.pronation" in str(asked)
        await arm.call("emg_prompt", label="pronation")
        await asyncio.sleep(3)
        await arm.call("emg_reset")
        await task
    (path,) = (tmp_path / "recordings").rglob("*.mcap")
    frames = [entry.emg.recognition for entry in Recording(path).entries() if isinstance(entry, Frame)]
    decided = [frame for frame in frames if frame and frame.index >= 0]
    assert {"pronation", "rest"} <= {frame.unaided for frame in decided}
    assert all(0 <= frame.weight <= Fusion().beta for frame in decided)
    assert any(frame.weight > 0 for frame in decided)
    assert all(frame.weight == 0 for frame in decided if frame.unaided == "rest")


async def test_who_does_not_adapt_is_told_so_by_a_reset(tmp_path: Path) -> None:
    daemon = Daemon(learning(tmp_path), VirtualClock(), Supervisor(), tmp_path / "s")
    task = asyncio.create_task(daemon.run(60))
    await asyncio.sleep(0.5)
    async with Client.connect(tmp_path / "s") as arm:
        with pytest.raises(RpcError, match="nothing is adapted"):
            await arm.call("emg_reset")
        await task
