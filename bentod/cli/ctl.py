"""`bentod ctl`: asks the running daemon for one thing."""

from pathlib import Path

import click

from bentod.blocking import BlockingClient
from bentod.cli import show
from bentod.cli.ctl_arm import ARM
from bentod.cli.ctl_muscles import MUSCLES
from bentod.cli.link import Link, assigned
from bentod.endpoint import default_socket_path
from bentod.errors import BentodError


class _Group(click.Group):
    """Ends its help with the methods of the daemon that is running, if one is."""

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        super().format_epilog(ctx, formatter)
        path = ctx.params.get("socket") or default_socket_path()
        formatter.write_paragraph()
        try:
            with BlockingClient(path, timeout_s=1.0) as arm:
                methods = show.entries(arm.call("list_methods"))
        except BentodError as error:
            formatter.write(f"For `call`, a running daemon lists its methods here. {error}\n")
            return
        formatter.write(f"Methods for `call`, as the daemon at {path} offers them:\n\n")
        formatter.write("\n".join(show.method_text(method) for method in methods) + "\n")


@click.group(
    cls=_Group,
    epilog="Exit codes: 0 done; 1 refused or cancelled; 2 wrong usage, also when the daemon finds a name or "
    "a number wrong; 3 no daemon answers.",
)
@click.option(
    "--socket",
    type=click.Path(path_type=Path),
    envvar="BENTOD_SOCKET",
    is_eager=True,
    help="Where the daemon listens; its usual place if not given.",
)
@click.option("--json", "as_json", is_flag=True, help="Print answers as JSON, one to a line.")
@click.option(
    "--timeout",
    type=click.FloatRange(0.01, 600),
    default=5.0,
    show_default=True,
    help="s to wait for an answer.",
)
@click.pass_context
def ctl(ctx: click.Context, socket: Path | None, as_json: bool, timeout: float) -> None:
    """Talk to the running daemon. JOINT... is one joint, several, or none for all of them."""
    ctx.obj = Link(socket or default_socket_path(), timeout, as_json)


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
    for frame in link.watch("state", rate):
        link.show(frame, show.state_text(frame))


@ctl.command()
@click.pass_obj
def events(link: Link) -> None:
    """Show what happens, until Ctrl-C."""
    for event in link.watch("events", 1.0):
        link.show(event, show.event_text(event))


@ctl.command()
@click.pass_obj
def info(link: Link) -> None:
    """Show what does not change: version, joints and their limits, groups."""
    link.do("get_info")


for command in (*ARM, *MUSCLES):
    ctl.add_command(command)
