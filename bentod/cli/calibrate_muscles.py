"""`bentod calibrate emg`: threshold and maximum of each EMG site, from rest and a strong contraction."""

import asyncio
from pathlib import Path

import click

from bentod.calibration.measuring import Plan, apply
from bentod.calibration.muscles import SCATTER, SHARE
from bentod.cli.calibrating_muscles import measure
from bentod.cli.link import ADDRESS, CA_FILE, TOKEN_FILE, Way
from bentod.cli.site_settings import keep
from bentod.endpoint import default_socket_path
from bentod.errors import BentodError, Refused


@click.command()
@ADDRESS
@TOKEN_FILE
@CA_FILE
@click.option("--site", "sites", multiple=True, metavar="NAME", help="Only this site; may be repeated.")
@click.option("--ready", type=click.FloatRange(0, 30), default=3.0, show_default=True, help="s before each.")
@click.option("--rest", type=click.FloatRange(2, 60), default=5.0, show_default=True, help="s of rest.")
@click.option("--hold", type=click.FloatRange(2, 30), default=3.0, show_default=True, help="s of each hold.")
@click.option(
    "--scatter",
    type=click.FloatRange(0, 20),
    default=SCATTER,
    show_default=True,
    help="Standard deviations of rest, from its mean to the threshold.",
)
@click.option(
    "--share",
    type=click.FloatRange(0.2, 1),
    default=SHARE,
    show_default=True,
    help="Of the strongest contraction, where effort is full.",
)
@click.option("--set/--no-set", "sets", default=True, show_default=True, help="Change the running daemon.")
@click.option("--write", type=click.Path(path_type=Path), metavar="FILE", help="Change this config, too.")
@click.option("--yes", is_flag=True, help="Do not ask first.")
def emg(
    socket: str | None,
    token_file: Path | None,
    ca_file: Path | None,
    sites: tuple[str, ...],
    ready: float,
    rest: float,
    hold: float,
    scatter: float,
    share: float,
    sets: bool,
    write: Path | None,
    yes: bool,
) -> None:
    """Set the threshold and the maximum of EMG sites from rest and a strong contraction of each.

    The daemon runs, and the wearer does as the terminal says. EMG is paused meanwhile, and is left as it
    was found, also by Ctrl-C, which sets nothing.
    """
    try:
        if write and not sets:
            raise click.UsageError("--write needs --set: what is written is what the daemon is set to.")
        if not yes:
            click.confirm("The wearer will be asked to relax, then to contract. Begin?", abort=True)
        plan = Plan(sites, ready, rest, hold, scatter, share)
        way = Way(socket or default_socket_path(), token_file, ca_file)
        asyncio.run(_calibrate(way, plan, sets, write))
    except BentodError as error:
        click.echo(f"bentod: {error}", err=True)
        raise SystemExit(1) from error
    except KeyboardInterrupt:
        click.echo("bentod: interrupted; EMG is left as it was found, and nothing was set.", err=True)
        raise SystemExit(130) from None


async def _calibrate(way: Way, plan: Plan, sets: bool, write: Path | None) -> None:
    async with way.client() as arm:
        await arm.call("hello", name="calibrate")
        found = await measure(arm, plan, _progress)
        for line in (line for one in found for line in one.lines()):
            click.echo(line)
        good = await apply(arm, found) if sets else []
        if good:
            click.echo(f"Set, in the running daemon: {', '.join(good)}.")
        if good and write:
            for line in keep(write, await arm.call("emg_get"), good):
                click.echo(line)
        if sets and len(good) < len(found):
            raise Refused("not every site could be set")


def _progress(line: str) -> None:
    click.echo(line, err=True)
