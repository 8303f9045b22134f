"""What was learned, from one session to the next: restored at the start, kept now and then and at the end."""

import logging
import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from bentod.config import Config
from bentod.config_learn import SnapshotTable
from bentod.contracts import Clock
from bentod.frames import Value
from bentod.known import Known
from bentod.learn.keeper import Keeper, resume
from bentod.learn.snapshot import taken
from bentod.mind import Mind
from bentod.record.disk import default_folder

_log = logging.getLogger(__name__)

MOST_CARRIED = 32 << 20
"""Bytes of a snapshot that a recording carries, so that it can be replayed as it was live."""


class Learned:
    """Keeps what a mind has learned. `chore` is for the time that is left after a tick."""

    def __init__(self, mind: Mind, known: Known, keeper: Keeper, arm: str, clock: Clock) -> None:
        """`known`: what `mind` has learned."""
        self._mind = mind
        self._known = known
        self._keeper = keeper
        self._arm = arm
        self._clock = clock
        self._copying: _Copy | None = None
        self._spoilt = False

    def chore(self, now: float) -> None:
        """Copy one part of what is to be kept, if something is: a unit a tick, each as of one moment."""
        self._tell()
        if self._mind.broken or not (self._copying or self._keeper.due(now)):
            return
        try:
            self._copy()
        except MemoryError:
            self._copying = None
            _log.warning("There is no memory for a copy of what was learned; the next one is tried in time.")
        except Exception:  # noqa: BLE001 -- a learner from outside may do anything; the arm goes on
            self._copying = None
            self._log_once()

    def close(self) -> None:
        """Keep what is known now, unless learning broke."""
        tick = self._known.horde.answers.tick
        try:
            known = None if self._mind.broken else taken(self._known, self._arm, self._clock.wall(), tick)
        except Exception:  # noqa: BLE001 -- what was kept before is better than nothing
            known = None
            self._log_once()
        self._keeper.close(known)
        self._tell()

    def _log_once(self) -> None:
        if not self._spoilt:
            _log.exception("What was learned cannot be copied, and so is not kept.")
        self._spoilt = True

    def _tell(self) -> None:
        for sentence in self._keeper.take_events():
            _log.warning("%s", sentence)

    def _copy(self) -> None:
        """One part more, and when there is none any more have all of them written."""
        if self._copying is None or self._copying.horde is not self._known.horde:
            self._copying = _Copy(self._known)
        if not self._copying.go_on():
            copied, self._copying = self._copying, None
            self._keeper.put(taken(copied, self._arm, self._clock.wall(), copied.horde.answers.tick))


class _Copy:
    """What is known about the questions of one horde, copied part by part."""

    def __init__(self, known: Known) -> None:
        self.horde = known.horde
        self._spec = known.spec()
        self._parts = known.parts()
        self._arrays: dict[str, NDArray[np.float64]] = {}

    def go_on(self) -> bool:
        """Copy one part more; whether there was one."""
        part = next(self._parts, None)
        self._arrays |= part or {}
        return part is not None

    def spec(self) -> Mapping[str, Value]:
        """Of all that is copied."""
        return self._spec

    def memory(self) -> dict[str, NDArray[np.float64]]:
        """What has been copied."""
        return self._arrays

    def recall(self, spec: Mapping[str, Value], memory: Mapping[str, NDArray[np.float64]]) -> list[str]:
        """A copy is not put back."""
        raise NotImplementedError


@contextmanager
def learned(
    config: Config, mind: Mind, name: str, clock: Clock
) -> Iterator[tuple[bytes, Callable[[float], None]]]:
    """While entered, `mind` knows what it learned before, and what it learns is kept, if the config says so.

    `name`: of the config; of one without a name, nothing is kept but where it says. Gives the snapshot that
    it goes on with, as a recording can carry it (empty if there is none, or it is too large), and what to do
    after each tick (given monotonic s).
    """
    known, table = mind.known, config.learn.snapshot if config.learn else None
    if mind.predictor:
        asked, kernel = len(mind.predictor.horde.questions), mind.predictor.kernel
        _log.info("%d GVFs learn with the kernel %s", asked, kernel)
    path = snapshot_path(table, name, os.environ) if table else None
    if known is None or table is None or path is None:
        yield b"", lambda _: None
        return
    goes_on = resume(path, known)
    _log.info("Learning goes on from %s" if goes_on else "Nothing is known yet; learning is kept in %s", path)
    carried = _carried(path) if goes_on else b""
    with Keeper(path, table.every_s) as keeper:
        kept = Learned(mind, known, keeper, config.arm, clock)
        try:
            yield carried, kept.chore
        finally:
            kept.close()


def in_effect(config: Config, mind: Mind) -> Config:
    """The config as a recording tells it: with the very snapshots that its advisers were made of."""
    if config.learn is None or mind.predictor is None:
        return config
    return config.model_copy(update={"learn": config.learn.of(mind.predictor.advice.digests)})


def snapshot_path(table: SnapshotTable, name: str, environment: Mapping[str, str]) -> Path | None:
    """Where the learners of the config `name` are kept; None: nowhere, as neither has a name."""
    if table.path or not name:
        return table.path
    return default_folder(environment).with_name("learned") / f"{Path(name).stem}.snapshot"


def _carried(path: Path) -> bytes:
    found = path if path.exists() else path.with_name(f"{path.name}.1")
    if found.stat().st_size > MOST_CARRIED:
        _log.warning("The snapshot %s is too large for a recording, whose replay will need it.", found)
        return b""
    return found.read_bytes()
