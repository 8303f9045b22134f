"""Sound through other programs: whatever they do, nobody waits for them, and none is left behind."""

import asyncio
import logging
from collections.abc import Callable
from itertools import count
from pathlib import Path

import pytest

from drivers.audio import player as player_module
from drivers.audio import stream
from drivers.audio.player import open_player
from tests.drivers.audio.programs import Programs, alive

pytestmark = pytest.mark.real_time

LISTENS = "cat /dev/stdin > $out"
HANGS = "echo $$ > $out; exec sleep 60"


@pytest.fixture
def programs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Programs:
    return Programs(tmp_path, monkeypatch)


async def eventually(condition: Callable[[], bool]) -> None:
    async with asyncio.timeout(10):
        while not condition():  # noqa: ASYNC110 -- there is no event for what a process has done
            await asyncio.sleep(0.005)


@pytest.mark.parametrize(
    ("name", "words"),
    [("pw-play", "/dev/stdin"), ("paplay", "/dev/stdin"), ("aplay", "-q /dev/stdin")],
)
async def test_each_program_gets_the_whole_sound(programs: Programs, name: str, words: str) -> None:
    programs.add(name, LISTENS)
    async with open_player() as player:
        player.play(b"RIFF, a sound" * 10_000)
        await eventually(lambda: len(programs.heard(name)) == 130_000)
    assert programs.calls() == [f"{name} {words}"]


async def test_the_newest_sound_ends_the_one_before(programs: Programs) -> None:
    programs.add("aplay", f"read -r what; if [ $what = long ]; then {HANGS}; fi; echo $what > $out")
    async with open_player() as player:
        player.play(b"long\n")
        await eventually(lambda: programs.heard("aplay").strip().isdigit())
        pid = int(programs.heard("aplay"))
        player.play(b"skipped\n")
        player.play(b"newest\n")
        await eventually(lambda: programs.heard("aplay") == b"newest\n")
        assert not alive(pid)
    assert len(programs.calls()) == 2


async def test_a_program_that_fails_is_replaced_by_the_next_and_told_of_once(
    programs: Programs, caplog: pytest.LogCaptureFixture
) -> None:
    programs.add("pw-play", "echo no server >&2; exit 1")
    programs.add("aplay", "cat /dev/stdin >> $out")
    with caplog.at_level(logging.INFO):
        async with open_player() as player:
            player.play(b"one")
            await eventually(lambda: programs.heard("aplay") == b"one")
            await eventually(lambda: "are heard" in caplog.text)
            player.play(b"two")
            await eventually(lambda: programs.heard("aplay") == b"onetwo")
    assert [call.split()[0] for call in programs.calls()] == ["pw-play", "aplay", "aplay"]
    assert [r.message for r in caplog.records if r.levelno >= logging.WARNING] == [
        "sounds: pw-play does not play: no server"
    ]


async def test_where_all_fail_each_is_told_of_once_and_nothing_breaks(
    programs: Programs, caplog: pytest.LogCaptureFixture
) -> None:
    programs.add("paplay", "exit 3")
    programs.add("aplay", "exit 1")
    async with open_player() as player:
        for times in range(1, 4):
            player.play(b"one")
            await eventually(lambda: len(programs.calls()) == 2 * times)  # noqa: B023 -- called at once
            await asyncio.sleep(0.02)
    assert [record.message for record in caplog.records] == [
        "sounds: paplay does not play: it ended with 3",
        "sounds: aplay does not play: it ended with 1",
    ]


async def test_a_program_that_hangs_is_ended(
    programs: Programs, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(player_module, "LONGEST", 0.2)
    programs.add("aplay", HANGS)
    async with open_player() as player:
        player.play(b"one")
        await eventually(lambda: "it hangs" in caplog.text)
        assert not alive(int(programs.heard("aplay")))


async def test_at_the_end_nothing_is_left_behind(programs: Programs) -> None:
    programs.add("aplay", f"sleep 60 & {HANGS}")
    async with open_player() as player:
        player.play(b"one")
        player.hum(lambda: bytes(2048), 22_050)
        await eventually(lambda: len(programs.calls()) == 2 and programs.heard("aplay") != b"")
        pid = int(programs.heard("aplay"))
        assert alive(pid)
    assert not alive(pid)


async def test_a_machine_without_any_is_silent_and_says_so(
    programs: Programs, caplog: pytest.LogCaptureFixture
) -> None:
    async with open_player() as player:
        player.play(b"one")
        player.hum(lambda: bytes(2048), 22_050)
        await asyncio.sleep(0.02)
    assert [record.message for record in caplog.records] == [
        "There is no pw-play, paplay or aplay on the path: nothing will be heard."
    ]


async def test_the_tone_is_heard_whole_and_no_sooner_than_it_sounds(programs: Programs) -> None:
    programs.add("aplay", LISTENS)
    numbers = count()
    begun = asyncio.get_running_loop().time()
    async with open_player() as player:
        player.hum(lambda: next(numbers).to_bytes(2, "little") * 1024, 22_050)
        await eventually(lambda: len(programs.heard("aplay")) >= 10 * 2048)
        elapsed = asyncio.get_running_loop().time() - begun
        heard = programs.heard("aplay")
    assert programs.calls() == ["aplay -q -t raw -f S16_LE -c 1 -r 22050 -B 100000"]
    assert heard == b"".join(number.to_bytes(2, "little") * 1024 for number in range(30))[: len(heard)]
    assert elapsed > 9 * 1024 / 22_050 / stream.AHEAD - stream.LEAD - 0.02


async def test_a_program_that_stops_taking_the_tone_is_replaced(
    programs: Programs, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(stream, "HANGS", 0.2)
    monkeypatch.setattr(stream, "RETRY", (0.01, 1.0))
    programs.add("paplay", HANGS)
    programs.add("aplay", LISTENS)
    asked = count()
    async with open_player() as player:
        player.hum(lambda: bytes(2048) if next(asked) < 10**6 else b"", 22_050)
        await eventually(lambda: len(programs.heard("aplay")) > 4096)
        assert not alive(int(programs.heard("paplay")))
    assert caplog.messages == [
        "the quiet tones: paplay does not play: it took nothing for 0.2 s, and was ended"
    ]
    assert next(asked) < 100  # while it hung, no more was made than it had room for


async def test_a_program_that_dies_is_tried_again_after_a_while_and_told_of_once(
    programs: Programs, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(stream, "RETRY", (0.02, 0.04))
    programs.add("aplay", "echo no card >&2; exit 1")
    async with open_player() as player:
        player.hum(lambda: bytes(2048), 22_050)
        await eventually(lambda: len(programs.calls()) >= 3)
    assert caplog.messages == ["the quiet tones: aplay does not play: no card"]


async def test_silence_ends_the_program_and_sound_begins_another(
    programs: Programs, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(stream, "IDLE", 0.1)
    programs.add("aplay", "echo $$ > $out; exec cat > /dev/null")
    loud = True
    async with open_player() as player:
        player.hum(lambda: bytes(2048) if loud else b"", 22_050)
        await eventually(lambda: programs.heard("aplay") != b"")
        first = int(programs.heard("aplay"))
        loud = False
        await eventually(lambda: not alive(first))
        assert len(programs.calls()) == 1
        loud = True
        await eventually(lambda: len(programs.calls()) == 2)
