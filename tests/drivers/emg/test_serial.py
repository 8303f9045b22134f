"""A board on a serial port: what it lost, why it is lost, and what it must not be taken for."""

import asyncio
import re
import struct
from collections.abc import AsyncIterator, Callable, Sequence
from contextlib import asynccontextmanager
from pathlib import Path

import numpy as np
import pytest

from bentod.contracts import EmgConfig
from bentod.errors import BusError, ConfigError, InputFileError
from bentod.frames import EmgBlock, Value
from drivers.emg import serial
from drivers.emg.serial import Board, open_emg
from drivers.emg.serial_frames import crc16
from sim.clock import VirtualClock

RATE_HZ = 200.0
CONFIG: dict[str, Value] = {"port": "/dev/ttyACM0", "volts_per_lsb": 1e-6}


def frame(first: int, samples: Sequence[Sequence[int]], version: int = 1) -> bytes:
    counts = np.array(samples, "<i2")
    body = struct.pack("<BBBI", version, counts.shape[1], counts.shape[0], first % 2**32) + counts.tobytes()
    return b"\xa5\x5a" + body + struct.pack("<H", crc16(body))


class Line:
    """A serial port at whose far end a test sits."""

    def __init__(self) -> None:
        self.deliver: Callable[[bytes], None] = lambda data: None
        self.lose: Callable[[str], None] = lambda why: None
        self.closed = False

    def listen(self, on_bytes: Callable[[bytes], None], on_lost: Callable[[str], None]) -> None:
        self.deliver, self.lose = on_bytes, on_lost

    def write(self, data: bytes) -> None:
        raise AssertionError("a board is not spoken to")

    def close(self) -> None:
        self.closed = True

    async def send(self, first: int, seconds: float, rate_hz: float = RATE_HZ, channels: int = 2) -> int:
        """Frames of two samples, at the rate of the board; the index after them."""
        loop = asyncio.get_running_loop()
        begun = loop.time()
        for number in range(round(seconds * rate_hz / 2)):
            await asyncio.sleep(max(0.0, begun + 2 * number / rate_hz - loop.time()))
            rows = [[(first + 2 * number + i) % 1000] * channels for i in (0, 1)]
            self.deliver(frame(first + 2 * number, rows))
        return first + 2 * round(seconds * rate_hz / 2)


@pytest.fixture
def line(monkeypatch: pytest.MonkeyPatch) -> Line:
    line = Line()
    monkeypatch.setattr(serial, "open_serial", lambda port, baud: line)

    async def at_once(function: Callable[..., Line], *arguments: object) -> Line:
        return function(*arguments)

    monkeypatch.setattr(asyncio, "to_thread", at_once)  # virtual time does not wait for threads
    return line


@asynccontextmanager
async def opened(line: Line, first: int = 0, **more: Value) -> AsyncIterator[Board]:
    """A board of which one frame was heard."""
    asyncio.get_running_loop().call_later(0.1, lambda: line.deliver(frame(first, [[1, -1], [2, -2]])))
    async with open_emg(EmgConfig(RATE_HZ, 2, CONFIG | more), VirtualClock()) as board:
        yield board


async def listened(board: Board, blocks: list[EmgBlock]) -> None:
    async for block in board:
        blocks.append(block)


async def broken(board: Board) -> tuple[str, list[EmgBlock]]:
    """Why it broke, and what came before."""
    blocks: list[EmgBlock] = []
    with pytest.raises(InputFileError) as error:
        await listened(board, blocks)
    return str(error.value), blocks


async def test_counts_become_volts_at_indices_that_begin_at_zero(line: Line) -> None:
    async with opened(line, first=77) as board:
        block = await anext(aiter(board))
    assert (block.first_index, block.dropped, board.channels) == (0, 0, 2)
    assert block.samples.dtype == np.float32
    np.testing.assert_allclose(block.samples, [[1e-6, -1e-6], [2e-6, -2e-6]])
    assert line.closed


async def test_what_the_counter_leaps_over_was_dropped_also_where_it_begins_again(line: Line) -> None:
    async with opened(line, first=2**32 - 4) as board:
        line.deliver(frame(3, [[1, 1]]))  # 2^32 - 2 to 2 are missing
        line.deliver(b"garbage" + frame(4, [[1, 1]]))
        _, blocks = await broken(board)
    assert [(block.first_index, block.dropped) for block in blocks] == [(0, 0), (7, 5), (8, 0)]


