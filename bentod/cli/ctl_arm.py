"""Commands of `bentod ctl` that hold, release or move the arm."""

from collections.abc import Iterator

import click

from bentod.blocking import BlockingClient
from bentod.cli import show
from bentod.cli.link import Failed, Link, several, switch
from bentod.frames import Value


@click.command()
@click.argument("words", metavar="[on|off] [JOINT]...", nargs=-1)
@click.pass_obj
def pause(link: Link, words: tuple[str, ...]) -> None:
    """Pause joints, or (off) release them."""
    on, joints = switch(words)
    link.do("pause", joints=several(joints), on=on)


@click.command()
@click.argument("on", type=click.Choice(["on", "off"]))
@click.argument("joints", metavar="[JOINT]...", nargs=-1)
@click.pass_obj
def torque(link: Link, on: str, joints: tuple[str, ...]) -> None:
    """Switch torque, which also pauses."""
    link.do("torque", joints=several(joints), on=on == "on")


@click.command()
@click.pass_obj
def stop(link: Link) -> None:
    """Stop every joint now."""
    link.do("stop")


@click.command("clear-fault")
@click.pass_obj
def clear_fault(link: Link) -> None:
    """Clear a latched fault whose cause is gone."""
    link.do("clear_fault")


@click.command("go-home")
@click.argument("joints", metavar="[JOINT]...", nargs=-1)
@click.option("--no-wait", is_flag=True, help="Return once the daemon has accepted.")
@click.option("--cancel", is_flag=True, help="End a homing that is under way, and pause nothing.")
@click.pass_obj
def go_home(link: Link, joints: tuple[str, ...], no_wait: bool, cancel: bool) -> None:
    """Send joints home and show how it goes. Ctrl-C ends the showing, not the going: use `--cancel`."""
    if cancel:
        _cancel(link, joints)
        return
    with link.open() as arm:
        arm.call("subscribe", topic="events")
        accepted = arm.call("go_home", joints=several(joints))
        if no_wait:
            link.show(accepted, show.as_text(accepted))
            return
        goal = show.fields(accepted).get("goal")
        for event in map(show.fields, _events(arm)):
            data = show.fields(event.get("data"))
            if event.get("kind") == "goal" and data.get("id") == goal and _has_ended(link, data):
                return


def _cancel(link: Link, joints: tuple[str, ...]) -> None:
    if joints:
        raise click.UsageError("--cancel ends the whole homing: give no joints.")
    with link.open() as arm:
        was_under_way = arm.call("go_home_cancel")
    link.show(was_under_way, "cancelled" if was_under_way else "nothing was on its way home")


def _events(arm: BlockingClient) -> Iterator[Value]:
    for notification in arm.notifications():
        if notification.method == "event":
            yield from show.entries(notification.params)


def _has_ended(link: Link, goal: dict[str, Value]) -> bool:
    """Show a goal; whether it is done. Raises Failed: it was cancelled."""
    status, progress = goal.get("status"), goal.get("progress")
    share = f" {progress:.0%}" if isinstance(progress, int | float) else ""
    if status == "cancelled":
        raise Failed(f"cancelled at{share}: {show.word(goal.get('reason'))}")
    link.show(goal, f"{show.word(status)}{share}")
    return status == "done"


@click.command()
@click.argument("joint")
@click.option("--velocity", type=float, help="rad/s, signed; with --position the greatest speed.")
@click.option("--position", type=float, help="rad, where to go.")
@click.option("--lease", type=click.FloatRange(0.05, 10), default=0.2, show_default=True, help="s")
@click.option("--for", "seconds", type=click.FloatRange(0.05), help="s to keep asking; one lease by default.")
@click.pass_obj
def move(
    link: Link,
    joint: str,
    velocity: float | None,
    position: float | None,
    lease: float,
    seconds: float | None,
) -> None:
    """Move one joint for a time; the wish ends with the command."""
    if velocity is None and position is None:
        raise click.UsageError("Give --velocity, --position or both.")
    seconds = lease if seconds is None else seconds
    link.hold("move", seconds, lease, joint=joint, velocity=velocity, position=position)


@click.command("set-meta")
@click.argument("text")
@click.pass_obj
def set_meta(link: Link, text: str) -> None:
    """Put a note into every frame from now on."""
    link.do("set_meta", meta=text)


@click.command()
@click.argument("fault")
@click.argument("words", metavar="[JOINT] [on|off]", nargs=-1)
@click.pass_obj
def inject(link: Link, fault: str, words: tuple[str, ...]) -> None:
    """Break (on) or mend (off) a simulated arm on purpose."""
    joints = [word for word in words if word not in ("on", "off")]
    if len(joints) > 1 or len(words) > 2:
        raise click.UsageError("Give one joint at most, then on or off.")
    link.do("inject", fault=fault, joint=joints[0] if joints else None, on="off" not in words)


ARM = (pause, torque, stop, clear_fault, go_home, move, set_meta, inject)
"""In the order of the help."""
