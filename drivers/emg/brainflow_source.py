"""A source of muscle signals: boards that BrainFlow knows (OpenBCI, gForce, Callibri and others)."""

from collections import deque
from collections.abc import AsyncIterator, Iterator, Sequence
from contextlib import asynccontextmanager, contextmanager, suppress
from functools import partial
from pathlib import Path
from time import sleep

import numpy as np
from brainflow import board_shim
from brainflow.exit_codes import BrainFlowError, BrainFlowExitCodes
from numpy.typing import NDArray

from bentod.contracts import Clock, EmgConfig
from bentod.errors import ConfigError, InputFileError, nearest
from bentod.frames import EmgBlock
from drivers.emg.brainflow_options import Options
from drivers.emg.options import parse
from drivers.emg.package_counter import PackageCounter
from drivers.emg.reader_thread import Threaded, reading
from drivers.emg.timeline import Timeline

RATE_SHARE = 0.02
"""By which share the config's rate may differ from the board's nominal one. The config's is then the true
one, as it was measured: BrainFlow knows whole numbers only, and the clock of a small board may miss 1 %."""

KEPT_S = 10.0
"""s of samples that BrainFlow keeps for us; older ones it overwrites. A longer gap is not believed."""

NEEDS_MASTER = (board_shim.BoardIds.PLAYBACK_FILE_BOARD, board_shim.BoardIds.STREAMING_BOARD)
"""Boards that are no device, and deliver what another one delivered."""

MEANINGS = {
    BrainFlowExitCodes.UNABLE_TO_OPEN_PORT_ERROR: "the way to it cannot be opened; is it plugged in, and "
    "may the user of this process use the port?",
    BrainFlowExitCodes.BOARD_NOT_READY_ERROR: "it does not answer; is it switched on, and near?",
    BrainFlowExitCodes.SYNC_TIMEOUT_ERROR: "it does not answer in time; is it switched on, and near?",
    BrainFlowExitCodes.INVALID_ARGUMENTS_ERROR: "what it needs to be found is missing or wrong, e.g. "
    "serial_port, mac_address or file",
    BrainFlowExitCodes.UNSUPPORTED_BOARD_ERROR: "BrainFlow does not support it on this machine, or it has no "
    "such stream",
    BrainFlowExitCodes.ANOTHER_BOARD_IS_CREATED_ERROR: "an earlier session with it is not over yet",
}
"""What BrainFlow's exit codes mean that a cable or a config can cause."""


class Session:
    """A board that streams into BrainFlow's buffer, which is emptied every `block_s`.

    BrainFlow has no call that waits for samples. Its time stamps say when the computer got around to a
    package, in bursts, and are not used.
    """

    def __init__(self, options: Options, config: EmgConfig, clock: Clock) -> None:
        self._title = title(options)
        self._clock = clock
        self._pause = options.block_s
        self._volts_per_unit = options.volts_per_unit
        self._preset = board_shim.BrainFlowPresets[f"{options.preset.upper()}_PRESET"]
        with _told(self._title):
            board_shim.BoardShim.disable_board_logger()  # it would write to our standard error
            self._ours = False  # the session that the library knows by the parameters of this board
            self._board = board_shim.BoardShim(_board(options.board, "board"), _way(options))
        try:
            with _told(self._title):
                self._prepare(options, config)
        except BaseException:
            self.close()
            raise

    def _prepare(self, options: Options, config: EmgConfig) -> None:
        self.rate_hz = config.rate_hz
        self._rows = _rows(self._board.get_board_id(), self._preset, options, config)
        self._number = _number(self._board.get_board_id(), self._preset)
        self.channels = len(self._rows)
        self._timeline = Timeline(self.rate_hz)
        self._counter = PackageCounter()
        self._blocks: deque[EmgBlock] = deque()
        self._board.prepare_session()
        self._ours = True
        for command in options.commands:
            self._board.config_board(command)
        self._board.start_stream(round(KEPT_S * self.rate_hz))

    def read(self) -> EmgBlock | None:
        """The next block, up to a gap if there is one."""
        if not self._blocks:
            sleep(self._pause)
            with _told(self._title):
                waits = self._board.get_board_data_count(self._preset)
                data = self._board.get_board_data(preset=self._preset) if waits else None
            if data is not None:
                self._blocks.extend(self._cut(data, self._clock.now()))
        if self._timeline.trouble:
            raise InputFileError(f"{self._title} {self._timeline.trouble}.")
        return self._blocks.popleft() if self._blocks else None

    def _cut(self, data: NDArray[np.float64], arrival: float) -> Iterator[EmgBlock]:
        """`data`, shape (rows, samples), as blocks without gaps."""
        samples = (data[self._rows].T * self._volts_per_unit).astype(np.float32)
        gaps = [] if self._number is None else self._counter.gaps(data[self._number].tolist())
        if not gaps or gaps[0][0]:
            gaps.insert(0, (0, 0))
        ends = [place for place, _ in gaps[1:]] + [len(samples)]
        for (place, lost), end in zip(gaps, ends, strict=True):
            if lost > KEPT_S * self.rate_hz:
                raise InputFileError(f"{self._title} left out {lost} samples; was it restarted?")
            first, time = self._timeline.place(end - place, arrival, lost)
            yield EmgBlock(first, time, samples[place:end], lost)

    def close(self) -> None:
        """Stop the board and let go of it.

        The library knows sessions by their parameters, and whenever this object happens to be deleted it
        releases the one with the same, even if that is another by then: so it is told that it has no board.
        """
        if self._ours:
            with suppress(BrainFlowError):
                self._board.release_session()
        self._board.board_id = board_shim.BoardIds.NO_BOARD.value