async def test_times_follow_the_indices_and_not_how_the_line_delivers_them(
    line: Line, clock: VirtualClock
) -> None:
    async with opened(line) as board:
        await line.send(2, 1.0)
        late = [frame(202 + i, [[0, 0]]) for i in range(20)]
        await clock.sleep_until(clock.now() + 0.1)
        line.deliver(b"".join(late))  # the adapter held them up for 0.1 s
        blocks: list[EmgBlock] = []
        task = asyncio.create_task(listened(board, blocks))
        await clock.sleep_until(clock.now() + 0.01)
        task.cancel()
        await asyncio.wait([task])
    start = blocks[-1].time - blocks[-1].first_index / RATE_HZ
    for block in blocks[-19:]:
        assert block.time - block.first_index / RATE_HZ == pytest.approx(start, abs=1e-3)
    assert abs(clock.now() - blocks[-1].time) < 0.05


async def test_a_board_that_falls_silent_or_is_unplugged_says_so(line: Line) -> None:
    async with opened(line, timeout_s=0.3) as board:
        reason, _ = await broken(board)
        assert reason == "The board at /dev/ttyACM0 has sent no frame for 0.3 s."
        with pytest.raises(InputFileError, match=r"no frame for 0\.3 s"):
            await anext(aiter(board))
    async with opened(line) as board:
        line.lose("Serial port /dev/ttyACM0: the line hung up; was the adapter unplugged?")
        assert (await broken(board))[0].endswith("was the adapter unplugged?")


async def test_a_board_that_was_started_anew_or_changed_is_opened_again(line: Line) -> None:
    async with opened(line, first=5000) as board:
        line.deliver(frame(0, [[1, 1]]))
        reason, blocks = await broken(board)
        assert reason == "The board at /dev/ttyACM0 went from sample 5002 to 0; was it started anew?"
        assert len(blocks) == 1
    async with opened(line) as board:
        line.deliver(frame(2, [[1, 1, 1]]))
        assert (await broken(board))[0] == "The board at /dev/ttyACM0 sends 3 channels now; it had 2."


@pytest.mark.parametrize("rate_hz", [180.0, 250.0])
async def test_a_board_that_sends_at_another_rate_is_not_believed(line: Line, rate_hz: float) -> None:
    async with opened(line, buffer_s=10.0) as board:
        sending = asyncio.create_task(line.send(2, 4.0, rate_hz))
        reason, _ = await broken(board)
        sending.cancel()
    told = re.fullmatch(r"The board .* sends (\d+) samples a second; emg.rate_hz is 200 Hz.", reason)
    assert told
    assert float(told[1]) == pytest.approx(rate_hz, rel=0.01)


async def test_a_board_with_a_ceramic_resonator_is_believed_for_ever(line: Line, clock: VirtualClock) -> None:
    async with opened(line) as board:
        blocks: list[EmgBlock] = []
        task = asyncio.create_task(listened(board, blocks))
        await line.send(2, 100.0, 0.9955 * RATE_HZ)
        assert not task.done()
        assert abs(clock.now() - blocks[-1].time) < 0.05
        task.cancel()
        await asyncio.wait([task])


async def test_a_consumer_that_is_too_late_is_told_what_it_lost(line: Line) -> None:
    async with opened(line, buffer_s=0.5) as board:
        await line.send(2, 1.0)
        _, blocks = await broken(board)
    ends = [0, *(block.first_index + 2 for block in blocks[:-1])]
    lost = [block.first_index - end for block, end in zip(blocks, ends, strict=True)]
    assert lost == [block.dropped for block in blocks]
    assert sum(lost) > 50


@pytest.mark.parametrize(
    ("data", "sentence"),
    [
        (b"", r"no frame within 5 s, and nothing else; is it running\?"),
        (b"Hello, world!", r"though 13 bytes came; is 115200 its baud rate\?"),
        (frame(0, [[1]], version=3), r"of version 1, but some of version 3\."),
        (frame(0, [[1]]), r"sends 1 channels; the sites need 2\."),
    ],
)
async def test_a_board_that_is_not_understood_at_the_start_is_refused(
    line: Line, data: bytes, sentence: str
) -> None:
    asyncio.get_running_loop().call_later(0.1, lambda: line.deliver(data))
    with pytest.raises(InputFileError, match=sentence):
        async with open_emg(EmgConfig(RATE_HZ, 2, CONFIG), VirtualClock()):
            pass
    assert line.closed


async def test_a_port_that_cannot_be_opened_is_told_as_the_muscles_own_trouble(
    line: Line, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuses(port: str, baud: int) -> Line:
        raise BusError(f"Serial port {port}: there is no such port; is the adapter plugged in?")

    monkeypatch.setattr(serial, "open_serial", refuses)
    with pytest.raises(InputFileError, match="there is no such port"):
        async with open_emg(EmgConfig(RATE_HZ, 2, CONFIG), VirtualClock()):
            pass


@pytest.mark.parametrize("wrong", [{"volts_per_lsb": 0.0}, {"baudrate": 9600}, {"timeout_s": 60.0}])
async def test_options_are_checked(wrong: dict[str, Value], tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="The EMG option"):
        async with open_emg(EmgConfig(RATE_HZ, 2, CONFIG | wrong), VirtualClock()):
            pass
