"""Learning again from a recording: how many times faster than it was, and whether it is the same."""

import asyncio
import statistics
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from bentod import registry
from bentod.config_file import parse
from bentod.config_tables import Record
from bentod.record.reader import Recording
from bentod.replay.comparison import Comparison, compared
from bentod.replay.relearn import Relearner, ticks
from sim.clock import run
from tests.benchmarks.harness import Row, at_least, main
from tests.rig import PLAIN, running, sim_config

SECONDS = 120  # of the arm's life
ROUNDS = 5


def rows() -> Iterator[Row]:
    """Half a minute."""
    with tempfile.TemporaryDirectory() as name:
        run(_recorded(Path(name)))
        found = [_again(Path(name, "recordings")) for _ in range(ROUNDS)]
    speeds = [one.ticks / 30 / took for one, took in found]
    yield at_least("replay with learners", statistics.median(speeds), "times real time", 20)
    first = found[0][0]
    yield at_least("ticks thought bit for bit as live", first.equal / first.ticks, "", 1)


async def _recorded(folder: Path) -> None:
    config = sim_config(PLAIN).model_copy(update={"record": Record(folder=folder / "recordings")})
    async with running(config, folder / "bentod.sock"):
        await asyncio.sleep(SECONDS)


def _again(folder: Path) -> tuple[Comparison, float]:
    began = time.perf_counter()
    with Recording(folder) as recording:
        config = parse(recording.header.config, "the recording", registry)
        found = compared(ticks(recording.entries()), Relearner(config))
    return found, time.perf_counter() - began


if __name__ == "__main__":
    main("replaying", rows())
