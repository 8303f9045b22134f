"""As much of an NI gRPC Device Server as one task of analog inputs needs, from the stubs of NI's package."""

import math
import threading
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from typing import Any

import grpc
import numpy as np
from nidaqmx._stubs import nidaqmx_pb2 as messages
from nidaqmx._stubs import nidaqmx_pb2_grpc as stubs
from numpy.typing import NDArray

CHANNEL_NAMES = 0x1273
"""DAQmx_Task_Channels, in NIDAQmx.h."""

TIMED_OUT = -200284
STEP_V = 2.0**-20
"""A step of the test signal, so that every value is exact as a 32-bit float."""


def signal(first: int, count: int, channels: int) -> NDArray[np.float64]:
    """Samples from `first` on, V, shape (channels, count); no two of 1000 and of all channels are alike."""
    index = np.arange(first, first + count) % 1000
    return np.asarray((index + 1000 * np.arange(channels)[:, np.newaxis]) * STEP_V)


class Device:
    """Dev1 with inputs that are sampled by the machine's clock. Faults are attributes."""

    def __init__(self) -> None:
        self.status = 0
        """What every read ends with."""
        self.silent = False
        """Nothing is sampled: a read waits until its time is over."""
        self.hangs = False
        """A read is not answered before the server ends."""
        self.latency = 0.0
        """s that each read takes on top."""
        self.share = 1.0
        """Of the rate that is asked for: what the device has."""
        self.refuses = 0
        """What making channels ends with."""
        self.calls: list[str] = []
        self.asked: Any = None
        """How the channels were asked for."""
        self.cleared = threading.Event()
        self.over = threading.Event()
        self._channels = 0
        self._rate = math.nan
        self._start = math.nan
        self._taken = 0

    def CreateTask(self, request: Any, context: Any) -> Any:  # noqa: N802 -- these names are NI's
        self.calls.append("CreateTask")
        self.cleared.clear()
        self._taken = 0
        response = messages.CreateTaskResponse(new_session_initialized=True)
        response.task.name = "task"
        return response

    def GetTaskAttributeString(self, request: Any, context: Any) -> Any:  # noqa: N802
        self.calls.append("GetTaskAttributeString")
        names = ", ".join(f"Dev1/ai{number}" for number in range(self._channels))
        value = names if request.attribute_raw == CHANNEL_NAMES else "task"
        return messages.GetTaskAttributeStringResponse(value=value)

    def CreateAIVoltageChan(self, request: Any, context: Any) -> Any:  # noqa: N802
        self.calls.append("CreateAIVoltageChan")
        if self.refuses:
            _fail(context, self.refuses)
        first, _, last = request.physical_channel.removeprefix("Dev1/ai").partition(":")
        self._channels = int(last or first) - int(first) + 1
        self.asked = request
        return messages.CreateAIVoltageChanResponse()

    def CfgSampClkTiming(self, request: Any, context: Any) -> Any:  # noqa: N802
        self.calls.append("CfgSampClkTiming")
        self._rate = request.rate * self.share
        return messages.CfgSampClkTimingResponse()

    def GetTimingAttributeDouble(self, request: Any, context: Any) -> Any:  # noqa: N802
        self.calls.append("GetTimingAttributeDouble")
        return messages.GetTimingAttributeDoubleResponse(value=self._rate)

    def StartTask(self, request: Any, context: Any) -> Any:  # noqa: N802
        self.calls.append("StartTask")
        self._start = time.monotonic()
        return messages.StartTaskResponse()

    def ReadAnalogF64(self, request: Any, context: Any) -> Any:  # noqa: N802
        self.calls.append("ReadAnalogF64")
        count = request.num_samps_per_chan
        due = self._start + (self._taken + count) / self._rate
        self.over.wait(max(0.0, due - time.monotonic()) + self.latency)
        status = self.status
        if self.silent:
            self.over.wait(request.timeout)
            status = TIMED_OUT
        if self.hangs:
            self.over.wait()
        if status:
            return messages.ReadAnalogF64Response(status=status)
        samples = signal(self._taken, count, self._channels)
        self._taken += count
        return messages.ReadAnalogF64Response(read_array=samples.ravel(), samps_per_chan_read=count)

    def ClearTask(self, request: Any, context: Any) -> Any:  # noqa: N802
        self.calls.append("ClearTask")
        self.cleared.set()
        return messages.ClearTaskResponse()

    def GetErrorString(self, request: Any, context: Any) -> Any:  # noqa: N802
        return messages.GetErrorStringResponse(error_string=f"NI's text about\n{request.error_code}.")


def _fail(context: Any, status: int) -> None:
    """End a call as NI's server does."""
    context.set_trailing_metadata((("ni-error", str(status)),))
    context.abort(grpc.StatusCode.UNKNOWN, f"NI's text about\n{status}.")


class Server:
    """The server, on a free port of the loopback; `stop` kills it."""

    def __init__(self, device: Device) -> None:
        self._device = device
        self._pool = ThreadPoolExecutor(4, "NI server")
        self._server = grpc.server(self._pool)
        device.__class__ = type("Servicer", (Device, stubs.NiDAQmxServicer), {})  # every other call: refused
        stubs.add_NiDAQmxServicer_to_server(device, self._server)
        self.address = f"127.0.0.1:{self._server.add_insecure_port('127.0.0.1:0')}"
        self._server.start()

    def stop(self) -> None:
        """End every call, and close the port."""
        stopped = self._server.stop(None)
        self._device.over.set()
        stopped.wait(5)
        self._pool.shutdown()


@contextmanager
def serving(device: Device) -> Iterator[Server]:
    """A server of `device`."""
    server = Server(device)
    try:
        yield server
    finally:
        server.stop()
