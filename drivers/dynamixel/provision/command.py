"""`bentod servo`: the commands."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict

import click

from bentod.errors import BentodError, BusError
from drivers.dynamixel.codec import Version
from drivers.dynamixel.ids import LAST, parse_ids
from drivers.dynamixel.provision import steps
from drivers.dynamixel.provision.sdk import ALL_BUT_ID, ALL_BUT_ID_AND_BAUD, EVERYTHING
from drivers.dynamixel.provision.steps import Place

BAUDS = (1_000_000, 57_600, 115_200, 2_000_000, 3_000_000)
"""bit/s where servos are looked for, if nobody says; 57 600 reaches those at 57 142."""

REFUSED, NOTHING = 1, 3
"""Exit codes."""

KEEP = {"nothing": EVERYTHING, "id": ALL_BUT_ID, "id-and-baud": ALL_BUT_ID_AND_BAUD}

ID = click.IntRange(0, LAST)

_at = click.option("--baud", "bauds", type=int, multiple=True, help="Look at this rate only; repeatable.")


@click.group()
def servo() -> None:
    """Give servos their IDs, rates and protocols: one at a time, torque off, and verified.

    What is written here survives power-off. Nothing moves. The daemon must not run on the same port.
    """


@servo.command()
@click.argument("port")
@_at
@click.option("--ids", callback=parse_ids, default="0-252", show_default=True, help="E.g. 1-5,9.")
@click.option("--json", "as_json", is_flag=True, help="Print what is found as JSON.")
def scan(port: str, bauds: tuple[int, ...], ids: tuple[int, ...], as_json: bool) -> None:
    """Look for servos on PORT. Exits with 3 if there is none."""
    with _told():
        found = list(steps.scan(port, bauds or BAUDS, ids, _progress))
    if as_json:
        click.echo(json.dumps([asdict(place) for place in found], indent=2))
    for place in () if as_json else found:
        click.echo(place)
    raise SystemExit(0 if found else NOTHING)


@servo.command("set-id")
@click.argument("port")
@click.argument("old", type=ID)
@click.argument("new", type=ID)
@_at
def set_id(port: str, old: int, new: int, bauds: tuple[int, ...]) -> None:
    """Give the servo OLD on PORT the ID NEW, which nobody may have."""
    with _told():
        click.echo(f"Now {steps.set_id(port, steps.find(port, old, bauds or BAUDS), new)}.")


@servo.command("set-baud")
@click.argument("port")
@click.argument("servo_id", metavar="ID", type=ID)
@click.argument("new", metavar="BAUD", type=int)
@_at
def set_baud(port: str, servo_id: int, new: int, bauds: tuple[int, ...]) -> None:
    """Have servo ID on PORT talk at BAUD bit/s; all servos of a bus need the same."""
    with _told():
        click.echo(f"Now {steps.set_baud(port, steps.find(port, servo_id, bauds or BAUDS), new)}.")


@servo.command("set-protocol")
@click.argument("port")
@click.argument("servo_id", metavar="ID", type=ID)
@click.argument("protocol", type=click.Choice(["1", "2"]))
@_at
def set_protocol(port: str, servo_id: int, protocol: str, bauds: tuple[int, ...]) -> None:
    """Have servo ID on PORT speak PROTOCOL 1.0 or 2.0, if its firmware has both (MX 2.0)."""
    version: Version = 1 if protocol == "1" else 2
    with _told():
        click.echo(f"Now {steps.set_protocol(port, steps.find(port, servo_id, bauds or BAUDS), version)}.")


@servo.command("factory-reset")
@click.argument("port")
@click.argument("servo_id", metavar="ID", type=ID)
@_at
@click.option("--keep", type=click.Choice(list(KEEP)), default="nothing", help="Of protocol 2.0 only.")
@click.option("--yes", is_flag=True, help="Do not ask first.")
def factory_reset(port: str, servo_id: int, bauds: tuple[int, ...], keep: str, yes: bool) -> None:
    """Reset servo ID on PORT to what it came with: limits, gains and offsets are lost, and more."""
    with _told():
        place = steps.find(port, servo_id, bauds or BAUDS)
        if not yes:
            click.confirm(_loss(place, keep), abort=True)
        for now in steps.factory_reset(port, place, KEEP[keep], tuple(dict.fromkeys([place.baud, *BAUDS]))):
            click.echo(f"Now {now}.")


def _loss(place: Place, keep: str) -> str:
    kept = keep if place.protocol == 2 else "nothing"  # protocol 1.0 resets everything
    lost = {"nothing": "its ID (it becomes 1), its rate, its ", "id": "its rate, its ", "id-and-baud": "its "}
    return (
        f"This is {place}. It loses {lost[kept]}angle limits, gains, offsets and shutdown mask, for good. "
        "No other servo on the bus may have the ID and the rate that it gets. Go on?"
    )


@contextmanager
def _told() -> Iterator[None]:
    """Errors as a line and an exit code."""
    try:
        yield
    except BentodError as error:
        click.echo(f"bentod: {error}", err=True)
        raise SystemExit(NOTHING if isinstance(error, BusError) else REFUSED) from error


def _progress(line: str) -> None:
    click.echo(line, err=True)
