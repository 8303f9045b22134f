"""From a daemon's socket to what is played, in virtual time."""

import asyncio
from collections.abc import AsyncIterator, Callable, Sequence
from contextlib import asynccontextmanager, suppress
from functools import partial
from pathlib import Path
from typing import cast

import pytest

from bentod.client import Client
from bentod.config import Config
from bentod.config_voice import Voice
from bentod.errors import ConfigError
from bentod.voice import narrator
from bentod.voice.narrator import Narrator
from tests.rig import PLAIN, quiet_config, running, tables


class Speaker:
    """Where sound would come out; keeps the events that were played, and what hums."""

    def __init__(self) -> None:
        self.played: list[str] = []
        self.source: Callable[[], bytes] | None = None

    def play(self, wav: bytes) -> None:
        self.played += wav.decode().split()

    def hum(self, source: Callable[[], bytes] | None, rate_hz: int = 0) -> None:
        self.source = source

    def hums(self) -> bool:
        """Whether there is anything to be heard now."""
        return bool(self.source and [self.source() for _ in range(3)][-1])


class Legible:
    """A renderer whose sounds are the names of events."""

    def __init__(self, table: Voice, joints: Sequence[str]) -> None:
        self.table, self.joints = table, joints

    def events(self) -> list[str]:
        return []

    def wav(self, events: Sequence[str]) -> bytes | None:
        return " ".join(events).encode()

    def pitches(self) -> dict[str, float]:
        return dict.fromkeys(self.joints, 440.0)


@pytest.fixture(autouse=True)
def _legible(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(narrator, "Renderer", Legible)


def config(voice: Voice) -> Config:
    return quiet_config(PLAIN).model_copy(update={"voice": voice})


@asynccontextmanager
async def narrated(socket: Path, table: Voice | None = None) -> AsyncIterator[Speaker]:
    speaker = Speaker()
    task = asyncio.create_task(Narrator(partial(Client.connect, socket), speaker, table).run())
    try:
        yield speaker
    finally:
        task.cancel()
        with suppress(asyncio.CancelledError):
            await task
        assert speaker.source is None


async def said(speaker: Speaker, event: str) -> None:
    """Return once this is the last that was played."""
    async with asyncio.timeout(30):
        while speaker.played[-1:] != [event]:  # noqa: ASYNC110 -- a thread renders, and tells nobody
            await asyncio.sleep(0.05)


async def test_a_toggle_is_told_by_the_name_of_the_joint(tmp_path: Path) -> None:
    socket = tmp_path / "s"
    async with running(config(Voice()), socket) as arm, narrated(socket) as speaker:
        await said(speaker, "joint.shoulder_rotation")
        await arm.call("group_toggle", group="arm")
        await said(speaker, "joint.elbow_flexion")
        await arm.call("stop")
        await said(speaker, "stop")
        await asyncio.sleep(2)
        await arm.call("pause", on=False)
        await said(speaker, "release")
        assert speaker.played == ["joint.shoulder_rotation", "joint.elbow_flexion", "stop", "release"]
        assert speaker.source is None


async def test_a_daemon_that_begins_anew_tells_nothing_twice(tmp_path: Path) -> None:
    socket = tmp_path / "s"
    async with narrated(socket) as speaker:
        async with running(config(Voice()), socket) as arm:
            await said(speaker, "joint.shoulder_rotation")
            await arm.call("trial_start", name="circuit")
            await said(speaker, "trial.start")
        await asyncio.sleep(4)
        async with running(config(Voice()), socket) as arm:
            await asyncio.sleep(7)
            assert speaker.played.count("joint.shoulder_rotation") == speaker.played.count("trial.start") == 1
            assert "trial.stop" not in speaker.played
            assert speaker.played[-1] == "release"  # it was left limp, and that is different now
            await arm.call("group_toggle", group="hand")
            await said(speaker, "joint.wrist_flexion")


async def test_the_quiet_tone_ends_with_a_pause_and_with_the_link(tmp_path: Path) -> None:
    socket = tmp_path / "s"
    async with narrated(socket) as speaker:
        async with running(config(Voice(cue="tone")), socket) as arm:
            await said(speaker, "joint.shoulder_rotation")
            assert speaker.hums()
            await arm.call("pause")
            await said(speaker, "pause")
            assert not speaker.hums()
            await arm.call("pause", on=False)
            await said(speaker, "release")
            assert speaker.hums()
        await asyncio.sleep(1)
        assert not speaker.hums()


async def test_what_the_config_forbids_is_not_told(tmp_path: Path) -> None:
    socket = tmp_path / "s"
    async with running(config(Voice(enabled=False, cue="tone")), socket) as arm, narrated(socket) as speaker:
        await asyncio.sleep(2)
        await arm.call("group_toggle", group="arm")
        await asyncio.sleep(2)
        assert speaker.played == []
        assert speaker.source is None


async def test_a_table_of_its_own_overrules_the_daemons(tmp_path: Path) -> None:
    socket = tmp_path / "s"
    async with running(config(Voice(enabled=False)), socket), narrated(socket, Voice(cue="tone")) as speaker:
        await said(speaker, "joint.shoulder_rotation")
        assert speaker.hums()


async def test_the_voice_is_a_client_that_moves_nothing(tmp_path: Path) -> None:
    socket = tmp_path / "s"
    async with running(config(Voice()), socket) as arm, narrated(socket) as speaker:
        await said(speaker, "joint.shoulder_rotation")
        clients = tables({"clients": await arm.call("list_clients")}, "clients")
        assert "voice" in [client["name"] for client in clients]
        frame = cast("dict[str, list[dict[str, object]]]", await arm.call("get_state"))
        assert [joint["holder"] for joint in frame["joints"]] == [""] * 5


async def test_it_ends_where_somebody_else_could_be_listening(tmp_path: Path) -> None:
    def connect() -> AsyncIterator[Client]:
        raise ConfigError("it belongs to another user")

    with pytest.raises(ConfigError, match="another user"):
        await Narrator(connect, Speaker()).run()  # type: ignore[arg-type]  # it never gets that far
