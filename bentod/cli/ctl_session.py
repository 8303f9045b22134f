"""Commands of `bentod ctl` about the session: trials, the recording."""

import click

from bentod.cli.link import Link


@click.group()
def trial() -> None:
    """Begin, mark and end the trials of an experiment."""


@trial.command()
@click.argument("name")
@click.option("--condition", default="", help="E.g. dpcc or toggling.")
@click.pass_obj
def start(link: Link, name: str, condition: str) -> None:
    """Begin a trial called NAME."""
    link.do("trial_start", name=name, condition=condition)


@trial.command()
@click.argument("what")
@click.pass_obj
def mark(link: Link, what: str) -> None:
    """Note that something happened in the trial: circuit, contact, or what you like."""
    link.do("trial_mark", mark=what)


@trial.command()
@click.pass_obj
def stop(link: Link) -> None:
    """End the trial."""
    link.do("trial_stop")


@click.command()
@click.pass_obj
def recording(link: Link) -> None:
    """Show how the recording goes."""
    link.do("get_recording")


SESSION = (trial, recording)
"""In the order of the help."""
