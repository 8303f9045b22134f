"""Commands of `bentod ctl` about the session: trials, marks, the recording."""

import click

from bentod.cli.link import Link


@click.group()
def trial() -> None:
    """Begin, mark and end the trials of an experiment."""


@trial.command("start")
@click.argument("name")
@click.option("--condition", default="", help="E.g. dpcc or toggling.")
@click.pass_obj
def start_trial(link: Link, name: str, condition: str) -> None:
    """Begin a trial called NAME."""
    link.do("trial_start", name=name, condition=condition)


@trial.command("mark")
@click.argument("what")
@click.pass_obj
def mark_trial(link: Link, what: str) -> None:
    """Note that something happened in the trial: circuit, contact, or what you like."""
    link.do("trial_mark", mark=what)


@trial.command("stop")
@click.pass_obj
def stop_trial(link: Link) -> None:
    """End the trial."""
    link.do("trial_stop")


@click.command()
@click.argument("what")
@click.pass_obj
def mark(link: Link, what: str) -> None:
    """Note that something happened, in the trial if one runs."""
    link.do("mark", mark=what)


@click.group(invoke_without_command=True)
@click.pass_context
def recording(context: click.Context) -> None:
    """Show how the recording goes, or begin and end one."""
    if context.invoked_subcommand is None:
        context.invoke(show_recording)


@click.command()
@click.pass_obj
def show_recording(link: Link) -> None:
    """Show how the recording goes."""
    link.do("get_recording")


@recording.command("start")
@click.option("--note", default="", help="Kept in the file, e.g. what it is of.")
@click.pass_obj
def start_recording(link: Link, note: str) -> None:
    """Record into a new file; one that is being recorded ends."""
    link.do("recording_start", note=note)


@recording.command("stop")
@click.pass_obj
def stop_recording(link: Link) -> None:
    """End the recording, and wait until its file is whole."""
    link.do("recording_stop")


SESSION = (trial, mark, recording)
"""In the order of the help."""
