"""What a config may say about a board that BrainFlow knows."""

from typing import Annotated, Literal, TypeAlias

from pydantic import Field

from drivers.emg.options import Table
from drivers.emg.pacing import BLOCK_S, BUFFER_S
from drivers.emg.reader_thread import SILENT_S

Text: TypeAlias = Annotated[str, Field(max_length=1000)]
Board: TypeAlias = (
    Annotated[int, Field(ge=-100, le=10_000)] | Annotated[str, Field(min_length=1, max_length=100)]
)
Row: TypeAlias = Annotated[int, Field(ge=0, le=1023)]


class Options(Table):
    """A board and the way to it. Names of boards and of the way are BrainFlow's, from "Supported Boards"."""

    board: Board
    """Name or id, e.g. "GFORCE_PRO_BOARD", "cyton" or 16."""

    preset: Literal["default", "auxiliary", "ancillary"] = "default"
    """Which of the board's streams."""

    rows: Annotated[tuple[Row, ...], Field(min_length=1, max_length=256)] | None = None
    """Rows of the board's data that are channels here, in this order; by default its EMG channels."""

    volts_per_unit: Annotated[float, Field(ge=1e-12, le=1e3)] = 1e-6
    """Volts that 1 from the board stands for. BrainFlow gives microvolts "wherever possible"."""

    commands: Annotated[tuple[Text, ...], Field(max_length=64)] = ()
    """What the board is told before it streams, e.g. gains; each as BrainFlow's `config_board` takes it."""

    serial_port: Text = ""
    mac_address: Text = ""
    ip_address: Text = ""
    ip_port: Annotated[int, Field(ge=0, le=65_535)] = 0
    ip_protocol: Literal["none", "udp", "tcp"] = "none"
    other_info: Text = ""
    serial_number: Text = ""
    file: Text = ""
    """For the board that plays a file."""

    master_board: Board | None = None
    """The board that a file or a stream comes from."""

    search_s: Annotated[int, Field(ge=0, le=14)] = 0
    """s that BrainFlow looks for a wireless board (its `timeout`); 0: as long as it thinks right."""

    block_s: Annotated[float, Field(ge=0.001, le=0.05)] = BLOCK_S
    """s between two looks for new samples."""

    buffer_s: Annotated[float, Field(ge=0.05, le=10.0)] = BUFFER_S
    """How late a consumer may be before blocks are dropped."""

    timeout_s: Annotated[float, Field(ge=0.1, le=10.0)] = SILENT_S
    """s without a sample after which the source has broken."""
