"""What was decided live is in the recording, and is decided again from the samples in it."""

import asyncio
from pathlib import Path

from bentod.client import Client
from bentod.config import Config
from bentod.config_tables import Record
from bentod.daemon import Daemon
from bentod.emg.classify import model_file
from bentod.emg.live.stream import Stream, deciding
from bentod.emg.recognition import Decision
from bentod.frames import EmgBlock, Frame
from bentod.record.reader import Recording
from bentod.supervise import Supervisor
from sim.clock import VirtualClock
from tests.emg.live.signals import model
from tests.serve.test_emg_methods import patterns


def config(folder: Path) -> Config:
    """The shipped config, with a model of its own signals in its folder, and a recording."""
    shipped = patterns(folder, ('features = ["robust"]', 'features = ["td"]'))
    model_file.write(folder / "muscles" / "model.model", model())
    return shipped.model_copy(update={"record": Record(folder=folder / "recordings")})


async def test_a_recording_decides_again_what_was_decided_live_bit_for_bit(tmp_path: Path) -> None:
    found = config(tmp_path)
    daemon = Daemon(found, VirtualClock(), Supervisor(), tmp_path / "s")
    task = asyncio.create_task(daemon.run(120))
    await asyncio.sleep(0.5)
    async with Client.connect(tmp_path / "s") as arm:
        await arm.call("emg_prompt", label="pronation")
        await task
    (path,) = (tmp_path / "recordings").rglob("*.mcap")
    entries = list(Recording(path).entries())
    assert found.emg is not None
    assert found.emg.recognition is not None
    stream = Stream(model().setting, range(8))
    stream.use(model(), deciding(found.emg.recognition))
    again: dict[int, Decision] = {}
    for block in entries:
        if isinstance(block, EmgBlock):
            again |= {one.index: one for one in stream.take(block.first_index, block.samples)}
    live = [entry.emg.recognition for entry in entries if isinstance(entry, Frame)]
    told = {one.index: one for one in live if one and one.index >= 0}
    assert len(told) > 50
    assert {"pronation", "rest"} <= {one.label for one in told.values()}
    for index, one in told.items():
        other = again[index]
        assert (one.label, one.speed, one.likely, one.rejected) == (
            other.label,
            other.speed,
            other.likely,
            other.rejected,
        )
        assert one.probabilities == other.probabilities
