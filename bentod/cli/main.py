"""The command `bentod`: its subcommands are loaded only when they are asked for."""

from importlib.metadata import version
from typing import cast

import click

from bentod.registry import COMMANDS, resolve

_HELP = {
    "run": "Run the daemon: an arm, its wearer's muscles, the learners and the socket.",
    "check": "Check a config file and explain what it says.",
    "ctl": "Ask something of the running daemon.",
    "watch": "Show the running daemon in the terminal.",
    "dashboard": "Show the running daemon in the browser.",
    "doctor": "Look for Dynamixel servos behind a serial port and say what is wrong with them.",
    "servo": "Give a Dynamixel servo its ID, baud rate or protocol.",
    "calibrate": "Measure how long a joint takes to obey, or how strong muscles are, and keep it.",
    "replay": "Play a recording to clients as if it were live, or learn from it again.",
    "learn": "Look at what was learned, and learn it again from recordings.",
    "teach": "Lead the arm by the hand, along a trajectory, or learn from a recording.",
    "emg": "Train a classifier of muscle signals on labelled recordings, and try it.",
    "recording": "Look into recordings: what is there, figures, reports, trials, other formats.",
    "lsl": "Stream state, muscle signals and events to LabRecorder and others on the network.",
    "voice": "Speak what the running daemon does: joints that are selected, faults, marks.",
    "bench": "Measure how late a tick begins on this machine.",
    "study": "Run an experiment of the thesis again, in simulation, and check what must come out.",
    "sim-bus": "Simulate the arm's servos behind a serial port of their own.",
    "sim-can": "Simulate the arm's motor controllers on a CAN bus of their own.",
}


class _Lazy(click.Group):
    """A group whose commands are strings until one is called, so that `--help` is quick."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Names of the commands."""
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """The command, loaded now; None if there is none of that name."""
        return cast("click.Command", resolve(COMMANDS[cmd_name])) if cmd_name in COMMANDS else None

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """List the commands without loading them."""
        with formatter.section("Commands"):
            formatter.write_dl([(name, _HELP[name]) for name in COMMANDS])


@click.command(cls=_Lazy, context_settings={"auto_envvar_prefix": "BENTOD"})
@click.version_option(version("bentod"), prog_name="bentod")
def bentod() -> None:
    """Control a research prosthetic arm: muscles in, learned predictions, joints out."""
