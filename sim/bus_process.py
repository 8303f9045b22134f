"""`bentod sim-bus`: a simulated servo bus behind a pseudo-terminal, for tools that open a serial port."""

import asyncio
import contextlib
import os
import selectors
import signal
import sys
from collections.abc import Callable
from pathlib import Path

import click

from bentod.contracts import ArmConfig
from bentod.errors import BadRequest, BentodError
from drivers.dynamixel.options import parse_hardware
from sim import bus_config
from sim.bento import build_arm, build_bus
from sim.line import Line
from sim.options import parse_options
from sim.terminal import Terminal

BEAT = 0.01
"""s between two advances of servos that nobody talks to."""

CATCH_UP = 0.1
"""s simulated at most for one request, so that a process that was held up does not miss a deadline too."""

PTY_LATENCY = 0.001
"""s that the pseudo-terminal and two processes take anyway, about as much as a quick USB adapter."""

HELP = """pull, plug        the cable
FAULT [ID] [off]  begin or end a fault, of one servo or of all
answer ID         the same as 'silent ID off'
quit
Faults: """


class BusProcess:
    """An arm, its line and its port."""

    def __init__(self, config: ArmConfig, link: Path | None, timing: bool) -> None:
        options = parse_options(config)
        self._ids = [parse_hardware(spec).id for spec in config.joints]
        self._loop = asyncio.get_running_loop()
        self._baud = options.baud
        self.arm = build_arm(config, options, self._loop.time())
        self.arm.catch_up = CATCH_UP
        bus = build_bus(self.arm, config, options, timing)
        latency = max(options.usb_latency_s - PTY_LATENCY, 0.0)
        self._line = Line(bus, self.arm, f"{options.seed}/line", latency)
        self._terminal = Terminal(link, self._request)
        self.stopped = asyncio.Event()
        self.arm.watch_cable(self._cable)

    async def run(self) -> None:
        """Serve until `stopped` is set."""
        try:
            self._plug()
            while not self.stopped.is_set():
                self.arm.advance(self._loop.time())
                await self._pause()
        finally:
            self._line.close()
            self._terminal.pull()

    async def _pause(self) -> None:
        """Return after a beat, or at once when it is time to stop."""
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(BEAT):
                await self.stopped.wait()

    def obey(self, line: str) -> None:
        """Carry out one line from stdin.

        Raises:
            BadRequest: it is not understood.
        """
        match line.split():
            case []:
                return
            case ["quit"]:
                self.stopped.set()
            case ["help"]:
                click.echo(HELP + ", ".join(self.arm.faults()))
            case ["pull" | "plug" as verb]:
                self.arm.inject("cable", None, verb == "pull")
            case ["answer", servo]:
                self.arm.inject("silent", self._joint(servo), False)
            case [fault, *rest] if len(rest) <= 2:
                on = rest[-1:] != ["off"]
                self._inject(fault, rest if on else rest[:-1], on)
            case _:
                raise BadRequest(f"'{line.strip()}' is not understood; try 'help'")

    def _inject(self, fault: str, servos: list[str], on: bool) -> None:
        if len(servos) > 1:
            raise BadRequest("one servo at a time, and 'off' to end a fault")
        self.arm.inject(fault, self._joint(servos[0]) if servos else None, on)

    def _joint(self, servo: str) -> int:
        if not servo.isdecimal() or int(servo) not in self._ids:
            raise BadRequest(f"there is no servo '{servo}' (there are {', '.join(map(str, self._ids))})")
        return self._ids.index(int(servo))

    def _request(self, data: bytes) -> None:
        self._line.bus.baud = self._terminal.baud() or self._baud
        self._line.write(data)

    def _cable(self, plugged: bool) -> None:
        if plugged:
            self._plug()
        else:
            self._terminal.pull()

    def _plug(self) -> None:
        self._line.listen(self._terminal.write, _unheard)
        click.echo(self._terminal.plug())


class Commands:
    """Lines from stdin."""

    def __init__(self, obey: Callable[[str], None], on_end: Callable[[], None]) -> None:
        self._obey = obey
        self._on_end = on_end
        self._begun = b""
        self._fd = sys.stdin.fileno()

    def readable(self) -> None:
        """Take what is there."""
        data = os.read(self._fd, 4096)
        if not data:
            asyncio.get_running_loop().remove_reader(self._fd)
            self._on_end()
            return
        *lines, self._begun = (self._begun + data).split(b"\n")
        for line in lines:
            self._try(line.decode(errors="replace"))

    def listen(self) -> None:
        """Begin to obey."""
        asyncio.get_running_loop().add_reader(self._fd, self.readable)

    def _try(self, line: str) -> None:
        try:
            self._obey(line)
        except BadRequest as error:
            click.echo(f"{error}", err=True)


async def serve(config: ArmConfig, link: Path | None, timing: bool, exit_on_eof: bool) -> None:
    """Run the bus until a signal, `quit` or, if asked, the end of stdin."""
    process = BusProcess(config, link, timing)
    loop = asyncio.get_running_loop()
    for number in (signal.SIGTERM, signal.SIGINT):
        loop.add_signal_handler(number, process.stopped.set)
    if sys.stdin is not None:
        Commands(process.obey, process.stopped.set if exit_on_eof else _nothing).listen()
    await process.run()


@click.command("sim-bus")
@click.option("--config", type=click.Path(path_type=Path), help="Take the joints from this file.")
@click.option("--link", type=click.Path(path_type=Path), help="Symbolic link to the port, removed at exit.")
@click.option("--seed", type=int, help="Of everything random.")
@click.option("--no-timing", is_flag=True, help="Reply at once instead of after the time on the wire.")
@click.option("--exit-on-eof", is_flag=True, help="Stop when stdin ends.")
def sim_bus(
    config: Path | None, link: Path | None, seed: int | None, no_timing: bool, exit_on_eof: bool
) -> None:
    """Simulate the servos of an arm behind a pseudo-terminal, whose path is the first line printed.

    Servos are those of the config, of either protocol; without --config it is a Bento Arm. Commands on stdin
    break and mend it; `help` lists them.
    """
    try:
        with asyncio.Runner(loop_factory=_precise_loop) as runner:
            runner.run(serve(bus_config.load(config, seed), link, not no_timing, exit_on_eof))
    except BentodError as error:
        raise click.ClickException(str(error)) from error


def _precise_loop() -> asyncio.AbstractEventLoop:
    """A loop with timers finer than the milliseconds of epoll: a byte at 1 Mbit/s takes 10 µs."""
    return asyncio.SelectorEventLoop(selectors.SelectSelector())


def _nothing() -> None:
    """The end of stdin is no reason to stop."""


def _unheard(reason: str) -> None:
    """The terminal has hung up already."""


if __name__ == "__main__":
    sim_bus()
