"""What a config may say about a National Instruments converter."""

from typing import Annotated, Literal

from pydantic import Field

from drivers.emg.options import Table
from drivers.emg.pacing import BLOCK_S, BUFFER_S
from drivers.emg.reader_thread import SILENT_S

HOST_AND_PORT = r"^([A-Za-z0-9._-]+|\[[0-9A-Fa-f:.]+\]):[0-9]{1,5}$"


class Options(Table):
    """One task that reads analog inputs. The words are those of NI MAX."""

    channels: Annotated[str, Field(min_length=1, max_length=1000)]
    """Physical channels, e.g. "Dev1/ai0:3"; one channel of EMG each, in this order."""

    terminal: Literal["DIFF", "RSE", "NRSE", "PSEUDO_DIFF"] = "DIFF"
    """Terminal configuration. A bipolar electrode is a difference, and so is its amplifier's output."""

    range_v: Annotated[float, Field(ge=0.001, le=42.0)] = 5.0
    """V; inputs from minus this to plus this. The device takes the next wider range that it has."""

    block_s: Annotated[float, Field(ge=0.001, le=0.05)] = BLOCK_S
    """Length of a block as it is read; NI advises against more than some 100 reads a second."""

    buffer_s: Annotated[float, Field(ge=0.05, le=10.0)] = BUFFER_S
    """How late a consumer may be before blocks are dropped."""

    timeout_s: Annotated[float, Field(ge=0.1, le=10.0)] = SILENT_S
    """s without a sample after which the source has broken."""

    grpc: Annotated[str, Field(pattern=HOST_AND_PORT)] | None = None
    """ "host:port" of an NI gRPC Device Server that has the device; by default it is on this machine."""