def title(options: Options) -> str:
    """How sentences about the board begin."""
    return f"BrainFlow's board {options.board}"


@asynccontextmanager
async def open_emg(config: EmgConfig, clock: Clock) -> AsyncIterator[Threaded]:
    """Open a board; the options are those of `Options`.

    Raises:
        ConfigError: an option is unknown or out of bounds, there is no such board, or its rate is another.
        InputFileError: the board cannot be used.
    """
    options = parse(Options, config.options)
    session = partial(Session, options, config, clock)
    async with reading(session, title(options), options.buffer_s, options.timeout_s) as source:
        yield source


def _board(given: int | str, key: str) -> int:
    """The id of a board by its id or name."""
    ids: dict[str, int] = {board.name: board.value for board in board_shim.BoardIds}
    name = str(given).upper()
    found = [
        number for known, number in ids.items() if name in (known, known.removesuffix("_BOARD"), str(number))
    ]
    if not found:
        raise ConfigError(f"BrainFlow knows no board '{given}'{nearest(name, ids)}", key)
    return found[0]


def _way(options: Options) -> board_shim.BrainFlowInputParams:
    """What BrainFlow needs to find the board."""
    way = board_shim.BrainFlowInputParams()
    for key in ("serial_port", "mac_address", "ip_address", "ip_port", "other_info", "serial_number"):
        setattr(way, key, getattr(options, key))
    way.file = str(Path(options.file).expanduser()) if options.file else ""
    way.ip_protocol = ("none", "udp", "tcp").index(options.ip_protocol)
    way.timeout = options.search_s
    if options.master_board is not None:
        way.master_board = _board(options.master_board, "master_board")
    elif _board(options.board, "board") in NEEDS_MASTER:
        raise ConfigError(f"{title(options)} needs 'master_board': whose samples they were.", "master_board")
    return way


def _rows(board: int, preset: int, options: Options, config: EmgConfig) -> list[int]:
    """Rows of the data that are channels, and a check of the board against the config."""
    nominal = board_shim.BoardShim.get_sampling_rate(board, preset)
    if abs(nominal - config.rate_hz) > RATE_SHARE * nominal:
        raise ConfigError(
            f"{title(options)} samples at {nominal:g} Hz, but the config's rate_hz is {config.rate_hz:g} Hz; "
            f"they may differ by {RATE_SHARE:.0%}.",
            "rate_hz",
        )
    rows = list(options.rows or _emg_rows(board, preset, options))
    most = board_shim.BoardShim.get_num_rows(board, preset)
    if max(rows) >= most:
        raise ConfigError(f"{title(options)} has rows 0 to {most - 1}; 'rows' asks for {max(rows)}.", "rows")
    if len(rows) < config.channels:
        raise InputFileError(
            f"{title(options)}: it has {len(rows)} channels; the sites need {config.channels}."
        )
    return rows


def _emg_rows(board: int, preset: int, options: Options) -> Sequence[int]:
    try:
        rows: Sequence[int] = board_shim.BoardShim.get_emg_channels(board, preset)
    except BrainFlowError as error:
        raise ConfigError(
            f"{title(options)} has no channels of EMG; name the rows of its data to use with 'rows'.", "rows"
        ) from error
    return rows


def _number(board: int, preset: int) -> int | None:
    """The row in which the board counts its packages; None if it does not."""
    try:
        row: int = board_shim.BoardShim.get_package_num_channel(board, preset)
    except BrainFlowError:
        return None
    return row


@contextmanager
def _told(name: str) -> Iterator[None]:
    """BrainFlow's errors as ours."""
    try:
        yield
    except BrainFlowError as error:
        meaning = MEANINGS.get(error.exit_code, "BrainFlow reports an error")
        raise InputFileError(f"{name}: {meaning} ({error}).") from error
    except OSError as error:
        raise ConfigError(f"{name}: BrainFlow's library cannot be loaded on this machine: {error}") from error
