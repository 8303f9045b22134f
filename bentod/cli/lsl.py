"""`bentod lsl`: the arm as streams of the lab streaming layer, for LabRecorder."""

import asyncio
import time

import click

from bentod import logs
from bentod.address import parse
from bentod.cli.link import ADDRESS, Failed, Misused, Way
from bentod.cli.until_told import until_told
from bentod.endpoint import default_socket_path
from bentod.errors import BentodError
from bentod.lsl.bridge import Bridge
from bentod.lsl.extra import load
from bentod.lsl.sender import Sender
from bentod.lsl.times import Clocks


@click.command()
@ADDRESS
@click.option("--state/--no-state", default=True, help="Whether to stream the state; default: yes.")
@click.option("--emg/--no-emg", default=True, help="Whether to stream muscle signals; default: yes.")
def lsl(socket: str | None, state: bool, emg: bool) -> None:
    """Stream state, muscle signals and events to LSL until Ctrl-C, on the arm's own machine.

    The streams are "bentod state", "bentod EMG" and "bentod events". They stay while the daemon is away.
    """
    topics = (*(("state",) if state else ()), *(("emg",) if emg else ()), "events")
    try:
        way = _local(Way(socket or default_socket_path()))
        open_outlet, local_clock = load()
        sender = Sender(open_outlet, Clocks(local_clock, time.monotonic))
        with logs.setup("INFO"), Bridge(way.client, sender, topics) as bridge:
            asyncio.run(until_told(bridge.run()))
    except BentodError as error:
        raise Failed(str(error)) from error


def _local(way: Way) -> Way:
    """Raises Misused: the daemon may be on another machine, whose clock is another."""
    if not parse(way.address).path:
        raise Misused(
            f"{way.address} may be another machine, whose clock LSL does not know; run this on the arm's own "
            "machine, with the path of its socket: LSL carries the streams to others."
        )
    return way
