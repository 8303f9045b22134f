"""`bentod sim-can`: simulated motor controllers on a CAN bus in software, for programs that open one."""

import asyncio
import signal
import sys
import tomllib
from pathlib import Path

import click
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from bentod.contracts import ArmConfig
from bentod.errors import BadRequest, BentodError, ConfigError
from bentod.frames import JointSpec, Value
from drivers.can.bus import BusLink, open_link
from drivers.can.link import Frame
from drivers.can.options import parse_hardware
from sim.bus_process import Commands
from sim.can.joints import build_axes
from sim.can.network import Network
from sim.can.options import Options, parse_options

GROUP = "239.74.163.2"
"""python-can's own group address for buses in software."""

HELP = "quit | FAULT [NODE] [off]; without a node the fault befalls every controller. Faults: "

WRIST = JointSpec("wrist_rotation", -1.564, 1.571, 1.07, 0.0, {"node": 3, "gear_ratio": 8.0})
"""What is simulated without a config: the wrist of config/wrist.toml."""


class _Joint(BaseModel):
    """What of a joint matters here; the rest of the file is for the daemon."""

    model_config = ConfigDict(frozen=True)

    name: str
    min_rad: float
    max_rad: float
    max_velocity_rad_s: float
    home_rad: float = 0.0
    driver: str = ""
    hardware: dict[str, bool | int | float | str] = Field(default_factory=dict)

    def spec(self) -> JointSpec:
        """The joint as drivers see it."""
        hardware: dict[str, Value] = dict(self.hardware)
        return JointSpec(
            self.name, self.min_rad, self.max_rad, self.max_velocity_rad_s, self.home_rad, hardware
        )


class _Named(BaseModel):
    """A driver's table, as far as its name."""

    name: str


class _File(BaseModel):
    """What of a config file matters here."""

    driver: _Named = _Named(name="")
    drivers: dict[str, _Named] = Field(default_factory=dict)
    joints: tuple[_Joint, ...]

    def on_can(self) -> tuple[JointSpec, ...]:
        """Joints whose driver is one for CAN."""
        tables = {"": self.driver, **self.drivers}
        names = {key: table.name for key, table in tables.items()}
        return tuple(j.spec() for j in self.joints if names.get(j.driver) in ("can", "sim-can"))


def load(path: Path | None) -> tuple[JointSpec, ...]:
    """The joints on CAN in the file at `path`; a wrist without one.

    Raises:
        ConfigError: the file cannot be read, or has no such joints.
    """
    if path is None:
        return (WRIST,)
    try:
        joints = _File.model_validate(tomllib.loads(path.read_text(encoding="utf-8"))).on_can()
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise ConfigError(f"{path}: cannot be read: {error}") from error
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(str(part) for part in first["loc"])
        raise ConfigError(f"{path}: {key}: {first['msg']}.", key) from None
    if not joints:
        raise ConfigError(f"{path}: no joint is on a driver 'can' or 'sim-can'.", "joints")
    return joints


class CanProcess:
    """Axes on a bus that others can open."""

    def __init__(self, config: ArmConfig, options: Options, link: BusLink) -> None:
        self._nodes = [parse_hardware(spec).node for spec in config.joints]
        self._link = link
        self.stopped = asyncio.Event()
        self.network = Network(build_axes(config, options), options.seed, self._speak)
        link.listen(self.network.hear, _tell)

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
                click.echo(HELP + ", ".join(self.network.faults()))
            case [fault]:
                self.network.inject(fault, None, True)
            case [fault, "off"]:
                self.network.inject(fault, None, False)
            case [fault, node]:
                self.network.inject(fault, self._joint(node), True)
            case [fault, node, "off"]:
                self.network.inject(fault, self._joint(node), False)
            case _:
                raise BadRequest(f"'{line.strip()}' is not understood; try 'help'")

    def _joint(self, node: str) -> int:
        if not node.isdecimal() or int(node) not in self._nodes:
            raise BadRequest(f"there is no node '{node}' (there are {', '.join(map(str, self._nodes))})")
        return self._nodes.index(int(node))

    def _speak(self, frame: Frame) -> None:
        try:
            self._link.send(frame)
        except BentodError as error:
            _tell(str(error))


async def serve(config: ArmConfig, options: Options, exit_on_eof: bool) -> None:
    """Run the axes until a signal, `quit` or, if asked, the end of stdin."""
    async with open_link(options) as link:
        process = CanProcess(config, options, link)
        loop = asyncio.get_running_loop()
        for number in (signal.SIGTERM, signal.SIGINT):
            loop.add_signal_handler(number, process.stopped.set)
        if sys.stdin is not None:
            Commands(process.obey, process.stopped.set if exit_on_eof else _nothing).listen()
        click.echo(f"{options.interface} {options.channel} {options.udp_port}")
        try:
            await process.stopped.wait()
        finally:
            process.network.close()


@click.command("sim-can")
@click.option("--config", type=click.Path(path_type=Path), help="Take the joints from this file.")
@click.option("--interface", default="udp_multicast", help="Of python-can.", show_default=True)
@click.option("--channel", default=GROUP, help="Of the interface.", show_default=True)
@click.option("--udp-port", default=43113, help="Of udp_multicast.", show_default=True)
@click.option("--watchdog", default=0.5, help="Seconds without a command; 0: none.", show_default=True)
@click.option("--exit-on-eof", is_flag=True, help="Stop when stdin ends.")
def sim_can(
    config: Path | None, interface: str, channel: str, udp_port: int, watchdog: float, exit_on_eof: bool
) -> None:
    """Simulate ODrive axes on a CAN bus, by default one that other processes of this machine can open.

    Commands on stdin break and mend the axes; `help` lists them. Without --config it is one wrist, node 3.
    """
    table: dict[str, Value] = {
        "interface": interface,
        "channel": channel,
        "udp_port": udp_port,
        "watchdog_s": watchdog,
    }
    try:
        arm = ArmConfig(load(config), 1 / 30, table)
        asyncio.run(serve(arm, parse_options(arm), exit_on_eof))
    except BentodError as error:
        raise click.ClickException(str(error)) from error


def _nothing() -> None:
    """The end of stdin is no reason to stop."""


def _tell(trouble: str) -> None:
    click.echo(trouble, err=True)


if __name__ == "__main__":
    sim_can()
