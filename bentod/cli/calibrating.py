"""`bentod calibrate`: of a joint, or of the wearer's muscles."""

import click

from bentod.cli.calibrate import calibrate as joint
from bentod.cli.calibrate_muscles import emg


class _JointFirst(click.Group):
    """A group in which whatever is no command is the name of a joint, or an option about one."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Put the command in that was left out."""
        if args and args[0] not in self.commands and args[0] not in self.get_help_option_names(ctx):
            args = ["joint", *args]
        return super().parse_args(ctx, args)


@click.group(cls=_JointFirst, subcommand_metavar="JOINT | emg [OPTIONS]")
def calibrate() -> None:
    """Measure how long a joint takes to obey, or how strong muscles are, and keep it.

    `bentod calibrate JOINT` is short for `bentod calibrate joint JOINT`.
    """


calibrate.add_command(joint, "joint")
calibrate.add_command(emg, "emg")
