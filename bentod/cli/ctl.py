"""`bentod ctl`: asks the running daemon for one thing."""

from pathlib import Path

import click

from bentod.cli import show
from bentod.cli.ctl_arm import ARM
from bentod.cli.ctl_learning import LEARNING
from bentod.cli.ctl_muscles import MUSCLES
from bentod.cli.ctl_recognition import RECOGNITION
from bentod.cli.ctl_session import SESSION
from bentod.cli.link import ADDRESS, CA_FILE, TOKEN_FILE, Link, Way, assigned
from bentod.endpoint import default_socket_path
from bentod.errors import BentodError


class _Group(click.Group):
    """Ends its help with the methods of the daemon that is running, if one is."""

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        super().format_epilog(ctx, formatter)
        way = _way(*(ctx.params.get(name) for name in ("socket", "token_file", "ca_file")))
        formatter.write_paragraph()
        try:
            with way.blocking(timeout=1.0) as arm:
                methods = show.entries(arm.call("list_methods"))
        except BentodError as error:
            formatter.write(f"For `call`, a running daemon lists its methods here. {error}\n")
            return
        formatter.write(f"Methods for `call`, as the daemon at {way.address} offers them:\n\n")
        formatter.write("\n".join(show.method_text(method) for method in methods) + "\n")


@click.group(
    cls=_Group,
    epilog="Exit codes: 0 done; 1 refused or cancelled; 2 wrong usage, also when the daemon finds a name or "
    "a number wrong; 3 no daemon answers.",
)
@ADDRESS
@TOKEN_FILE
@CA_FILE
@click.option("--json", "as_json", is_flag=True, help="Print answers as JSON, one to a line.")
@click.option(
    "--timeout",
    type=click.FloatRange(0.01, 600),
    default=5.0,
    show_default=True,
    help="s to wait for an answer.",
)
@click.pass_context
def ctl(
    ctx: click.Context,
    socket: str | None,
    token_file: Path | None,
    ca_file: Path | None,
    as_json: bool,
    timeout: float,
) -> None:
    """Talk to the running daemon. JOINT... is one joint, several, or none for all of them."""
    ctx.obj = Link(_way(socket, token_file, ca_file), timeout, as_json)


def _way(socket: str | None, token_file: Path | None, ca_file: Path | None) -> Way:
    return Way(socket or default_socket_path(), token_file, ca_file)


@ctl.command()
@click.argument("method")
@click.argument("parameters", metavar="[NAME=VALUE]...", nargs=-1)
@click.pass_obj
def call(link: Link, method: str, parameters: tuple[str, ...]) -> None:
    """Call any method; values are JSON, on, off, or else texts."""
    link.do(method, **assigned(parameters))


@ctl.command()
@click.option("--watch", is_flag=True, help="Go on until Ctrl-C.")
@click.option(
    "--rate", type=click.FloatRange(0.1, 500), default=2.0, show_default=True, help="Hz, to watch at."
)
@click.pass_obj
def state(link: Link, watch: bool, rate: float) -> None:
    """Show every joint as of the last tick."""
    if not watch:
        with link.open() as arm:
            frame = arm.call("get_state")
        link.show(frame, show.state_text(frame))
        return
    link.watch("state", rate, show.state_text)


@ctl.command()
@click.pass_obj
def events(link: Link) -> None:
    """Show what happens, until Ctrl-C."""
    link.watch("events", 1.0, show.event_text)


@ctl.command()
@click.pass_obj
def info(link: Link) -> None:
    """Show what does not change: version, joints and their limits, groups."""
    link.do("get_info")


@ctl.command()
@click.pass_obj
def clients(link: Link) -> None:
    """Show who is connected, with which role, and what each was too slow for."""
    link.do("list_clients")


for command in (*ARM, *MUSCLES, *RECOGNITION, *LEARNING, *SESSION):
    ctl.add_command(command)
