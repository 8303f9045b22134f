"""Commands of `bentod ctl` about general value functions."""

import click

from bentod.cli import show
from bentod.cli.link import Link, assigned


@click.command()
@click.pass_obj
def gvfs(link: Link) -> None:
    """Show every GVF: what it predicts now, how sure it is, how wrong it was."""
    with link.open() as arm:
        told = arm.call("gvf_list")
    link.show(told, show.gvfs_text(told))


@click.command("gvf-add")
@click.argument("name")
@click.argument("cumulant")
@click.argument("parameters", metavar="[KEY=VALUE]...", nargs=-1)
@click.pass_obj
def gvf_add(link: Link, name: str, cumulant: str, parameters: tuple[str, ...]) -> None:
    """Learn one more GVF: keys as in [[learn.gvfs]], e.g. timescale_s=0.5 variance=on."""
    table = assigned(parameters, texts=("algorithm", "representation", "scaling", "policy"))
    link.do("gvf_add", gvf=table | {"name": name, "cumulant": cumulant})


@click.command("gvf-remove")
@click.argument("names", metavar="NAME...", nargs=-1, required=True)
@click.pass_obj
def gvf_remove(link: Link, names: tuple[str, ...]) -> None:
    """Forget GVFs."""
    link.do("gvf_remove", name=list(names))


@click.command("gvf-reset")
@click.argument("names", metavar="NAME...", nargs=-1, required=True)
@click.pass_obj
def gvf_reset(link: Link, names: tuple[str, ...]) -> None:
    """Let GVFs begin anew."""
    link.do("gvf_reset", name=list(names))


LEARNING = (gvfs, gvf_add, gvf_remove, gvf_reset)
