"""Commands of `bentod ctl` about joint groups, muscle signals and assistance."""

from pathlib import Path

import click

from bentod.cli.link import Link, assigned
from bentod.cli.site_settings import keep
from bentod.config_sites import BRACHIOPLEXUS

ON_OFF = click.Choice(["on", "off"])
PARAMETERS = click.argument("parameters", metavar="NAME=VALUE...", nargs=-1, required=True)


@click.command()
@click.pass_obj
def groups(link: Link) -> None:
    """Show the joint groups and which joint of each is active."""
    link.do("group_list")


@click.command()
@click.argument("name", metavar="GROUP")
@click.argument("direction", type=click.Choice(["forward", "backward"]), default="forward")
@click.pass_obj
def toggle(link: Link, name: str, direction: str) -> None:
    """Make the next or previous joint of a group active."""
    link.do("group_toggle", group=name, direction=direction)


@click.command()
@click.argument("name", metavar="GROUP")
@click.argument("joint")
@click.pass_obj
def activate(link: Link, name: str, joint: str) -> None:
    """Make a joint the active one of its group."""
    link.do("group_activate", group=name, joint=joint)


@click.command(context_settings={"ignore_unknown_options": True})  # -0.5 is an effort, not an option
@click.argument("name", metavar="GROUP")
@click.argument("effort", type=float)
@click.option("--for", "seconds", type=click.FloatRange(0.05), default=1.0, show_default=True, help="s")
@click.option("--lease", type=click.FloatRange(0.05, 10), default=0.2, show_default=True, help="s")
@click.pass_obj
def group(link: Link, name: str, effort: float, seconds: float, lease: float) -> None:
    """Move a group's active joint at a share (-1 to 1) of its top speed, as muscles would."""
    link.hold("group_command", seconds, lease, group=name, effort=effort)


@click.command()
@click.pass_obj
def emg(link: Link) -> None:
    """Show the EMG sites and their parameters."""
    link.do("emg_get")


@click.command("emg-set")
@click.argument("site")
@PARAMETERS
@click.pass_obj
def emg_set(link: Link, site: str, parameters: tuple[str, ...]) -> None:
    """Change a site: gain=…, threshold_v=…, max_v=…, release=…; what is left out stays."""
    named = {BRACHIOPLEXUS.get(key, key): value for key, value in assigned(parameters).items()}
    link.do("emg_set", **(named | {"site": site}))


@click.command("emg-save")
@click.argument("file", type=click.Path(path_type=Path))
@click.pass_obj
def emg_save(link: Link, file: Path) -> None:
    """Keep what the sites are set to now in a config file, comments and all."""
    with link.open() as arm:
        for line in keep(file, arm.call("emg_get")):
            click.echo(line)


@click.command("emg-pause")
@click.argument("on", type=ON_OFF, default="on")
@click.pass_obj
def emg_pause(link: Link, on: str) -> None:
    """Let the muscles drive nothing, or (off) drive again."""
    link.do("emg_pause", on=on == "on")


@click.command()
@click.pass_obj
def assist(link: Link) -> None:
    """Show the parameters of collaborative control."""
    link.do("assist_get")


@click.command("assist-set")
@PARAMETERS
@click.pass_obj
def assist_set(link: Link, parameters: tuple[str, ...]) -> None:
    """Change parameters of collaborative control; what is left out stays."""
    link.do("assist_set", **assigned(parameters, texts=("mode", "timescale_by")))


@click.command(context_settings={"ignore_unknown_options": True})  # -1 is a reward, not an option
@click.argument("value", type=click.FloatRange(-10, 10))
@click.option("--group", help="The group that is meant; all of them without.")
@click.pass_obj
def reward(link: Link, value: float, group: str | None) -> None:
    """Tell the arm that it did well (above 0) or badly (below 0) just now."""
    link.do("reward", value=value, group=group)


MUSCLES = (groups, group, toggle, activate, emg, emg_set, emg_save, emg_pause, assist, assist_set, reward)
"""In the order of the help."""
