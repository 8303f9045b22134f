"""A source of muscle signals: analog inputs of National Instruments (USB-6216 and kin) through NI-DAQmx."""

from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import ExitStack, asynccontextmanager, contextmanager, suppress
from functools import partial
from typing import Any

import grpc
import nidaqmx
import numpy as np
from nidaqmx import constants, errors, stream_readers

from bentod.contracts import Clock, EmgConfig
from bentod.errors import ConfigError, InputFileError
from bentod.frames import EmgBlock
from drivers.emg.nidaqmx_options import Options
from drivers.emg.options import parse
from drivers.emg.reader_thread import Threaded, reading
from drivers.emg.timeline import Timeline

OPENING_S = 3.0
"""s that each call may take until the task runs: devices are reserved, set up and started meanwhile."""

RATE_SHARE = 0.01
"""By which share the device's rate, its time base divided by a whole number, may miss that of the config."""

GRACE_S = 0.25
"""s that a network may take on top of `timeout_s`, and then our thread: who knows most speaks first."""

MEANINGS = {
    -200284: "no sample came in time",
    -200279: "samples were overwritten before they were read; this machine, or the way to it, is too slow",
    -200220: "there is no such device; NI MAX or nilsdev tell what there is",
    -200170: "the device has no such channel",
    -200332: "the device cannot sample so fast",
    -200081: "the device cannot sample so many channels so fast",
    -200077: "the device does not have one of the settings",
    -200045: "the device was unplugged",
    -88709: "the device was unplugged, or reset",
    -88710: "the device was unplugged, or reset",
    -50103: "another task holds the device, in another program or not quite closed yet",
}
"""What NI's codes mean that a cable, a config or a load can cause; the names are in `nidaqmx.error_codes`."""


class Deadline(grpc.UnaryUnaryClientInterceptor):  # type: ignore[misc]  # gRPC has no types
    """Ends each call in time, or a server behind a cable that was cut would be waited for for ever.

    A deadline in the channel's service config does not do: when it is about a second or less, the first
    call finds that it has passed.
    """

    def __init__(self) -> None:
        self.seconds = OPENING_S

    def intercept_unary_unary(
        self, go_on: Callable[[object, object], object], call: Any, sent: object
    ) -> object:
        """Go on with the call, as gRPC asks."""
        return go_on(call._replace(timeout=self.seconds), sent)


class Task:
    """A task of NI-DAQmx, which samples by the device's clock into the driver's buffer until it is closed.

    Read with a stream reader, because `Task.read` asks for properties of the task at each call; one read is
    one call. No event of the driver is used: it would come in a thread of the driver.
    """

    def __init__(self, options: Options, config: EmgConfig, clock: Clock, closing: ExitStack) -> None:
        deadline = Deadline()
        task = closing.enter_context(_task(options, closing, deadline))
        limits = {"min_val": -options.range_v, "max_val": options.range_v}
        terminal = constants.TerminalConfiguration[options.terminal]
        task.ai_channels.add_ai_voltage_chan(options.channels, terminal_config=terminal, **limits)
        self.channels = len(task.channel_names)
        continuous = constants.AcquisitionType.CONTINUOUS
        buffered = max(1, round(options.buffer_s * config.rate_hz))  # samples; the driver may keep more
        task.timing.cfg_samp_clk_timing(config.rate_hz, sample_mode=continuous, samps_per_chan=buffered)
        self.rate_hz = float(task.timing.samp_clk_rate)
        _check(options, config, self.rate_hz, self.channels)
        self._title = title(options)
        self._timeout = options.timeout_s
        self._closing = closing
        self._clock = clock
        self._timeline = Timeline(self.rate_hz)
        self._reader = stream_readers.AnalogMultiChannelReader(task.in_stream)
        self._reader.verify_array_shape = False  # it asks the driver for the shape at each read
        self._volts = np.empty((self.channels, max(1, round(options.block_s * self.rate_hz))))
        task.start()
        deadline.seconds = options.timeout_s + GRACE_S

    def read(self) -> EmgBlock:
        """The next block: at once if it waits in the driver's buffer, else when its last sample is taken."""
        with _told(self._title):
            count = self._reader.read_many_sample(self._volts, self._volts.shape[1], self._timeout)
        samples = self._volts.T[:count].astype(np.float32)
        first, time = self._timeline.place(count, self._clock.now())
        if self._timeline.trouble:
            raise InputFileError(f"{self._title} {self._timeline.trouble}.")
        return EmgBlock(first, time, samples)

    def close(self) -> None:
        """Abort the task and let go of the device."""
        _close(self._closing)


def title(options: Options) -> str:
    """How sentences about the device begin."""
    return f"NI {options.channels}" + (f" at {options.grpc}" if options.grpc else "")


@asynccontextmanager
async def open_emg(config: EmgConfig, clock: Clock) -> AsyncIterator[Threaded]:
    """Open inputs of a device; the options are those of `Options`.

    Raises:
        ConfigError: an option is unknown or out of bounds, the driver is not installed, or the rate is not
            one that the device has.
        InputFileError: the device cannot be used.
    """
    options = parse(Options, config.options)
    silent_s = options.timeout_s + 2 * GRACE_S
    async with reading(
        partial(_open, options, config, clock), title(options), options.buffer_s, silent_s
    ) as it:
        yield it


def _open(options: Options, config: EmgConfig, clock: Clock) -> Task:
    closing = ExitStack()
    try:
        with _told(title(options)):
            return Task(options, config, clock, closing)
    except BaseException:
        _close(closing)
        raise


def _close(closing: ExitStack) -> None:
    with suppress(errors.Error):  # a device that broke cannot be given back
        closing.close()


def _task(options: Options, closing: ExitStack, deadline: Deadline) -> nidaqmx.Task:
    if options.grpc is None:
        return nidaqmx.Task()
    channel = closing.enter_context(grpc.insecure_channel(options.grpc))
    hurried = grpc.intercept_channel(channel, deadline)
    return nidaqmx.Task(grpc_options=nidaqmx.GrpcSessionOptions(hurried, ""))


def _check(options: Options, config: EmgConfig, rate_hz: float, channels: int) -> None:
    if abs(rate_hz - config.rate_hz) > RATE_SHARE * config.rate_hz:
        raise ConfigError(
            f"{title(options)} samples at {rate_hz:g} Hz, but the config's rate_hz is {config.rate_hz:g} Hz; "
            f"they may differ by {RATE_SHARE:.0%}.",
            "rate_hz",
        )
    if channels < config.channels:
        raise InputFileError(
            f"{title(options)}: it has {channels} channels; the sites need {config.channels}."
        )


@contextmanager
def _told(name: str) -> Iterator[None]:
    """NI's errors as ours."""
    try:
        yield
    except (errors.DaqNotFoundError, errors.DaqNotSupportedError) as error:
        raise ConfigError(
            f"{name}: the driver NI-DAQmx is not installed on this machine. Install it from NI, or with "
            "`python -m nidaqmx installdriver`, or name the machine that has it with 'grpc'.",
            "grpc",
        ) from error
    except errors.DaqError as error:
        meaning = MEANINGS.get(error.error_code) or " ".join(str(error).split())[:300].rstrip(".")
        raise InputFileError(f"{name}: {meaning} (NI-DAQmx {error.error_code}).") from error
    except errors.RpcError as error:
        raise InputFileError(f"{name}: the NI gRPC Device Server does not answer ({error}).") from error
