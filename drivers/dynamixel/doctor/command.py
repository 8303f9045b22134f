"""`bentod doctor`: the command."""

import asyncio
import json
from pathlib import Path

import click

from bentod.clock import SystemClock
from bentod.errors import BentodError, BusError
from drivers.dynamixel.doctor.text import as_values, lines
from drivers.dynamixel.doctor.visit import Plan, Report, Visit
from drivers.dynamixel.doctor.wanted import load
from drivers.dynamixel.ids import parse_ids
from drivers.dynamixel.latency_timer import LatencyTimer
from drivers.stream import open_serial

BAUDS = (1_000_000, 57_600, 115_200)
"""bit/s: what arms are set to, what servos come with (MX with firmware 1 at 57 142), what other tools set."""

UNHEALTHY, NOTHING = 1, 3
"""Exit codes."""


@click.command()
@click.argument("port")
@click.option("--fix", is_flag=True, help="Mend what is safe to mend; nothing moves, no torque is switched.")
@click.option("--baud", "bauds", type=int, multiple=True, help="Look at this rate only; repeatable.")
@click.option("--ids", callback=parse_ids, default="0-252", show_default=True, help="E.g. 1-5,9.")
@click.option("--config", type=click.Path(path_type=Path, exists=True), help="Compare with this config too.")
@click.option("--rate", type=click.FloatRange(10, 500), default=30.0, show_default=True, help="Ticks, Hz.")
@click.option("--json", "as_json", is_flag=True, help="Print the report as JSON.")
def doctor(
    port: str,
    fix: bool,
    bauds: tuple[int, ...],
    ids: tuple[int, ...],
    config: Path | None,
    rate: float,
    as_json: bool,
) -> None:
    """Look for servos behind PORT, read and measure them, and say what to change and why.

    Exits with 0 if all is well, with 1 if there is something to mend, with 3 if there is no servo or no port.
    """
    try:
        wanted = tuple(load(config, port)) if config else None
        rates = bauds or tuple(dict.fromkeys([*(one.baud for one in wanted or ()), *BAUDS]))
        report = asyncio.run(_visit(port, Plan(rates, ids, wanted, rate, fix)))
    except BentodError as error:
        click.echo(f"bentod: {error}", err=True)
        raise SystemExit(NOTHING if isinstance(error, BusError) else UNHEALTHY) from error
    if as_json:
        click.echo(json.dumps(as_values(report), indent=2))
    if not report.servos:
        rates_text = ", ".join(map(str, rates))
        click.echo(f"bentod: no servo answers on {port} at {rates_text} bit/s; is it powered?", err=True)
        raise SystemExit(NOTHING)
    if not as_json:
        click.echo("\n".join(lines(report)))
    raise SystemExit(0 if report.healthy else UNHEALTHY)


async def _visit(port: str, plan: Plan) -> Report:
    async with SystemClock() as clock:
        visit = Visit(lambda baud: open_serial(port, baud), LatencyTimer(port), clock, _progress)
        return await visit.run(plan)


def _progress(line: str) -> None:
    click.echo(line, err=True)
