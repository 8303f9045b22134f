"""`bentod bench`: how late a tick begins on this machine, and which rates it is good for."""

import json
import os
import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path

import click

from bentod import logs
from bentod.cli.configs import read
from bentod.config import Config
from bentod.config_tables import Chosen, Realtime
from bentod.errors import BentodError
from bentod.lateness.machine import described, scheduling
from bentod.lateness.report import Report
from bentod.lateness.trial import ROUNDS, burst, cases, trial, ways

RATES = (30.0, 200.0, 1000.0)


@click.command()
@click.option(
    "--rate",
    "rates",
    multiple=True,
    type=click.FloatRange(1, 5000),
    help="Hz, any number of times; default: 30, 200, 1000.",
)
@click.option("--seconds", default=10.0, type=click.FloatRange(0.1, 3600), help="Of each way to tick.")
@click.option("--load", is_flag=True, help="Also under load: 1000 requests a second, and garbage.")
@click.option("--fifo", default=0, type=click.IntRange(0, 99), help="SCHED_FIFO priority; 0: none.")
@click.option("--cpu", "cpus", multiple=True, type=click.IntRange(0, 1023), help="Core; again for more.")
@click.option("--json", "file", type=click.Path(path_type=Path, dir_okay=False), help="Write it there, too.")
def bench(
    rates: Sequence[float], seconds: float, load: bool, fifo: int, cpus: Sequence[int], file: Path | None
) -> None:
    """Measure how late a tick begins on this machine, at some rates.

    Three ways to tick take turns: a whole daemon with a simulated arm that nobody moves (up to 500 Hz),
    bentod's clock alone, and what most programs do: sleep for a period again and again. Nothing real moves.
    """
    realtime = Realtime(priority=fifo, cpus=tuple(cpus), required=True)
    loads = (False, True) if load else (False,)
    try:
        with logs.setup("ERROR"):
            report = measured(rates or RATES, seconds, loads, realtime)
        if file:
            file.write_text(json.dumps(report.data(), indent=2) + "\n", encoding="utf-8")
    except (BentodError, OSError) as error:
        raise click.ClickException(str(error)) from error
    for line in report.lines():
        click.echo(line)


def measured(rates: Sequence[float], seconds: float, loads: Sequence[bool], realtime: Realtime) -> Report:
    """A trial of every way to tick. Raises ConfigError: `realtime` is refused and required."""
    known = ways(idle_arm())
    chosen = {
        case: partial(burst, known[case.way], case, seconds / ROUNDS, realtime)
        for case in cases(list(known), rates, loads)
    }
    busy = os.getloadavg()[0]
    return Report(described(), scheduling(realtime), busy, trial(chosen, _progress, ROUNDS))


def idle_arm() -> Config:
    """The shipped simulation without bytes and without a wearer: it learns, and nobody moves it."""
    config = read(None)
    options = config.driver.options if config.driver else {}
    plain = Chosen.model_validate({"name": "sim", **options})
    return config.model_copy(update={"driver": plain, "emg": None})


def _progress(what: str) -> None:
    """Shown while it is measured, on a terminal only."""
    if sys.stderr.isatty():
        click.echo(f"\r\x1b[K{what}\r", err=True, nl=False)
